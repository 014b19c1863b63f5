"""A whole move as a C99 header: start, stop and the whole, called once a cycle.

The functions do what the blocks of Structured Text do (`design.export.move_text`). All names begin
with that of the move, so that headers of several moves and tables may be in one program.
"""

from string import Template

from design.export.c_numbers import REAL, literal
from design.export.header import TOOL
from design.export.move import MoveBlocks, Sequence
from design.export.program import HASH_DIGITS, decimal
from design.export.sampled_program import SAME_SAMPLE_TIME

STATE = Template("""\
/* A sequence that is played; zeros at first. share is the speed over the full speed, velocity_m_s
   the speed, both signed in +x; the others are 0 or 1. */
typedef struct {
    shapersmith_real share;
    shapersmith_real velocity_m_s;
    int busy;
    int done;
    int error;
    int executed;
    shapersmith_real elapsed_s;
    shapersmith_real lost_s;
    long sample;
    size_t step;
} ${NAME}_sequence;

/* Begin, or end early; returns whether the sequence is played in this cycle. */
static inline int ${NAME}_goes(
    ${NAME}_sequence *sequence, int execute, int cancel, shapersmith_real cycle_time_s, int sound)
{
    if (execute && !sequence->executed && !sequence->busy) {
        sequence->busy = 1;
        sequence->error = 0;
        sequence->elapsed_s = SHAPERSMITH_C(0.0);
        sequence->lost_s = SHAPERSMITH_C(0.0);
        sequence->sample = 0;
        sequence->step = 0;
    } else if (sequence->busy) {
        /* Kahan's sum: in float a plain one drifts. Not to be compiled with -ffast-math. */
        const shapersmith_real added_s = cycle_time_s - sequence->lost_s;
        const shapersmith_real sum_s = sequence->elapsed_s + added_s;
        sequence->lost_s = (sum_s - sequence->elapsed_s) - added_s;
        sequence->elapsed_s = sum_s;
        sequence->sample += 1;
    }
    sequence->executed = execute;
    if (!sequence->busy && !execute) {
        sequence->done = 0;
        sequence->error = 0;
        sequence->share = SHAPERSMITH_C(0.0);
    }
    if ((sequence->busy || sequence->done) && (cancel || !sound)) {
        sequence->error = !sound;
        sequence->busy = 0;
        sequence->done = 0;
        sequence->share = SHAPERSMITH_C(0.0);
    }
    return sequence->busy;
}

""")

IN_TIME = Template("""\
/* $REMARK
   Call it once a cycle. A rising edge of execute begins it; while busy is 1 another edge changes
   nothing. done is 1 from its end until execute is 0. cancel ends it at once, at speed 0. So does a
   cycle_time_s that is not above 0, or above half a period of the plant: error is 1 then. */
#define ${UPPER}_STEPS $STEPS

static const shapersmith_real ${NAME}_${PART}_times_s[${UPPER}_STEPS] = {
$TIMES
};
$LEVELS
static inline void ${NAME}_${PART}(
    ${NAME}_sequence *sequence, int execute, int cancel, shapersmith_real cycle_time_s)
{
    /* Written so that not-a-number fails. */
    const int sound = cycle_time_s > SHAPERSMITH_C(0.0)
                      && cycle_time_s <= $LONGEST;
    if (${NAME}_goes(sequence, execute, cancel, cycle_time_s, sound)) {
        shapersmith_real share = SHAPERSMITH_C(0.0);
        shapersmith_real level = $FIRST;
        shapersmith_real held = SHAPERSMITH_C(1.0);
        size_t k;
        for (k = 0; k < ${UPPER}_STEPS; ++k) {
            shapersmith_real part = ((sequence->elapsed_s - ${NAME}_${PART}_times_s[k])
                                     + cycle_time_s) / cycle_time_s;
            part = part > held ? held : part;
            part = part < SHAPERSMITH_C(0.0) ? SHAPERSMITH_C(0.0) : part;
            share += level * (held - part);
            held = part;
            level = $NEXT;
        }
        sequence->share = share + level * held;
        if (sequence->elapsed_s >= $END) {
            sequence->busy = 0;
            sequence->done = 1;
        }
    }
    sequence->velocity_m_s = sequence->share * $SPEED;
}

""")

