"""IEC 61131-3 Structured Text: the table, polynomials for its times, and a shaper, as blocks.

Numbers are LREAL, or REAL where the specification says so. There is no not-a-number to write: a row
without a design holds zeros, its impulses let the command pass, and the output ``status`` says so.
"""

from collections.abc import Iterable, Iterator
from string import Template

import numpy as np

from design.curve_fit.polynomials import Fit
from design.export.kind import Export
from design.export.live_blocks.text import live_in_text
from design.export.lookup import Lookup, constants, lookup_of, lookup_remarks
from design.export.lookup_text import lookup_in_text
from design.export.move_text import move_in_text
from design.export.program import (
    Listing,
    check_program,
    comment,
    dividing,
    gravity_of,
    listing,
    name_of,
    range_of,
)
from design.export.sampled_program import sampled_listing
from design.export.sampled_text import sampled_shaper_in_text, sampled_table_in_text
from design.export.structured_numbers import BYTES, columns_in_text, lines, real, reals
from design.tables.rows import Rows, TableHead, join_rows, subject_of

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
    times_s : ARRAY[1..$IMPULSES] OF $REAL;
    amplitudes : ARRAY[1..$IMPULSES] OF $REAL;
${COLUMNS}END_VAR
VAR CONSTANT
    last_row : DINT := $LASTROW;
    impulses : DINT := $IMPULSES;
${ALLCOLUMNS}    all_times_s : ARRAY[0..$LASTTIME] OF $REAL := [
$ALLTIMES];
    all_amplitudes : ARRAY[0..$LASTAMPLITUDE] OF $REAL := [
$ALLAMPLITUDES];
    all_status : ARRAY[0..$LASTROW] OF SINT := [
$ALLSTATUS];
END_VAR
VAR
    k : DINT;
END_VAR
IF row < 0 OR row > last_row THEN
    status := -1;
ELSE
    status := all_status[row];
    FOR k := 1 TO impulses DO
        times_s[k] := all_times_s[row * impulses + k - 1];
        amplitudes[k] := all_amplitudes[$OFROW];
    END_FOR;
${WITHOUT}${COPIED}END_IF;
END_FUNCTION_BLOCK

""")

WITHOUT_DESIGN = """\
    IF status = 1 OR status = 2 THEN
        FOR k := 1 TO impulses DO
            amplitudes[k] := 0.0;
        END_FOR;
        amplitudes[1] := 1.0;
    END_IF;
"""

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
    times_s : ARRAY[1..$IMPULSES] OF $REAL;
    amplitudes : ARRAY[1..$IMPULSES] OF $REAL := [
$AMPLITUDES];
END_VAR
VAR CONSTANT
    impulses : DINT := $IMPULSES;
    terms : DINT := $TERMS;
    x_first : $REAL := $FIRST;
    x_last : $REAL := $LAST;
    coefficients : ARRAY[0..$LASTCOEFFICIENT] OF $REAL := [
$COEFFICIENTS];
END_VAR
VAR
    k : DINT;
    power : DINT;
${LOCAL}    value : $REAL;
END_VAR
${PREPARED}valid := x >= x_first AND x <= x_last;
IF valid THEN
    FOR k := 1 TO impulses DO
        value := coefficients[k * terms - 1];
        FOR power := 2 TO terms DO
            value := value * x + coefficients[k * terms - power];
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
   raise last_cell. *)
FUNCTION_BLOCK ${NAME}_shaper
VAR_INPUT
    command : $REAL;
    times_s : ARRAY[1..$IMPULSES] OF $REAL;
    amplitudes : ARRAY[1..$IMPULSES] OF $REAL;
    sample_time_s : $REAL;
    reset : BOOL;
END_VAR
VAR_OUTPUT
    shaped : $REAL;
    ready : BOOL;
END_VAR
VAR CONSTANT
    impulses : DINT := $IMPULSES;
    last_cell : DINT := $LASTCELL;
END_VAR
VAR
    line : ARRAY[0..last_cell] OF $REAL;
    newest : DINT;
    filled : BOOL;
    k : DINT;
    at_cell : DINT;
    before_cell : DINT;
    whole : DINT;
    samples : $REAL;
    part : $REAL;
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
FOR k := 1 TO impulses DO
    IF times_s[k] < 0.0 OR times_s[k] > DINT_TO_$REAL(last_cell - 1) * sample_time_s THEN
        ready := FALSE;
    END_IF;
END_FOR;
IF ready THEN
    shaped := 0.0;
    FOR k := 1 TO impulses DO
        samples := times_s[k] / sample_time_s;
        whole := TRUNC(samples);
        part := samples - DINT_TO_$REAL(whole);
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

LAST_CELL = 4095
"""Of the delay line: 16 s of a task of 4 ms."""

CALL = Template("""\
(* How to call it, from a task of $SAMPLE s:

PROGRAM ${NAME}_main
VAR
    command : $REAL;
    velocity : $REAL;
    times : ${NAME}_$BLOCK;
    shaper : ${NAME}_shaper;
END_VAR
times($INPUTS);
shaper(command := command, times_s := times.times_s, amplitudes := times.amplitudes,
    sample_time_s := $SAMPLE);
velocity := shaper.shaped;
END_PROGRAM *)

