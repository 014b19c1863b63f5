"""Live shaping in Structured Text: what is done once a cycle."""

from string import Template

SHAPER = Template("""\
(* Live shaping. Call it once a cycle.
   share is the speed over the full speed, to the drive; velocity_m_s the speed. busy is TRUE while
   switches are still to come. kept is TRUE while wanted waits: no plan was found within the bound,
   the last one goes on. ${CABLEREMARK}error is TRUE from a
   cycle_time_s that is not above 0 or above $LONGEST s, until enable is FALSE. residual is that
   of the last plan, as the block counted it, a share of an unshaped step.
   enable FALSE is speed 0 at once: take it away at rest only. wanted is a share, -1.0 to 1.0. *)
FUNCTION_BLOCK ${NAME}_shaper
VAR_INPUT
    enable : BOOL;
    wanted : $REAL;
${CABLEINPUT}    cycle_time_s : $REAL;
END_VAR
VAR_OUTPUT
    share : $REAL;
    velocity_m_s : $REAL;
    busy : BOOL;
    kept : BOOL;
${CABLEOUTPUT}    error : BOOL;
    residual : $REAL;
END_VAR
VAR CONSTANT
    first_s : ARRAY[0..1] OF $REAL := [
$FIRST];
    second_s2 : ARRAY[0..1] OF $REAL := [
$SECOND];
END_VAR
VAR
    enabled : BOOL;
    lag : DINT;
    target : $REAL;
    asked : $REAL;
    goal : $REAL;
    top : $REAL;
    elapsed_s : $REAL;
    lost_s : $REAL;
    added_s : $REAL;
    sum_s : $REAL;
    length_m : $REAL;
    frequency_rad_s : $REAL;
    decay : $REAL;
    turn : $REAL;
    gains : ARRAY[0..7] OF $REAL;
    bound : $REAL;
    re : $REAL;
    im : $REAL;
    error_now : $REAL;
    rate_now : $REAL;
    below_re : $REAL;
    below_im : $REAL;
    size : $REAL;
    level : $REAL;
    levels : ARRAY[0..7] OF $REAL;
    calls : ARRAY[0..7] OF DINT;
    count : DINT;
    place : DINT;
    passed : DINT;
    k : DINT;
    flow : ${NAME}_over;
    switched : ${NAME}_switch;
    replan : ${NAME}_replan;
END_VAR
IF NOT enable OR NOT enabled THEN
    enabled := enable;
    share := 0.0;
    error := FALSE;
    residual := 0.0;
    lag := 0;
    target := 0.0;
    top := 0.0;
    elapsed_s := $SETTLED;
    lost_s := 0.0;
    length_m := 0.0;
    re := 0.0;
    im := 0.0;
    error_now := 0.0;
    rate_now := 0.0;
    count := 0;
    place := 0;
ELSE
    added_s := cycle_time_s - lost_s;
    sum_s := elapsed_s + added_s;
    lost_s := (sum_s - elapsed_s) - added_s;
    elapsed_s := sum_s;
    passed := passed + 1;
END_IF;
(* Written so that not-a-number fails. *)
IF enable AND NOT (cycle_time_s > 0.0 AND cycle_time_s <= $LONGESTC) THEN
    error := TRUE;
END_IF;
asked := 0.0;
IF wanted >= -1.0 AND wanted <= 1.0 THEN
    asked := wanted;
END_IF;
IF wanted > 1.0 THEN
    asked := 1.0;
END_IF;
IF wanted < -1.0 THEN
    asked := -1.0;
END_IF;
IF enable AND place >= count AND elapsed_s >= $SETTLED THEN
    top := share;
    IF ${TAKES} THEN
        length_m := $LENGTH;
        frequency_rad_s := $FREQUENCY;
        decay := -frequency_rad_s * $DAMPING;
        turn := frequency_rad_s * $ROOT;
        FOR k := 0 TO 1 DO
            (* 1 / G = 1 + p (first + second p), at the pole p of the swing. *)
            below_re := 1.0 + first_s[k] * decay + second_s2[k] * (decay * decay - turn * turn);
            below_im := turn * (first_s[k] + 2.0 * second_s2[k] * decay);
            size := below_re * below_re + below_im * below_im;
            gains[4 * k] := -below_re / size;
            gains[4 * k + 1] := below_im / size;
            gains[4 * k + 2] := second_s2[k] * (below_re * decay + below_im * turn) / size;
            gains[4 * k + 3] := second_s2[k] * (below_re * turn - below_im * decay) / size;
            IF k = 0 THEN
                bound := $BOUND / SQRT(size);
            END_IF;
        END_FOR;
    END_IF;
END_IF;
${CABLESEEN}kept := FALSE;
IF NOT enable OR error OR NOT (length_m > 0.0) THEN
    kept := enable AND asked <> 0.0;
    share := 0.0;
    busy := FALSE;
ELSE
    IF asked <> target THEN
        flow(decay := decay, turn := turn, time_s := elapsed_s, lag := lag);
        replan(decay := decay, turn := turn, gains := gains, bound := bound,
            cycle_s := cycle_time_s, re_now := flow.x * re - flow.y * im,
            im_now := flow.x * im + flow.y * re,
            error_now := flow.ee * error_now + flow.er * rate_now,
            rate_now := flow.re * error_now + flow.rr * rate_now, lag_now := lag,
            level := share, wanted := asked, top := top);
        goal := asked;
        IF NOT replan.solved AND share * asked < 0.0 AND target <> 0.0 THEN
            (* Stop first. *)
            goal := 0.0;
            replan(wanted := goal);
        END_IF;
        IF replan.solved THEN
            target := goal;
            residual := replan.residual;
            count := replan.count;
            place := 0;
            passed := 0;
            FOR k := 0 TO count - 1 DO
                calls[k] := replan.calls[k];
                levels[k] := replan.levels[k];
            END_FOR;
        END_IF;
        kept := asked <> target;
    END_IF;
    IF place < count THEN
        IF calls[place] <= passed THEN
            level := levels[place];
            place := place + 1;
            IF level <> share THEN
                flow(decay := decay, turn := turn, time_s := elapsed_s, lag := lag);
                switched(gains := gains, re := flow.x * re - flow.y * im,
                    im := flow.x * im + flow.y * re,
                    error := flow.ee * error_now + flow.er * rate_now,
                    rate := flow.re * error_now + flow.rr * rate_now, lag := lag,
                    before := share, after := level);
                rate_now := flow.re * error_now + flow.rr * rate_now;
                re := switched.new_re;
                im := switched.new_im;
                error_now := switched.new_error;
                lag := switched.new_lag;
                share := level;
                elapsed_s := 0.0;
                lost_s := 0.0;
                IF level * top < 0.0 OR ABS(level) > ABS(top) THEN
                    top := level;
                END_IF;
            END_IF;
        END_IF;
    END_IF;
    busy := place < count;
END_IF;
velocity_m_s := share * $SPEED;
END_FUNCTION_BLOCK""")


CALL = Template("""\
(* How to call it, from a task of $CYCLE s:

PROGRAM ${NAME}_main
VAR
    enable : BOOL;
    wanted : $REAL;
${CABLEINPUT}    velocity_m_s : $REAL;
    crane : ${NAME}_shaper;
END_VAR
crane(enable := enable, wanted := wanted,${CABLECALL} cycle_time_s := $CYCLE);
velocity_m_s := crane.velocity_m_s;
END_PROGRAM
*)

""")