ON_SAMPLES = Template("""\
/* $REMARK
   Call it once a sample. A rising edge of execute begins it; while busy is 1 another edge changes
   nothing. done is 1 from its end until execute is 0. cancel ends it at once, at speed 0. So does a
   cycle_time_s that is not the sample time of the move: error is 1 then. */
#define ${UPPER}_STEPS $STEPS

static const long ${NAME}_${PART}_samples[${UPPER}_STEPS] = {
$SAMPLES
};
$LEVELS
static inline void ${NAME}_${PART}(
    ${NAME}_sequence *sequence, int execute, int cancel, shapersmith_real cycle_time_s)
{
    const shapersmith_real apart = cycle_time_s / $SAMPLETIME - SHAPERSMITH_C(1.0);
    /* Written so that not-a-number fails. */
    const int sound = apart <= SHAPERSMITH_C($SAME) && apart >= SHAPERSMITH_C(-$SAME);
    if (${NAME}_goes(sequence, execute, cancel, cycle_time_s, sound)) {
        if (sequence->step < ${UPPER}_STEPS
            && ${NAME}_${PART}_samples[sequence->step] == sequence->sample) {
            sequence->share = ${NAME}_${PART}_levels[sequence->step];
            sequence->step += 1;
        }
        if (sequence->sample >= $LAST) {
            sequence->busy = 0;
            sequence->done = 1;
        }
    }
    sequence->velocity_m_s = sequence->share * $SPEED;
}

""")

NUMBERS_PER_LINE = 3
"""Of the tables."""

CALL = Template("""\
   How to call it, once a cycle of $CYCLE s:

     static ${NAME}_sequence whole;
     ${NAME}_move(&whole, go, 0, SHAPERSMITH_C($CYCLE));
     velocity_m_s = whole.velocity_m_s;""")


def move_in_c(blocks: MoveBlocks) -> str:
    """Return a move as a header.

    Parameters
    ----------
    blocks
        The move.

    Returns
    -------
    str
        Numbers are ``double``, or ``float`` where ``SHAPERSMITH_FLOAT`` is defined ahead.

    Raises
    ------
    InvalidInputError
        If a number is not finite.
    """
    name = blocks.name
    # By the request too: a second file of the same names is an error, it does not vanish.
    guard = f"{name.upper()}_{blocks.sha256[:HASH_DIGITS].upper()}_H"
    figures = [
        line.replace("in LREAL", "in double").replace("in REAL", "in float")
        for of in ("LREAL", "REAL")
        for line in blocks.figures[of]
    ]
    told = [
        f"one move, by {TOOL} {blocks.version}",
        f"request sha256 {blocks.sha256}",
        *blocks.remarks,
        *figures,
        f"memory: {8 * blocks.numbers} bytes of tables in double, {4 * blocks.numbers} in float",
    ]
    call = CALL.substitute(NAME=name, CYCLE=decimal(blocks.example_cycle_s))
    top = ("\n   ".join(told) + f"\n\n{call}").replace("*/", "* /")
    return "".join([
        f"/* {top} */\n#ifndef {guard}\n#define {guard}\n\n#include <stddef.h>\n\n{REAL}\n",
        STATE.substitute(NAME=name),
        *(_sequence(blocks, sequence) for sequence in blocks.sequences),
        "#endif\n",
    ])


def _sequence(blocks: MoveBlocks, sequence: Sequence) -> str:
    given = {
        "NAME": blocks.name,
        "UPPER": f"{blocks.name}_{sequence.name}".upper(),
        "PART": sequence.name,
        "REMARK": sequence.remark.replace("TRUE", "1"),
        "STEPS": sequence.times_s.size,
        "SPEED": literal(blocks.speed_m_s),
    }
    levels = ""
    if sequence.toggles is None or sequence.sample_time_s is not None:
        levels = (
            f"\nstatic const shapersmith_real {blocks.name}_{sequence.name}_levels"
            f"[{given['UPPER']}_STEPS] = {{\n"
            f"{_lines([literal(one) for one in sequence.levels[1:].tolist()])}\n}};\n"
        )
    if sequence.sample_time_s is not None:
        return ON_SAMPLES.substitute(
            given,
            LEVELS=levels,
            SAMPLES=_lines(list(map(str, sequence.samples.tolist()))),
            SAMPLETIME=literal(sequence.sample_time_s),
            SAME=decimal(SAME_SAMPLE_TIME),
            LAST=sequence.last_sample,
        )
    toggles = sequence.toggles
    return IN_TIME.substitute(
        given,
        LEVELS=levels,
        TIMES=_lines([literal(one) for one in sequence.times_s.tolist()]),
        LONGEST=literal(blocks.longest_cycle_s),
        FIRST=literal(float(sequence.levels[0])),
        NEXT=f"{literal(toggles)} - level"
        if toggles is not None
        else f"{blocks.name}_{sequence.name}_levels[k]",
        END=literal(sequence.end_s),
    )


def _lines(texts: list[str]) -> str:
    parts = [texts[at : at + NUMBERS_PER_LINE] for at in range(0, len(texts), NUMBERS_PER_LINE)]
    return ",\n".join(f"    {', '.join(part)}" for part in parts)