""")

SAMPLE_TIME_S = 0.01
"""Of the example of a call."""


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
    name, of = name_of(head), head.real
    held = list(runs)
    rows = listing(head, held)
    found = lookup_of(head, join_rows(held))
    lookup = None if isinstance(found, str) else found
    # A title must not end or open a comment.
    harmless = {"*)": "* )", "(*": "( *"}
    if head.on_samples:
        yield f"(* {comment(head, rows, harmless)} *)\n\n".encode()
        sampled = sampled_listing(head, rows)
        yield sampled_table_in_text(name, rows, sampled, of).encode()
        yield sampled_shaper_in_text(name, sampled, of).encode()
        return
    more = [
        f"numbers: {of}; memory: {constants(rows, lookup) * BYTES[of]} bytes of constants and "
        f"{(LAST_CELL + 1) * BYTES[of]} bytes of the shaper's delay line"
    ]
    if rows.names:
        more.insert(0, f"columns of a row: {', '.join(rows.names)}")
    more += lookup_remarks(found, name, in_single=of == "REAL")
    yield f"(* {comment(head, rows, harmless, more)} *)\n\n".encode()
    yield _call(head, name, lookup).encode()
    yield _table(head, name, rows).encode()
    if lookup is not None:
        yield lookup_in_text(name, lookup, of).encode()
    if head.fit is not None:
        yield _evaluator(head, head.fit, name).encode()
    yield SHAPER.substitute(NAME=name, IMPULSES=head.impulses, REAL=of, LASTCELL=LAST_CELL).encode()


def _call(head: TableHead, name: str, lookup: Lookup | None) -> str:
    """Return the example of a call: by a lookup, else by polynomials, else of a row."""
    block, inputs = "table", {"row": "0"}
    if lookup is not None:
        block = "lookup"
        inputs = {axis.name: _short((axis.values[0] + axis.values[-1]) / 2) for axis in lookup.axes}
    elif head.fit is not None:
        block, inputs = "evaluator", _inputs_in_the_middle(head, head.fit)
    return CALL.substitute(
        NAME=name,
        REAL=head.real,
        BLOCK=block,
        INPUTS=", ".join(f"{field} := {value}" for field, value in inputs.items()),
        SAMPLE=real(SAMPLE_TIME_S),
    )


def _inputs_in_the_middle(head: TableHead, fit: Fit) -> dict[str, str]:
    """Return inputs of the evaluator in the middle of its range."""
    middle, gravity = (fit.variable.start + fit.variable.stop) / 2, gravity_of(head)
    if fit.frequency_unit_rad_s is None:
        frequency = subject_of(head).plant.modes[0].natural_frequency_rad_s
        return {"x": _short(middle), "natural_frequency_rad_s": _short(frequency)}
    frequency = middle * fit.frequency_unit_rad_s
    if gravity is None:
        return {"natural_frequency_rad_s": _short(frequency)}
    return {"cable_length_m": _short(gravity / frequency**2)}


def _short(value: float) -> str:
    return real(float(f"{value:.4g}"))


def _table(head: TableHead, name: str, rows: Listing) -> str:
    of, without = head.real, ~rows.designed
    shared = rows.shared_amplitudes
    amplitudes = np.where(without[:, None], np.eye(1, head.impulses), rows.amplitudes)
    if shared is not None:
        amplitudes = shared
    return TABLE.substitute(
        NAME=name,
        REAL=of,
        IMPULSES=head.impulses,
        LASTTIME=rows.times_s.size - 1,
        LASTAMPLITUDE=amplitudes.size - 1,
        LASTROW=head.rows - 1,
        **columns_in_text(rows, of),
        ALLTIMES=reals(rows.times_s, of),
        ALLAMPLITUDES=reals(amplitudes, of),
        ALLSTATUS=lines([str(code) for code in rows.status]),
        OFROW="row * impulses + k - 1" if shared is None else "k - 1",
        WITHOUT=WITHOUT_DESIGN if shared is not None and without.any() else "",
    )


def _evaluator(head: TableHead, fit: Fit, name: str) -> str:
    of, unit = head.real, fit.frequency_unit_rad_s
    first, last = range_of(fit)
    local, inputs, prepared = [], ["natural_frequency_rad_s"], []
    gravity = gravity_of(head)
    if unit is None:
        inputs = ["x", *inputs]
    else:
        local = ["x"]
        prepared = [f"x := natural_frequency_rad_s / {real(unit, of)};"]
        if gravity is not None:
            local, inputs = [*local, *inputs], ["cable_length_m"]
            root = f"SQRT({real(gravity, of)} / cable_length_m)"
            prepared = [f"natural_frequency_rad_s := {root};", *prepared]
    return EVALUATOR.substitute(
        NAME=name,
        REAL=of,
        IMPULSES=head.impulses,
        TERMS=fit.degree + 1,
        MEANING=fit.variable.meaning.replace("*", "times"),
        FIRST=real(first, of),
        LAST=real(last, of),
        FORMULA=fit.formula,
        VARIABLES="\n".join(f"    {one} : {of};" for one in inputs),
        LOCAL="".join(f"    {one} : {of};\n" for one in local),
        PREPARED="".join(f"{line}\n" for line in prepared),
        LASTCOEFFICIENT=fit.coefficients.size - 1,
        COEFFICIENTS=reals(fit.coefficients, of),
        AMPLITUDES=reals(fit.checks.amplitudes, of),
        DIVIDED=dividing(fit),
    )


EXPORT = Export(
    name="st",
    media_type="text/plain; charset=utf-8",
    suffix=".st",
    checks=check_program,
    write=write_st,
    move=lambda blocks: move_in_text(blocks).encode(),
    live=lambda block: live_in_text(block).encode(),
)
