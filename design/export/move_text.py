"""A whole move as blocks of Structured Text: start, stop and the whole, called once a cycle.

Each level is a mean over its cycle: a step between two cycles is shared by them, so that it keeps
its mean time. The time is summed with the error of each addition carried along: in single precision
a plain sum of cycles of 1 ms drifts by milliseconds within minutes.

References
----------
.. [1] W. Kahan, "Further remarks on reducing truncation errors", Comm. ACM 8 (1965) 40.
.. [2] PLCopen, "Function blocks for motion control", part 1: Execute, Busy, Done, Error.
"""

from string import Template

from design.export.header import TOOL
from design.export.move import MoveBlocks, Sequence
from design.export.sampled_program import SAME_SAMPLE_TIME
from design.export.structured_numbers import BYTES, lines, real, reals

BLOCK = Template("""\
(* $REMARK
   Call it once a cycle. A rising edge of execute begins it; while busy is TRUE another edge changes
   nothing. done is TRUE from its end until execute is FALSE. cancel ends it at once, at speed 0. So
   does a cycle_time_s that $WRONG: error is TRUE then.
   share is the speed over the full speed, velocity_m_s the speed, both signed in +x. *)
FUNCTION_BLOCK ${NAME}_$PART
VAR_INPUT
    execute : BOOL;
    cancel : BOOL;
    cycle_time_s : $REAL;
END_VAR
VAR_OUTPUT
    share : $REAL;
    velocity_m_s : $REAL;
    busy : BOOL;
    done : BOOL;
    error : BOOL;
END_VAR
VAR CONSTANT
    steps : DINT := $STEPS;
END_VAR
VAR CONSTANT
    full_speed_m_s : $REAL := $SPEED;
${CONSTANTS}END_VAR
VAR
    executed : BOOL;
    sound : BOOL;
${VARIABLES}END_VAR
sound := $SOUND;
IF execute AND NOT executed AND NOT busy THEN
    busy := TRUE;
    error := FALSE;
${BEGIN}ELSE
    IF busy THEN
${ADVANCE}    END_IF;
END_IF;
executed := execute;
IF NOT busy AND NOT execute THEN
    done := FALSE;
    error := FALSE;
    share := 0.0;
END_IF;
IF (busy OR done) AND (cancel OR NOT sound) THEN
    error := NOT sound;
    busy := FALSE;
    done := FALSE;
    share := 0.0;
END_IF;
IF busy THEN
${PLAY}END_IF;
velocity_m_s := share * full_speed_m_s;
END_FUNCTION_BLOCK""")

IN_TIME = {
    "WRONG": "is not above 0, or above half a period of the plant",
    "SOUND": "cycle_time_s > 0.0 AND cycle_time_s <= longest_cycle_s",
    "VARIABLES": """\
    elapsed_s : $REAL;
    lost_s : $REAL;
    added_s : $REAL;
    sum_s : $REAL;
    level : $REAL;
    held : $REAL;
    part : $REAL;
    k : DINT;
""",
    "BEGIN": """\
    elapsed_s := 0.0;
    lost_s := 0.0;
""",
    "ADVANCE": """\
        added_s := cycle_time_s - lost_s;
        sum_s := elapsed_s + added_s;
        lost_s := (sum_s - elapsed_s) - added_s;
        elapsed_s := sum_s;
""",
    "PLAY": """\
    share := 0.0;
    level := first_level;
    held := 1.0;
    FOR k := 1 TO steps DO
        part := ((elapsed_s - times_s[k]) + cycle_time_s) / cycle_time_s;
        IF part > held THEN
            part := held;
        END_IF;
        IF part < 0.0 THEN
            part := 0.0;
        END_IF;
        share := share + level * (held - part);
        held := part;
        level := $NEXT;
    END_FOR;
    share := share + level * held;
    IF elapsed_s >= end_s THEN
        busy := FALSE;
        done := TRUE;
    END_IF;
""",
}
"""Parts of a block whose steps are at any time."""

ON_SAMPLES = {
    "WRONG": "is not the sample time of the move",
    "SOUND": """\
cycle_time_s <= sample_time_s * (1.0 + $SAME)
    AND cycle_time_s >= sample_time_s * (1.0 - $SAME)""",
    "VARIABLES": """\
    sample : DINT;
    k : DINT;
""",
    "BEGIN": """\
    sample := 0;
    k := 1;
""",
    "ADVANCE": """\
        sample := sample + 1;
""",
    "PLAY": """\
    IF k <= steps THEN
        IF samples[k] = sample THEN
            share := levels[k];
            k := k + 1;
        END_IF;
    END_IF;
    IF sample >= last_sample THEN
        busy := FALSE;
        done := TRUE;
    END_IF;
""",
}
"""Parts of a block whose steps are on samples."""

