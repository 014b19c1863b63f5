"""Live shaping in Structured Text: the pulse that ends a swing."""

from string import Template

SOLVE = Template("""\
(* One pulse that ends a motion: its times in cycles, from guesses. *)
FUNCTION_BLOCK ${NAME}_solve
VAR_INPUT
    decay : $REAL;
    turn : $REAL;
    gains : ARRAY[0..7] OF $REAL;
    bound : $REAL;
    cycle_s : $REAL;
    re_now : $REAL;
    im_now : $REAL;
    error_now : $REAL;
    rate_now : $REAL;
    lag_now : DINT;
    level_now : $REAL;
    wanted : $REAL;
    other : $REAL;
    pause : DINT;
    first_rise : $REAL;
    first_fall : $REAL;
END_VAR
VAR_OUTPUT
    solved : BOOL;
    residual : $REAL;
    calls : ARRAY[0..7] OF DINT;
    levels : ARRAY[0..7] OF $REAL;
    count : DINT;
END_VAR
VAR
    going : BOOL;
    near : BOOL;
    k : DINT;
    rise : $REAL;
    fall : $REAL;
    lag_wanted : DINT;
    lag_other : DINT;
    most : $REAL;
    re : $REAL;
    im : $REAL;
    error : $REAL;
    rate : $REAL;
    early_re : $REAL;
    early_im : $REAL;
    early_error : $REAL;
    early_rate : $REAL;
    slope_re : $REAL;
    slope_im : $REAL;
    slope_error : $REAL;
    slope_rate : $REAL;
    held : $REAL;
    aa : $REAL;
    ab : $REAL;
    ba : $REAL;
    bb : $REAL;
    size : $REAL;
    move_rise : $REAL;
    move_fall : $REAL;
    seen_rise : $REAL;
    seen_fall : $REAL;
    re_before : $REAL;
    im_before : $REAL;
    re_wanted : $REAL;
    im_wanted : $REAL;
    error_wanted : $REAL;
    flow : ${NAME}_over;
    pulse_flow : ${NAME}_over;
    switched : ${NAME}_switch;
    levels_of : ${NAME}_pulse;
    remains : ${NAME}_remains;
END_VAR
solved := FALSE;
going := TRUE;
near := FALSE;
rise := first_rise;
fall := first_fall;
(* No gap moves by more than an eighth of a period at once. *)
most := $EIGHTH / (turn * cycle_s);
switched(gains := gains, re := re_now, im := im_now, error := error_now, rate := rate_now,
    lag := lag_now, before := level_now, after := wanted);
re_wanted := switched.new_re;
im_wanted := switched.new_im;
error_wanted := switched.new_error;
lag_wanted := switched.new_lag;
(* Newton's method with switches at any time: the rows of its matrix are aa ab and ba bb. *)
FOR k := 1 TO $ITERATIONS DO
    IF going AND NOT near THEN
        flow(decay := decay, turn := turn, time_s := rise * cycle_s, lag := lag_wanted);
        re := flow.x * re_wanted - flow.y * im_wanted;
        im := flow.x * im_wanted + flow.y * re_wanted;
        error := flow.ee * error_wanted + flow.er * rate_now;
        rate := flow.re * error_wanted + flow.rr * rate_now;
        early_re := decay * re - turn * im;
        early_im := decay * im + turn * re;
${EARLYSLOPE}        switched(gains := gains, re := re, im := im, error := error, rate := rate,
            lag := lag_wanted, before := wanted, after := other);
        re := switched.new_re;
        im := switched.new_im;
        error := switched.new_error;
        lag_other := switched.new_lag;
${EARLYSWITCH}        slope_re := decay * re - turn * im;
        slope_im := decay * im + turn * re;
${SLOPE}        (* A later rise shortens the pulse. *)
        early_re := early_re - slope_re;
        early_im := early_im - slope_im;
        early_error := early_error - slope_error;
        early_rate := early_rate - slope_rate;
        pulse_flow(decay := decay, turn := turn, time_s := (fall - rise) * cycle_s,
            lag := lag_other);
        held := re;
        re := pulse_flow.x * held - pulse_flow.y * im;
        im := pulse_flow.x * im + pulse_flow.y * held;
        held := error;
        error := pulse_flow.ee * held + pulse_flow.er * rate;
        rate := pulse_flow.re * held + pulse_flow.rr * rate;
        held := early_re;
        early_re := pulse_flow.x * held - pulse_flow.y * early_im;
        early_im := pulse_flow.x * early_im + pulse_flow.y * held;
        held := early_error;
        early_error := pulse_flow.ee * held + pulse_flow.er * early_rate;
        early_rate := pulse_flow.re * held + pulse_flow.rr * early_rate;
        slope_re := decay * re - turn * im;
        slope_im := decay * im + turn * re;
${SLOPE}        switched(gains := gains, re := re, im := im, error := error, rate := rate,
            lag := lag_other, before := other, after := wanted);
        re := switched.new_re;
        im := switched.new_im;
${LASTSWITCH}        aa := early_re * cycle_s;
        ab := slope_re * cycle_s;
        ba := early_im * cycle_s;
        bb := slope_im * cycle_s;
        size := aa * bb - ab * ba;
        going := ABS(size) > 0.0;
        near := ABS(re) + ABS(im) < $NEAR;
        IF going AND NOT near THEN
            move_rise := (ab * im - bb * re) / size;
            move_fall := (ba * re - aa * im) / size;
            held := ABS(move_rise);
            IF ABS(move_fall) > held THEN
                held := ABS(move_fall);
            END_IF;
            IF held > most THEN
                move_rise := move_rise * (most / held);
                move_fall := move_fall * (most / held);
            END_IF;
            rise := rise + move_rise;
            fall := fall + move_fall;
            IF fall < rise THEN
                fall := rise;
            END_IF;
            going := rise > -4.0 * most AND fall < $FARTHEST * most;
        END_IF;
    END_IF;
END_FOR;
(* Broyden's method with levels as they are sent, a mean for each cycle. *)
IF going THEN
    size := aa * bb - ab * ba;
    held := aa / size;
    aa := bb / size;
    bb := held;
    ab := -ab / size;
    ba := -ba / size;
    IF rise < 0.0 AND rise > -0.5 THEN
        rise := 0.0;
    END_IF;
END_IF;
FOR k := 1 TO $CORRECTIONS DO
    IF going AND NOT solved THEN
        going := rise >= 0.0 AND fall >= rise;
    END_IF;
    IF going AND NOT solved THEN
        levels_of(pause := pause, rise := rise, fall := fall, wanted := wanted, other := other);
        remains(decay := decay, turn := turn, gains := gains, cycle_s := cycle_s, re_now := re_now,
            im_now := im_now, error_now := error_now, rate_now := rate_now, lag_now := lag_now,
            level_now := level_now, calls := levels_of.calls, levels := levels_of.levels,
            head := 0, count := levels_of.count);
        residual := remains.size;
        solved := residual <= bound;
        IF k > 1 THEN
            (* The inverse learns from what the last step did. *)
            seen_rise := aa * (remains.re - re_before) + ab * (remains.im - im_before);
            seen_fall := ba * (remains.re - re_before) + bb * (remains.im - im_before);
            move_rise := -(aa * re_before + ab * im_before);
            move_fall := -(ba * re_before + bb * im_before);
            size := move_rise * seen_rise + move_fall * seen_fall;
            IF ABS(size) > $LEAST * (move_rise * move_rise + move_fall * move_fall) THEN
                slope_re := move_rise * aa + move_fall * ba;
                slope_im := move_rise * ab + move_fall * bb;
                seen_rise := (move_rise - seen_rise) / size;
                seen_fall := (move_fall - seen_fall) / size;
                aa := aa + seen_rise * slope_re;
                ab := ab + seen_rise * slope_im;
                ba := ba + seen_fall * slope_re;
                bb := bb + seen_fall * slope_im;
            END_IF;
        END_IF;
        re_before := remains.re;
        im_before := remains.im;
        IF NOT solved THEN
            rise := rise - (aa * re_before + ab * im_before);
            fall := fall - (ba * re_before + bb * im_before);
        END_IF;
    END_IF;
END_FOR;
count := 0;
IF solved THEN
    IF pause > 0 THEN
        calls[0] := 0;
        levels[0] := level_now;
        count := 1;
    END_IF;
    FOR k := 0 TO levels_of.count - 1 DO
        calls[count] := levels_of.calls[k];
        levels[count] := levels_of.levels[k];
        count := count + 1;
    END_FOR;
END_IF;
END_FUNCTION_BLOCK""")
