"""Live shaping in Structured Text: how swing and drive go on, and levels on calls."""

from string import Template

OVER = Template("""\
(* How swing and drive go on for a time without a switch, behind lag 0 (more speed) or 1 (less). *)
FUNCTION_BLOCK ${NAME}_over
VAR_INPUT
    decay : $REAL;
    turn : $REAL;
    time_s : $REAL;
    lag : DINT;
END_VAR
VAR_OUTPUT
    x : $REAL;
    y : $REAL;
    ee : $REAL;
    er : $REAL;
    re : $REAL;
    rr : $REAL;
END_VAR
VAR
    fade : $REAL;
${LAGVARS}END_VAR
fade := EXP(decay * time_s);
x := fade * COS(turn * time_s);
y := fade * SIN(turn * time_s);
${LAG}END_FUNCTION_BLOCK""")


ANGLE = Template("""\
(* The angle of a vector, from -pi to pi. *)
FUNCTION_BLOCK ${NAME}_angle
VAR_INPUT
    x : $REAL;
    y : $REAL;
END_VAR
VAR_OUTPUT
    angle : $REAL;
END_VAR
angle := 0.0;
IF ABS(x) > ABS(y) THEN
    angle := ATAN(y / x);
    IF x < 0.0 THEN
        IF y > 0.0 THEN
            angle := angle + $QUARTER * 2.0;
        ELSE
            angle := angle - $QUARTER * 2.0;
        END_IF;
    END_IF;
ELSE
    IF y > 0.0 THEN
        angle := $QUARTER - ATAN(x / y);
    END_IF;
    IF y < 0.0 THEN
        angle := -$QUARTER - ATAN(x / y);
    END_IF;
END_IF;
END_FUNCTION_BLOCK""")


SWITCH = Template("""\
(* A switch of the level from one value to another: swing and drive after it, and the lag then. *)
FUNCTION_BLOCK ${NAME}_switch
VAR_INPUT
    gains : ARRAY[0..7] OF $REAL;
    re : $REAL;
    im : $REAL;
    error : $REAL;
    rate : $REAL;
    lag : DINT;
    before : $REAL;
    after : $REAL;
END_VAR
VAR_OUTPUT
    new_re : $REAL;
    new_im : $REAL;
    new_error : $REAL;
    new_lag : DINT;
END_VAR
new_lag := lag;
IF ABS(after) > ABS(before) THEN
    new_lag := 0;
END_IF;
IF ABS(after) < ABS(before) THEN
    new_lag := 1;
END_IF;
${SWITCHED}END_FUNCTION_BLOCK""")


REMAINS = Template("""\
(* What is left of a motion once levels have been sent. *)
FUNCTION_BLOCK ${NAME}_remains
VAR_INPUT
    decay : $REAL;
    turn : $REAL;
    gains : ARRAY[0..7] OF $REAL;
    cycle_s : $REAL;
    re_now : $REAL;
    im_now : $REAL;
    error_now : $REAL;
    rate_now : $REAL;
    lag_now : DINT;
    level_now : $REAL;
    calls : ARRAY[0..7] OF DINT;
    levels : ARRAY[0..7] OF $REAL;
    head : DINT;
    count : DINT;
END_VAR
VAR_OUTPUT
    re : $REAL;
    im : $REAL;
    size : $REAL;
END_VAR
VAR
    error : $REAL;
    rate : $REAL;
    lag : DINT;
    level : $REAL;
    reached : DINT;
    k : DINT;
    held : $REAL;
    flow : ${NAME}_over;
    switched : ${NAME}_switch;
END_VAR
re := re_now;
im := im_now;
error := error_now;
rate := rate_now;
lag := lag_now;
level := level_now;
reached := calls[head];
FOR k := head TO count - 1 DO
    IF calls[k] <> reached THEN
        flow(decay := decay, turn := turn, time_s := $TOREAL(calls[k] - reached) * cycle_s,
            lag := lag);
        reached := calls[k];
        held := re;
        re := flow.x * held - flow.y * im;
        im := flow.x * im + flow.y * held;
        held := error;
        error := flow.ee * held + flow.er * rate;
        rate := flow.re * held + flow.rr * rate;
    END_IF;
    IF levels[k] <> level THEN
        switched(gains := gains, re := re, im := im, error := error, rate := rate, lag := lag,
            before := level, after := levels[k]);
        re := switched.new_re;
        im := switched.new_im;
        error := switched.new_error;
        lag := switched.new_lag;
        level := levels[k];
    END_IF;
END_FOR;
size := SQRT(re * re + im * im);
END_FUNCTION_BLOCK""")


PULSE = Template("""\
(* The levels of a pulse between two times, in cycles after a pause: the mean of each cycle. *)
FUNCTION_BLOCK ${NAME}_pulse
VAR_INPUT
    pause : DINT;
    rise : $REAL;
    fall : $REAL;
    wanted : $REAL;
    other : $REAL;
END_VAR
VAR_OUTPUT
    calls : ARRAY[0..7] OF DINT;
    levels : ARRAY[0..7] OF $REAL;
    count : DINT;
END_VAR
VAR
    shares : ARRAY[0..4] OF $REAL;
    cycles : ARRAY[0..4] OF DINT;
    first : DINT;
    last : DINT;
    k : DINT;
END_VAR
first := TRUNC(rise);
last := TRUNC(fall);
cycles[0] := 0;
shares[0] := 0.0;
cycles[1] := first;
cycles[2] := first + 1;
cycles[3] := last;
cycles[4] := last + 1;
shares[4] := 0.0;
IF first = last THEN
    shares[1] := (fall - $TOREAL(last)) - (rise - $TOREAL(first));
    shares[2] := shares[1];
    shares[3] := shares[1];
    cycles[2] := first;
ELSE
    shares[1] := 1.0 - (rise - $TOREAL(first));
    shares[2] := 1.0;
    shares[3] := fall - $TOREAL(last);
END_IF;
count := 0;
FOR k := 0 TO 4 DO
    IF shares[k] < $SNAP THEN
        shares[k] := 0.0;
    END_IF;
    IF shares[k] > 1.0 - $SNAP THEN
        shares[k] := 1.0;
    END_IF;
    IF count = 0 THEN
        count := 1;
    ELSE
        IF calls[count - 1] < pause + cycles[k] THEN
            count := count + 1;
        END_IF;
    END_IF;
    calls[count - 1] := pause + cycles[k];
    levels[count - 1] := wanted * (1.0 - shares[k]) + other * shares[k];
END_FOR;
END_FUNCTION_BLOCK""")
