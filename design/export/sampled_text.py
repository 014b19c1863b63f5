"""The function blocks of Structured Text that a table on samples has in place of others."""

from string import Template

from design.export.program import Listing
from design.export.sampled_program import SAME_SAMPLE_TIME, SampledListing
from design.export.structured_numbers import columns_in_text, lines, real, reals
from design.tables.rows import Real

TABLE = Template("""\
(* Samples and amplitudes of one row: each impulse has the number of its sample, from the first on;
   a row of fewer impulses repeats its last with amplitude 0. status 0: verified; 3: verified for an
   ideal actuator only; 1, 2: no design, the samples are zeros and the amplitudes 1, 0, ..., and the
   sample time is 0, with which the shaper lets the command pass; -1: no such row, the outputs
   stay. *)
FUNCTION_BLOCK ${NAME}_table
VAR_INPUT
    row : DINT;
END_VAR
VAR_OUTPUT
    status : SINT;
    samples : ARRAY[1..$IMPULSES] OF DINT;
    amplitudes : ARRAY[1..$IMPULSES] OF $REAL;
    sample_time_s : $REAL;
${COLUMNS}END_VAR
VAR CONSTANT
${ALLCOLUMNS}    all_samples : ARRAY[0..$LASTSAMPLE] OF DINT := [
$ALLSAMPLES];
    all_amplitudes : ARRAY[0..$LASTSAMPLE] OF $REAL := [
$ALLAMPLITUDES];
    all_sample_times_s : ARRAY[0..$LASTROW] OF $REAL := [
$ALLSAMPLETIMES];
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
    sample_time_s := all_sample_times_s[row];
    FOR k := 1 TO $IMPULSES DO
        samples[k] := all_samples[row * $IMPULSES + k - 1];
        amplitudes[k] := all_amplitudes[row * $IMPULSES + k - 1];
    END_FOR;
${COPIED}END_IF;
END_FUNCTION_BLOCK

""")

SHAPER = Template("""\
(* A shaper for a live command, on the samples of a controller: call it once every task_time_s, the
   cycle of its task. Each impulse delays the command by a whole number of samples and adds it by
   its amplitude. Samples, amplitudes and sample_time_s are those of a row and may change at any
   call, the delay line stays. The first call fills the line with its command, and so does reset.
   ready is FALSE, and the command passes as it is, while task_time_s is not the sample time of the
   row, or a sample is outside of the line. *)
FUNCTION_BLOCK ${NAME}_shaper
VAR_INPUT
    command : $REAL;
    samples : ARRAY[1..$IMPULSES] OF DINT;
    amplitudes : ARRAY[1..$IMPULSES] OF $REAL;
    sample_time_s : $REAL;
    task_time_s : $REAL;
    reset : BOOL;
END_VAR
VAR_OUTPUT
    shaped : $REAL;
    ready : BOOL;
END_VAR
VAR CONSTANT
    last_cell : DINT := $LASTCELL;
END_VAR
VAR
    line : ARRAY[0..last_cell] OF $REAL;
    newest : DINT;
    filled : BOOL;
    k : DINT;
    at_cell : DINT;
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
ready := sample_time_s > 0.0 AND task_time_s <= sample_time_s * (1.0 + $SAME)
    AND task_time_s >= sample_time_s * (1.0 - $SAME);
FOR k := 1 TO $IMPULSES DO
    IF samples[k] < 0 OR samples[k] > last_cell THEN
        ready := FALSE;
    END_IF;
END_FOR;
IF ready THEN
    shaped := 0.0;
    FOR k := 1 TO $IMPULSES DO
        at_cell := newest - samples[k];
        IF at_cell < 0 THEN
            at_cell := at_cell + last_cell + 1;
        END_IF;
        shaped := shaped + amplitudes[k] * line[at_cell];
    END_FOR;
ELSE
    shaped := command;
END_IF;
END_FUNCTION_BLOCK
""")


def sampled_table_in_text(name: str, rows: Listing, sampled: SampledListing, of: Real) -> str:
    """Return the block of the table.

    Parameters
    ----------
    name
        Start of the names.
    rows, sampled
        The rows, and their whole numbers.
    of
        Type of the numbers.

    Returns
    -------
    str
        A function block.
    """
    impulses = sampled.samples.shape[1]
    return TABLE.substitute(
        NAME=name,
        IMPULSES=impulses,
        REAL=of,
        LASTSAMPLE=sampled.samples.size - 1,
        LASTROW=len(rows.status) - 1,
        **columns_in_text(rows, of),
        ALLSAMPLES=lines(list(map(str, sampled.samples.ravel().tolist()))),
        ALLAMPLITUDES=reals(sampled.amplitudes, of),
        ALLSAMPLETIMES=reals(sampled.sample_times_s, of),
        ALLSTATUS=lines(list(map(str, rows.status))),
    )


def sampled_shaper_in_text(name: str, sampled: SampledListing, of: Real) -> str:
    """Return the block of the shaper.

    Parameters
    ----------
    name
        Start of the names.
    sampled
        The rows.
    of
        Type of the numbers.

    Returns
    -------
    str
        A function block.
    """
    return SHAPER.substitute(
        NAME=name,
        REAL=of,
        IMPULSES=sampled.samples.shape[1],
        LASTCELL=sampled.cells - 1,
        SAME=real(SAME_SAMPLE_TIME, of),
    )
