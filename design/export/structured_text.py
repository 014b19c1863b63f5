"""IEC 61131-3 Structured Text: the table, polynomials for its times, and a shaper, as blocks.

Numbers are LREAL. There is no not-a-number to write: a row without a design holds zeros, its
impulses let the command pass, and the output ``status`` says so.
"""

from collections.abc import Iterable, Iterator
from string import Template

import numpy as np

from design.curve_fit.polynomials import Fit
from design.export.kind import Export
from design.export.program import (
    Listing,
    check_program,
    comment,
    dividing,
    listing,
    name_of,
    range_of,
)
from design.export.sampled_program import sampled_listing
from design.export.sampled_text import sampled_shaper_in_text, sampled_table_in_text
from design.export.structured_numbers import lines, real, reals
from design.tables.rows import WITH_DESIGN, Rows, TableHead

TABLE = Template("""\
(* Times and amplitudes of one row. status 0: verified; 3: verified for an ideal actuator only;
   1, 2: no design, the times are zeros and the amplitudes 1, 0, ..., which let the command pass;
   -1: no such row, the outputs stay. *)
FUNCTION_BLOCK ${NAME}_table
VAR_INPUT
    row : DINT;
END_VAR
VAR_OUTPUT
    status : SINT;
    times_s : ARRAY[1..$IMPULSES] OF LREAL;
    amplitudes : ARRAY[1..$IMPULSES] OF LREAL;
    columns : ARRAY[1..$COLUMNS] OF LREAL;
END_VAR
VAR CONSTANT
    all_columns : ARRAY[0..$LASTNUMBER] OF LREAL := [
$ALLCOLUMNS];
    all_times_s : ARRAY[0..$LASTTIME] OF LREAL := [
$ALLTIMES];
    all_amplitudes : ARRAY[0..$LASTTIME] OF LREAL := [
$ALLAMPLITUDES];
    all_status : ARRAY[0..$LASTROW] OF SINT := [
$ALLSTATUS];
END_VAR
VAR
    k : DINT;
END_VAR
IF row < 0 OR row > $LASTROW THEN
    status := -1;
ELSE
    status := all_status[row];
    FOR k := 1 TO $IMPULSES DO
        times_s[k] := all_times_s[row * $IMPULSES + k - 1];
        amplitudes[k] := all_amplitudes[row * $IMPULSES + k - 1];
    END_FOR;
    FOR k := 1 TO $COLUMNS DO
        columns[k] := all_columns[row * $COLUMNS + k - 1];
    END_FOR;
END_IF;
END_FUNCTION_BLOCK

""")

EVALUATOR = Template("""\
(* Times of the impulses by polynomials in x = $MEANING,
   for x from $FIRST to $LAST; valid is FALSE outside, and the times stay.
   $FORMULA *)
FUNCTION_BLOCK ${NAME}_evaluator
VAR_INPUT
$VARIABLES
END_VAR
VAR_OUTPUT
    valid : BOOL;
    times_s : ARRAY[1..$IMPULSES] OF LREAL;
END_VAR
VAR CONSTANT
    coefficients : ARRAY[0..$LASTCOEFFICIENT] OF LREAL := [
$COEFFICIENTS];
END_VAR
VAR
    k : DINT;
    power : DINT;
${LOCAL}    value : LREAL;
END_VAR
${PREPARED}valid := x >= $FIRST AND x <= $LAST;
IF valid THEN
    FOR k := 1 TO $IMPULSES DO
        value := coefficients[k * $TERMS - 1];
        FOR power := 2 TO $TERMS DO
            value := value * x + coefficients[k * $TERMS - power];
        END_FOR;
        times_s[k] := $DIVIDED;
    END_FOR;
END_IF;
END_FUNCTION_BLOCK

""")