CALL = Template("""\
(* How to call it, from a task of $CYCLE s:

PROGRAM ${NAME}_main
VAR
    go : BOOL;
    velocity_m_s : $REAL;
    whole : ${NAME}_move;
END_VAR
whole(execute := go, cycle_time_s := $CYCLE);
velocity_m_s := whole.velocity_m_s;
END_PROGRAM
$APART*)

""")

CALL_APART = Template("""
Start and stop apart, as long as go is TRUE:

PROGRAM ${NAME}_drive
VAR
    go : BOOL;
    moving : BOOL;
    velocity_m_s : $REAL;
    starting : ${NAME}_start;
    stopping : ${NAME}_stop;
END_VAR
IF go AND NOT starting.done THEN
    moving := TRUE;
END_IF;
starting(execute := moving, cycle_time_s := $CYCLE);
stopping(execute := starting.done AND NOT go, cycle_time_s := $CYCLE);
IF stopping.busy OR stopping.done THEN
    velocity_m_s := stopping.velocity_m_s;
ELSE
    velocity_m_s := starting.velocity_m_s;
END_IF;
IF stopping.done OR starting.error OR stopping.error THEN
    moving := FALSE;
END_IF;
END_PROGRAM
""")


def move_in_text(blocks: MoveBlocks) -> str:
    """Return a move as Structured Text.

    Parameters
    ----------
    blocks
        The move.

    Returns
    -------
    str
        A comment, the example of a call, then the function blocks.

    Raises
    ------
    InvalidInputError
        If a number is not finite in its type.
    """
    of = blocks.real
    memory = BYTES[of] * blocks.numbers
    told = [
        f"one move, by {TOOL} {blocks.version}",
        f"request sha256 {blocks.sha256}",
        *blocks.remarks,
        *blocks.figures[of],
        f"numbers: {of}; memory: {memory} bytes of tables",
    ]
    comment = "\n   ".join(told).replace("*)", "* )").replace("(*", "( *")
    return "".join([
        f"(* {comment} *)\n\n",
        _call(blocks),
        "\n\n".join(_block(blocks, sequence) for sequence in blocks.sequences),
        "\n",
    ])


def _call(blocks: MoveBlocks) -> str:
    given = {
        "NAME": blocks.name,
        "REAL": blocks.real,
        "CYCLE": real(blocks.example_cycle_s, blocks.real),
    }
    apart = CALL_APART.substitute(given) if len(blocks.sequences) > 1 else ""
    return CALL.substitute(given, APART=apart)


def _block(blocks: MoveBlocks, sequence: Sequence) -> str:
    of = blocks.real
    given = {
        "REAL": of,
        "SAME": real(SAME_SAMPLE_TIME, of),
        "NEXT": "levels[k]" if sequence.toggles is None else "height - level",
    }
    parts = IN_TIME if sequence.sample_time_s is None else ON_SAMPLES
    return BLOCK.substitute(
        {name: Template(part).substitute(given) for name, part in parts.items()},
        NAME=blocks.name,
        PART=sequence.name,
        REMARK=sequence.remark,
        REAL=of,
        STEPS=sequence.times_s.size,
        SPEED=real(blocks.speed_m_s, of),
        CONSTANTS=_constants(blocks, sequence),
    )


def _constants(blocks: MoveBlocks, sequence: Sequence) -> str:
    of = blocks.real
    levels = f"    levels : ARRAY[1..steps] OF {of} := [\n{reals(sequence.levels[1:], of)}];\n"
    if sequence.sample_time_s is not None:
        samples = lines(list(map(str, sequence.samples.tolist())))
        return (
            f"    sample_time_s : {of} := {real(sequence.sample_time_s, of)};\n"
            f"    last_sample : DINT := {sequence.last_sample};\n"
            f"    samples : ARRAY[1..steps] OF DINT := [\n{samples}];\n{levels}"
        )
    if sequence.toggles is not None:
        levels = f"    height : {of} := {real(sequence.toggles, of)};\n"
    return (
        f"    longest_cycle_s : {of} := {real(blocks.longest_cycle_s, of)};\n"
        f"    end_s : {of} := {real(sequence.end_s, of)};\n"
        f"    first_level : {of} := {real(float(sequence.levels[0]), of)};\n"
        f"    times_s : ARRAY[1..steps] OF {of} := [\n{reals(sequence.times_s, of)}];\n{levels}"
    )
