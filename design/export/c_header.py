"""A C99 header: the table, polynomials for its times, and a shaper to run on a live command.

Everything is ``static`` in the header, so that no object file is needed, and nothing allocates.
Numbers are ``double``, or ``float`` where ``SHAPERSMITH_FLOAT`` is defined ahead of the include;
literals carry the suffix, so that no double arithmetic sneaks into a single-precision unit.
"""

import re
from collections.abc import Iterable, Iterator
from string import Template

import numpy as np

from design.curve_fit.polynomials import Fit
from design.export.c_numbers import REAL, literal
from design.export.kind import Export
from design.export.live_blocks.c import live_in_c
from design.export.lookup import constants, lookup_of, lookup_remarks, rounding_remark, up
from design.export.lookup_c import axes_in_c, lookup_in_c
from design.export.move_c import move_in_c
from design.export.program import (
    HASH_DIGITS,
    Listing,
    check_program,
    comment,
    decimal,
    dividing,
    gravity_of,
    listing,
    name_of,
    range_of,
)
from design.export.sampled_c import sampled_rows_in_c, sampled_shaper_in_c
from design.export.sampled_program import SampledListing, sampled_listing
from design.tables.rows import Rows, TableHead, join_rows
from design.types import FloatArray

SHAPER = Template("""\
/* A shaper for a live command, sampled every sample_time_s: each impulse delays the command by its
   time and adds it by its amplitude. A delay between two samples takes the line between them.
   The caller owns the memory of the delay line: no allocation.

     static shapersmith_real memory[1024];  // cells: the last time over sample_time_s, and 2 more
     static ${NAME}_shaper shaper;
     ${NAME}_start(&shaper, memory, 1024, SHAPERSMITH_C(0.0));
$SET
     every sample: out = ${NAME}_step(&shaper, in); */
typedef struct {
    shapersmith_real *line;
    size_t length;
    size_t newest;
    size_t whole[${UPPER}_IMPULSES];
    shapersmith_real newer[${UPPER}_IMPULSES];
    shapersmith_real older[${UPPER}_IMPULSES];
} ${NAME}_shaper;

/* Begin at rest at a command; until ${NAME}_set the command passes as it is. */
static inline void ${NAME}_start(${NAME}_shaper *shaper, shapersmith_real *memory, size_t length,
                              shapersmith_real command)
{
    size_t k;
    for (k = 0; k < length; ++k) {
        memory[k] = command;
    }
    shaper->line = memory;
    shaper->length = length;
    shaper->newest = 0;
    for (k = 0; k < ${UPPER}_IMPULSES; ++k) {
        shaper->whole[k] = 0;
        shaper->newer[k] = SHAPERSMITH_C(0.0);
        shaper->older[k] = SHAPERSMITH_C(0.0);
    }
    shaper->newer[0] = SHAPERSMITH_C(1.0);
}

/* Take other impulses, the delay line stays. Returns 0; or -1, and changes nothing, if a time is no
   number >= 0, the sample time not above 0, or the line shorter than the last time needs. */
static inline int ${NAME}_set(${NAME}_shaper *shaper, const shapersmith_real *times_s,
                           const shapersmith_real *amplitudes, shapersmith_real sample_time_s)
{
    size_t k;
    for (k = 0; k < ${UPPER}_IMPULSES; ++k) {
        const shapersmith_real samples = times_s[k] / sample_time_s;
        /* Written so that not-a-number fails. Two cells more: the older sample, and rounding. */
        if (!(sample_time_s > SHAPERSMITH_C(0.0) && samples >= SHAPERSMITH_C(0.0)
              && samples + SHAPERSMITH_C(2.0) <= (shapersmith_real)shaper->length)) {
            return -1;
        }
    }
    for (k = 0; k < ${UPPER}_IMPULSES; ++k) {
        const shapersmith_real samples = times_s[k] / sample_time_s;
        const size_t whole = (size_t)samples;
        const shapersmith_real part = samples - (shapersmith_real)whole;
        shaper->whole[k] = whole;
        shaper->newer[k] = amplitudes[k] * (SHAPERSMITH_C(1.0) - part);
        shaper->older[k] = amplitudes[k] * part;
    }
    return 0;
}

/* Take one sample of the command, return one of the shaped command. */
static inline shapersmith_real ${NAME}_step(${NAME}_shaper *shaper, shapersmith_real command)
{
    shapersmith_real shaped = SHAPERSMITH_C(0.0);
    size_t k;
    shaper->newest = shaper->newest + 1 < shaper->length ? shaper->newest + 1 : 0;
    shaper->line[shaper->newest] = command;
    for (k = 0; k < ${UPPER}_IMPULSES; ++k) {
        const size_t back = shaper->whole[k];
        const size_t at = shaper->newest >= back ? shaper->newest - back
                                                 : shaper->newest + shaper->length - back;
        const size_t before = at > 0 ? at - 1 : shaper->length - 1;
        shaped += shaper->newer[k] * shaper->line[at] + shaper->older[k] * shaper->line[before];
    }
    return shaped;
}
""")