SHAPER = Template("""\
(* A shaper for a live command: call it once every sample_time_s. Each impulse delays the command by
   its time and adds it by its amplitude; a delay between two samples takes the line between them.
   Times and amplitudes may change at any call, the delay line stays. The first call fills the line
   with its command, and so does reset. ready is FALSE, and the command passes as it is, while a
   time is negative, the sample time is not above 0, or the last time needs a longer line: then
   raise 4095 in both places. *)
FUNCTION_BLOCK ${NAME}_shaper
VAR_INPUT
    command : LREAL;
    times_s : ARRAY[1..$IMPULSES] OF LREAL;
    amplitudes : ARRAY[1..$IMPULSES] OF LREAL;
    sample_time_s : LREAL;
    reset : BOOL;
END_VAR
VAR_OUTPUT
    shaped : LREAL;
    ready : BOOL;
END_VAR
VAR CONSTANT
    last_cell : DINT := 4095;
END_VAR
VAR
    line : ARRAY[0..4095] OF LREAL;
    newest : DINT;
    filled : BOOL;
    k : DINT;
    at_cell : DINT;
    before_cell : DINT;
    whole : DINT;
    samples : LREAL;
    part : LREAL;
END_VAR
IF reset OR NOT filled THEN
    FOR k := 0 TO last_cell DO
        line[k] := command;
    END_FOR;
    newest := 0;
    filled := TRUE;
END_IF;
IF newest < last_cell THEN
    newest := newest + 1;
ELSE
    newest := 0;
END_IF;
line[newest] := command;
ready := sample_time_s > 0.0;
FOR k := 1 TO $IMPULSES DO
    IF times_s[k] < 0.0 OR times_s[k] > DINT_TO_LREAL(last_cell - 1) * sample_time_s THEN
        ready := FALSE;
    END_IF;
END_FOR;
IF ready THEN
    shaped := 0.0;
    FOR k := 1 TO $IMPULSES DO
        samples := times_s[k] / sample_time_s;
        whole := TRUNC(samples);
        part := samples - DINT_TO_LREAL(whole);
        at_cell := newest - whole;
        IF at_cell < 0 THEN
            at_cell := at_cell + last_cell + 1;
        END_IF;
        before_cell := at_cell - 1;
        IF before_cell < 0 THEN
            before_cell := last_cell;
        END_IF;
        shaped := shaped + amplitudes[k] * (1.0 - part) * line[at_cell];
        shaped := shaped + amplitudes[k] * part * line[before_cell];
    END_FOR;
ELSE
    shaped := command;
END_IF;
END_FUNCTION_BLOCK
""")


def write_st(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as function blocks.

    An evaluator follows if the head has a fit.

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
    rows = listing(head, runs)
    # A title must not end or open a comment.
    top = comment(head, rows, {"*)": "* )", "(*": "( *"})
    yield f"(* {top} *)\n\n".encode()
    if head.on_samples:
        sampled = sampled_listing(head, rows)
        yield sampled_table_in_text(name, rows, sampled).encode()
        yield sampled_shaper_in_text(name, sampled).encode()
        return
    yield _table(head, name, rows).encode()
    if head.fit is not None:
        yield _evaluator(head, head.fit, name).encode()
    yield SHAPER.substitute(NAME=name, IMPULSES=head.impulses).encode()


def _table(head: TableHead, name: str, rows: Listing) -> str:
    without = ~np.isin(rows.status, WITH_DESIGN)
    amplitudes = np.where(without[:, None], np.eye(1, head.impulses), rows.amplitudes)
    return TABLE.substitute(
        NAME=name,
        IMPULSES=head.impulses,
        COLUMNS=rows.numbers.shape[1],
        LASTNUMBER=rows.numbers.size - 1,
        LASTTIME=rows.times_s.size - 1,
        LASTROW=head.rows - 1,
        ALLCOLUMNS=reals(rows.numbers),
        ALLTIMES=reals(rows.times_s),
        ALLAMPLITUDES=reals(amplitudes),
        ALLSTATUS=lines([str(code) for code in rows.status]),
    )


def _evaluator(head: TableHead, fit: Fit, name: str) -> str:
    unit = fit.frequency_unit_rad_s
    frequency = "    natural_frequency_rad_s : LREAL;"
    by_frequency = unit is not None
    first, last = range_of(fit)
    return EVALUATOR.substitute(
        NAME=name,
        IMPULSES=head.impulses,
        TERMS=fit.degree + 1,
        MEANING=fit.variable.meaning.replace("*", "times"),
        FIRST=real(first),
        LAST=real(last),
        FORMULA=fit.formula,
        VARIABLES=frequency if by_frequency else f"    x : LREAL;\n{frequency}",
        LOCAL="    x : LREAL;\n" if by_frequency else "",
        PREPARED=f"x := natural_frequency_rad_s / {real(unit)};\n" if unit is not None else "",
        LASTCOEFFICIENT=fit.coefficients.size - 1,
        COEFFICIENTS=reals(fit.coefficients),
        DIVIDED=dividing(fit),
    )


EXPORT = Export(
    name="st",
    media_type="text/plain; charset=utf-8",
    suffix=".st",
    checks=check_program,
    write=write_st,
)
