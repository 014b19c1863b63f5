"""Live shaping in Structured Text: which plans are tried."""

from string import Template

REPLAN = Template("""\
(* A plan from a motion to the wanted level: the earliest that is within the bound. *)
FUNCTION_BLOCK ${NAME}_replan
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
    level : $REAL;
    wanted : $REAL;
    top : $REAL;
END_VAR
VAR_OUTPUT
    solved : BOOL;
    residual : $REAL;
    calls : ARRAY[0..7] OF DINT;
    levels : ARRAY[0..7] OF $REAL;
    count : DINT;
END_VAR
VAR CONSTANT
    last_wait : DINT := $LASTWAIT;
    last_end : DINT := $LASTEND;
END_VAR
VAR
    res : ARRAY[0..last_wait] OF $REAL;
    ims : ARRAY[0..last_wait] OF $REAL;
    errors : ARRAY[0..last_wait] OF $REAL;
    rates : ARRAY[0..last_wait] OF $REAL;
    waits : ARRAY[0..last_wait] OF DINT;
    ends : ARRAY[0..last_end] OF $REAL;
    rises : ARRAY[0..last_end] OF $REAL;
    cycles : $REAL;
    turning : BOOL;
    hold : $REAL;
    lag_hold : DINT;
    lag_up : DINT;
    lag_down : DINT;
    best : $REAL;
    least : $REAL;
    first : DINT;
    found : DINT;
    k : DINT;
    j : DINT;
    n : DINT;
    attempt : DINT;
    trying : BOOL;
    re : $REAL;
    im : $REAL;
    size : $REAL;
    other : $REAL;
    height : $REAL;
    part : $REAL;
    half : $REAL;
    rise : $REAL;
    width : $REAL;
    up : $REAL;
    flow : ${NAME}_over;
    switched : ${NAME}_switch;
    angle_of : ${NAME}_angle;
    solve : ${NAME}_solve;
END_VAR
cycles := 1.0 / (turn * cycle_s);
turning := level * wanted < 0.0;
hold := level;
IF turning THEN
    hold := 0.0;
END_IF;
best := $NEVER;
FOR k := 0 TO last_end DO
    ends[k] := $NEVER;
END_FOR;
FOR k := 0 TO last_wait DO
    IF (level <> wanted OR k = 0) AND NOT (turning AND k = 0) THEN
        waits[k] := TRUNC($TOREAL(k) * $EACH * cycles);
        IF k > 0 AND waits[k] < 1 THEN
            waits[k] := 1;
        END_IF;
        switched(gains := gains, re := re_now, im := im_now, error := error_now, rate := rate_now,
            lag := lag_now, before := level, after := hold);
        lag_hold := switched.new_lag;
        res[k] := switched.new_re;
        ims[k] := switched.new_im;
        errors[k] := switched.new_error;
        rates[k] := rate_now;
        IF waits[k] > 0 THEN
            flow(decay := decay, turn := turn, time_s := $TOREAL(waits[k]) * cycle_s,
                lag := lag_hold);
            re := res[k];
            res[k] := flow.x * re - flow.y * ims[k];
            ims[k] := flow.x * ims[k] + flow.y * re;
            re := errors[k];
            errors[k] := flow.ee * re + flow.er * rates[k];
            rates[k] := flow.re * re + flow.rr * rates[k];
        END_IF;
        switched(gains := gains, re := res[k], im := ims[k], error := errors[k], rate := rates[k],
            lag := lag_hold, before := hold, after := wanted);
        re := switched.new_re;
        im := switched.new_im;
        size := SQRT(re * re + im * im);
        IF size <= bound AND $TOREAL(waits[k]) < best THEN
            (* Nothing is left to cancel. *)
            best := $TOREAL(waits[k]);
            residual := size;
            calls[0] := 0;
            levels[0] := hold;
            count := 1;
            IF waits[k] > 0 THEN
                count := 2;
            END_IF;
            calls[count - 1] := waits[k];
            levels[count - 1] := wanted;
        END_IF;
        FOR j := 0 TO 1 DO
            other := 0.0;
            IF j = 1 THEN
                other := top;
            END_IF;
            height := other - wanted;
            IF ABS(height) > 0.0 AND (j = 0 OR ABS(other) > 0.0) AND other * wanted >= 0.0 THEN
                lag_up := switched.new_lag;
                lag_down := switched.new_lag;
                IF ABS(other) > ABS(wanted) THEN
                    lag_up := 0;
                    lag_down := 1;
                END_IF;
                IF ABS(other) < ABS(wanted) THEN
                    lag_up := 1;
                    lag_down := 0;
                END_IF;
                (* The pulse of an ideal drive: half its turn is the angle whose sine is part. *)
                part := size / (ABS(height)
                    * (SQRT(gains[4 * lag_up] * gains[4 * lag_up]
                        + gains[4 * lag_up + 1] * gains[4 * lag_up + 1])
                        + SQRT(gains[4 * lag_down] * gains[4 * lag_down]
                            + gains[4 * lag_down + 1] * gains[4 * lag_down + 1])));
                IF part <= $REACH THEN
                    half := $QUARTER;
                    IF part < 1.0 THEN
                        angle_of(x := SQRT(1.0 - part * part), y := part);
                        half := angle_of.angle;
                    END_IF;
                    angle_of(x := -gains[4 * lag_up], y := -gains[4 * lag_up + 1]);
                    up := angle_of.angle;
                    angle_of(x := -gains[4 * lag_down], y := -gains[4 * lag_down + 1]);
                    width := half * 2.0 + angle_of.angle - up;
                    IF width < $SHORTEST THEN
                        width := $SHORTEST;
                    END_IF;
                    angle_of(x := -re * height, y := -im * height);
                    rise := up + $QUARTER - half - angle_of.angle;
                    FOR n := 1 TO 2 DO
                        IF rise >= $QUARTER * 4.0 - $EARLY THEN
                            rise := rise - $QUARTER * 4.0;
                        END_IF;
                        IF rise < -$EARLY THEN
                            rise := rise + $QUARTER * 4.0;
                        END_IF;
                    END_FOR;
                    n := 4 * k + 2 * j;
                    rises[n] := rise * cycles;
                    ends[n] := (rise + width) * cycles;
                    IF rise < $EARLY THEN
                        rises[n + 1] := (rise + $QUARTER * 4.0) * cycles;
                        ends[n + 1] := ends[n] + $QUARTER * 4.0 * cycles;
                    END_IF;
                END_IF;
            END_IF;
        END_FOR;
    END_IF;
END_FOR;
FOR attempt := 1 TO $TRIES DO
    found := -1;
    least := best;
    FOR k := 0 TO last_end DO
        IF ends[k] < $NEVER THEN
            IF $TOREAL(waits[k / 4]) + ends[k] < least THEN
                least := $TOREAL(waits[k / 4]) + ends[k];
                found := k;
            END_IF;
        END_IF;
    END_FOR;
    IF found >= 0 THEN
        first := found / 4;
        other := 0.0;
        IF found - 4 * first >= 2 THEN
            other := top;
        END_IF;
        (* Lags change with whole calls, so that a height may have no solution: then a lower one. *)
        trying := TRUE;
        FOR j := 1 TO $HEIGHTS DO
            IF trying THEN
                solve(decay := decay, turn := turn, gains := gains, bound := bound,
                    cycle_s := cycle_s, re_now := res[first], im_now := ims[first],
                    error_now := errors[first], rate_now := rates[first], lag_now := lag_hold,
                    level_now := hold, wanted := wanted, other := other, pause := waits[first],
                    first_rise := rises[found], first_fall := ends[found]);
                other := wanted + (other - wanted) * $LOWER;
                trying := NOT solve.solved;
            END_IF;
        END_FOR;
        IF NOT trying THEN
            IF $TOREAL(solve.calls[solve.count - 1]) < best THEN
                count := solve.count;
                residual := solve.residual;
                best := $TOREAL(solve.calls[count - 1]);
                FOR k := 0 TO count - 1 DO
                    calls[k] := solve.calls[k];
                    levels[k] := solve.levels[k];
                END_FOR;
            END_IF;
        END_IF;
        ends[found] := $NEVER;
    END_IF;
END_FOR;
solved := best < $NEVER;
END_FUNCTION_BLOCK""")