SAME_NAMES = Template("""\
#ifdef ${UPPER}_ROWS
#error "two tables have the names of ${NAME}: give one of them another title"
#endif

""")

SET_ROW = Template("""\
     ${NAME}_set(&shaper, ${NAME}_times[row], ${NAME}_amplitudes$OFROW, sample_time_s);""")

SET_EVALUATED = Template("""\
     shapersmith_real times_s[${UPPER}_IMPULSES];
     if (${NAME}_$CALL, times_s) == 0) {
         ${NAME}_set(&shaper, times_s, ${NAME}_$AMPLITUDES, sample_time_s);
     }""")

EVALUATOR = Template("""\
/* Times of the impulses [s] by polynomials in x = $MEANING,
   for x from $FIRST to $LAST; returns 0, or -1 and writes nothing outside.
   $FORMULA */
static inline int ${NAME}_evaluate(shapersmith_real x, shapersmith_real natural_frequency_rad_s,
                                shapersmith_real *times_s)
{
    size_t k, power;$UNUSED
    if (!(x >= SHAPERSMITH_C($FIRST) && x <= SHAPERSMITH_C($LAST))) {
        return -1;
    }
    for (k = 0; k < ${UPPER}_IMPULSES; ++k) {
        shapersmith_real value = ${NAME}_coefficients[k][${UPPER}_DEGREE];
        for (power = ${UPPER}_DEGREE; power > 0; --power) {
            value = value * x + ${NAME}_coefficients[k][power - 1];
        }
        times_s[k] = $DIVIDED;
    }
    return 0;
}
""")

AT_LENGTH = Template("""\

/* The same for a cable length [m], by the gravity of the specification. Compile with -lm. */
static inline int ${NAME}_evaluate_at_length(shapersmith_real cable_length_m,
                                          shapersmith_real *times_s)
{
    if (!(cable_length_m > SHAPERSMITH_C(0.0))) {
        return -1;
    }
    return ${NAME}_evaluate_at(SHAPERSMITH_SQRT(SHAPERSMITH_C($GRAVITY) / cable_length_m), times_s);
}
""")

AT_FREQUENCY = Template("""\

/* The same for a natural frequency of the plant, with the actuator of the specification. */
static inline int ${NAME}_evaluate_at(shapersmith_real natural_frequency_rad_s,
                                   shapersmith_real *times_s)
{
    return ${NAME}_evaluate(natural_frequency_rad_s / SHAPERSMITH_C($UNIT), natural_frequency_rad_s,
                         times_s);
}
""")


def write_c(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as a C99 header, with polynomials if the head has any.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Yields
    ------
    bytes
        Pieces of the file.

    Raises
    ------
    InvalidInputError
        If a number of the table is infinite.
    """
    name = name_of(head)
    upper = name.upper()
    held = list(runs)
    rows = listing(head, held)
    sampled = sampled_listing(head, rows) if head.on_samples else None
    found = lookup_of(head, join_rows(held))
    lookup = None if isinstance(found, str) else found
    more = []
    if sampled is None:
        more = lookup_remarks(found, name, in_single=False)
        if lookup is not None:
            more += [
                f"   in float at most {up(lookup.residual_in_single)}",
                f"   {rounding_remark(lookup)}",
            ]
        count = constants(rows, lookup)
        more.append(f"memory: {8 * count} bytes of constants in double, {4 * count} in float")
    # A title or a reason must not end the comment.
    top = comment(head, rows, {"*/": "* /"}, more)
    yield f"/* {top}\n   float rounds each number by up to 6e-8 of itself. */\n".encode()
    # By the specification too: a second file of the same names is an error, it does not vanish.
    guard = f"{upper}_{head.specification_sha256[:HASH_DIGITS].upper()}_H"
    yield f"#ifndef {guard}\n#define {guard}\n\n".encode()
    yield SAME_NAMES.substitute(NAME=name, UPPER=upper).encode()
    yield b"#include <math.h>\n#include <stddef.h>\n\n"
    axes = "" if lookup is None else axes_in_c(name, lookup)
    yield f"{REAL}\n{_columns(head, rows, upper)}{axes}\n".encode()
    yield from _table(name, rows, sampled)
    if lookup is not None:
        yield lookup_in_c(name, lookup).encode()
    if head.fit is not None:
        yield _evaluator(head, rows, head.fit, name).encode()
    if sampled is not None:
        yield sampled_shaper_in_c(name, sampled).encode()
    else:
        yield SHAPER.substitute(NAME=name, UPPER=upper, SET=_set(head, rows, name)).encode()
    yield b"\n#endif\n"


def _columns(head: TableHead, rows: Listing, upper: str) -> str:
    names = [re.sub(r"[^A-Z0-9]", "_", name.upper()) for name in rows.names]
    lines = [f"#define {upper}_ROWS {head.rows}", f"#define {upper}_IMPULSES {head.impulses}"]
    if head.fit is not None:
        lines.append(f"#define {upper}_DEGREE {head.fit.degree}")
    lines += [f"#define {upper}_COLUMNS {len(names)}"]
    lines += [f"#define {upper}_{column} {index}" for index, column in enumerate(names)]
    return "\n".join(lines) + "\n"


def _table(name: str, rows: Listing, sampled: SampledListing | None) -> Iterator[bytes]:
    """Yield the table, a row a line, then status, times or samples, amplitudes of each row."""
    upper = name.upper()
    fewer = "" if sampled is None else ", and so does what a row has fewer of"
    yield f"/* A row without a design, of status 1 or 2, holds NAN{fewer}. */\n".encode()
    if rows.names:
        yield _matrix(f"{name}_table[{upper}_ROWS][{upper}_COLUMNS]", rows.numbers).encode()
    codes = ", ".join(map(str, rows.status))
    yield f"\nstatic const unsigned char {name}_status[{upper}_ROWS] = {{{codes}}};\n\n".encode()
    shape = f"[{upper}_ROWS][{upper}_IMPULSES]"
    if sampled is not None:
        yield sampled_rows_in_c(name, sampled).encode()
    else:
        yield _matrix(f"{name}_times{shape}", rows.times_s).encode()
        yield b"\n"
    if sampled is None and rows.shared_amplitudes is not None:
        numbers = ", ".join(map(literal, rows.shared_amplitudes.tolist()))
        declared = f"{name}_amplitudes[{upper}_IMPULSES]"
        yield b"/* The same in all rows. */\n"
        yield f"static const shapersmith_real {declared} = {{{numbers}}};\n\n".encode()
        return
    amplitudes = rows.amplitudes if sampled is None else sampled.amplitudes
    yield _matrix(f"{name}_amplitudes{shape}", amplitudes).encode()
    yield b"\n"


def _matrix(declared: str, values: FloatArray) -> str:
    lines = ["    {" + ", ".join(map(literal, row)) + "}" for row in values.tolist()]
    return f"static const shapersmith_real {declared} = {{\n" + ",\n".join(lines) + "\n};\n"


def _set(head: TableHead, rows: Listing, name: str) -> str:
    """Return the lines that give a shaper its times: by the polynomials, or else of a row."""
    if head.fit is None:
        of_row = "[row]" if rows.shared_amplitudes is None else ""
        return SET_ROW.substitute(NAME=name, OFROW=of_row)
    call = "evaluate(x, natural_frequency_rad_s"
    if head.fit.frequency_unit_rad_s is not None:
        call = "evaluate_at(natural_frequency_rad_s"
        if gravity_of(head) is not None:
            call = "evaluate_at_length(cable_length_m"
    return SET_EVALUATED.substitute(
        NAME=name, UPPER=name.upper(), CALL=call, AMPLITUDES=_amplitudes_of_fit(rows, head.fit)
    )


def _amplitudes_of_fit(rows: Listing, fit: Fit) -> str:
    """Return the array that holds the amplitudes of the polynomials: the rows', if these agree."""
    shared = rows.shared_amplitudes
    agree = shared is not None and bool(np.array_equal(shared, fit.checks.amplitudes))
    return "amplitudes" if agree else "fit_amplitudes"


def _evaluator(head: TableHead, rows: Listing, fit: Fit, name: str) -> str:
    first, last = range_of(fit)
    text = EVALUATOR.substitute(
        NAME=name,
        UPPER=name.upper(),
        MEANING=fit.variable.meaning,
        FIRST=decimal(first),
        LAST=decimal(last),
        FORMULA=fit.formula,
        DIVIDED=dividing(fit),
        UNUSED="" if fit.in_phases else "\n    (void)natural_frequency_rad_s;",
    )
    unit = fit.frequency_unit_rad_s
    if unit is not None:
        text += AT_FREQUENCY.substitute(NAME=name, UNIT=decimal(unit))
        gravity = gravity_of(head)
        if gravity is not None:
            text += AT_LENGTH.substitute(NAME=name, GRAVITY=decimal(gravity))
    upper = name.upper()
    coefficients = _matrix(
        f"{name}_coefficients[{upper}_IMPULSES][{upper}_DEGREE + 1]", fit.coefficients
    )
    own = _amplitudes_of_fit(rows, fit)
    if own != "amplitudes":
        numbers = ", ".join(map(literal, fit.checks.amplitudes.tolist()))
        coefficients += (
            "/* Of the polynomials, for all x. */\n"
            f"static const shapersmith_real {name}_{own}[{upper}_IMPULSES] = {{{numbers}}};\n"
        )
    return f"{coefficients}\n{text}\n"


EXPORT = Export(
    name="c",
    media_type="text/x-c; charset=utf-8",
    suffix=".h",
    checks=check_program,
    write=write_c,
    move=lambda blocks: move_in_c(blocks).encode(),
    live=lambda block: live_in_c(block).encode(),
)
