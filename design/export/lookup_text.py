"""The function block of Structured Text that interpolates between the rows of a table."""

from string import Template

from design.export.lookup import Lookup, LookupAxis
from design.export.structured_numbers import lines, real, reals
from design.tables.rows import Real

LOOKUP = Template("""\
(* Times and amplitudes at values between the rows: $POINTS rows are joined by Lagrange's weights in
   $COORDINATES,
   in which the phases of the impulses are smooth. valid is FALSE, and the times stay, outside of
   the rows$HOLES. *)
FUNCTION_BLOCK ${NAME}_lookup
VAR_INPUT
$INPUTS
END_VAR
VAR_OUTPUT
    valid : BOOL;
    times_s : ARRAY[1..$IMPULSES] OF $REAL;
    amplitudes : ARRAY[1..$IMPULSES] OF $REAL := [
$AMPLITUDES];
END_VAR
VAR CONSTANT
    impulses : DINT := $IMPULSES;
$CONSTANTS
END_VAR
VAR
    rows : ${NAME}_table;
$LOCALS
    nodes : ARRAY[0..3] OF $REAL;
    at_node : $REAL;
    share : $REAL;
    low : DINT;
    high : DINT;
    middle : DINT;
    i : DINT;
    j : DINT;
    k : DINT;
END_VAR
valid := $WITHIN;
IF valid THEN
$SHARES$USABLE
END_IF;
IF valid THEN
    FOR k := 1 TO impulses DO
        times_s[k] := 0.0;
    END_FOR;
$JOINS
END_IF;
END_FUNCTION_BLOCK

""")

SHARES = Template("""\
    low := 0;
    high := ${FIELD}_rows - 1;
    FOR k := 1 TO $HALVINGS DO
        middle := (low + high) / 2;
        IF high - low > 1 THEN
            IF $FIELD < axis_$AXIS[middle] THEN
                high := middle;
            ELSE
                low := middle;
            END_IF;
        END_IF;
    END_FOR;
    cell_$AXIS := low;
    first_$AXIS := low - $BEFORE;
    IF first_$AXIS > ${FIELD}_rows - $POINTS THEN
        first_$AXIS := ${FIELD}_rows - $POINTS;
    END_IF;
    IF first_$AXIS < 0 THEN
        first_$AXIS := 0;
    END_IF;
    at_node := $AT;
    FOR i := 0 TO $LASTPOINT DO
        nodes[i] := $NODE;
    END_FOR;
    FOR i := 0 TO $LASTPOINT DO
        share := $SCALE;
        FOR j := 0 TO $LASTPOINT DO
            IF j <> i THEN
                share := share * ((at_node - nodes[j]) / (nodes[i] - nodes[j]));
            END_IF;
        END_FOR;
        shares_$AXIS[i] := share;
    END_FOR;
""")

JOIN = """\
    FOR i := 0 TO {last} DO
        rows(row := first_1 + i);
        FOR k := 1 TO impulses DO
            times_s[k] := times_s[k] + shares_1[i] * rows.times_s[k];
        END_FOR;
    END_FOR;"""

JOIN_OF_TWO = """\
    FOR i := 0 TO {last} DO
        FOR j := 0 TO {other} DO
            rows(row := (first_1 + i) * {field}_rows + first_2 + j);
            share := shares_1[i] * shares_2[j];
            FOR k := 1 TO impulses DO
                times_s[k] := times_s[k] + share * rows.times_s[k];
            END_FOR;
        END_FOR;
    END_FOR;"""

COORDINATES = {
    "inverse_root": "1.0 / SQRT({})",
    "root": "SQRT({})",
    "inverse": "1.0 / {}",
    "itself": "{}",
}
"""Of a value."""


def lookup_in_text(name: str, lookup: Lookup, of: Real) -> str:
    """Return the block of a lookup.

    Parameters
    ----------
    name
        Start of the names.
    lookup
        What is interpolated.
    of
        Type of the numbers.

    Returns
    -------
    str
        A function block, which calls that of the table.
    """
    axes = lookup.axes
    holes = (
        "" if lookup.usable.all() else ", and between rows of other branches or without a design"
    )
    constants = [
        line for number, axis in enumerate(axes, 1) for line in _constants(number, axis, of)
    ]
    usable = ""
    if holes:
        cells = ["TRUE" if one else "FALSE" for one in lookup.usable.ravel().tolist()]
        constants.append(f"    usable : ARRAY[0..{len(cells) - 1}] OF BOOL := [\n{lines(cells)}];")
        cell = "cell_1" if len(axes) == 1 else f"cell_1 * ({axes[1].name}_rows - 1) + cell_2"
        usable = f"    valid := usable[{cell}];\n"
    last = axes[0].points - 1
    joins = JOIN.format(last=last)
    if len(axes) > 1:
        joins = JOIN_OF_TWO.format(last=last, other=axes[1].points - 1, field=axes[1].name)
    return LOOKUP.substitute(
        NAME=name,
        REAL=of,
        POINTS=" x ".join(str(axis.points) for axis in axes),
        COORDINATES=" and ".join(COORDINATES[axis.coordinate].format(axis.name) for axis in axes),
        HOLES=holes,
        INPUTS="\n".join(f"    {axis.name} : {of};" for axis in axes),
        IMPULSES=lookup.amplitudes.size,
        AMPLITUDES=reals(lookup.amplitudes, of),
        CONSTANTS="\n".join(constants),
        LOCALS="\n".join(
            line for number, axis in enumerate(axes, 1) for line in _locals(number, axis, of)
        ),
        WITHIN="\n    AND ".join(
            f"{axis.name} >= {axis.name}_first AND {axis.name} <= {axis.name}_last" for axis in axes
        ),
        SHARES="".join(_shares(number, axis) for number, axis in enumerate(axes, 1)).rstrip("\n"),
        USABLE=f"\n{usable}".rstrip("\n"),
        JOINS=joins,
    )


def _constants(number: int, axis: LookupAxis, of: Real) -> list[str]:
    return [
        f"    {axis.name}_first : {of} := {real(float(axis.values[0]), of)};",
        f"    {axis.name}_last : {of} := {real(float(axis.values[-1]), of)};",
        f"    {axis.name}_rows : DINT := {axis.values.size};",
        f"    axis_{number} : ARRAY[0..{axis.values.size - 1}] OF {of} := [\n"
        f"{reals(axis.values, of)}];",
    ]


def _locals(number: int, axis: LookupAxis, of: Real) -> list[str]:
    return [
        f"    cell_{number} : DINT;",
        f"    first_{number} : DINT;",
        f"    shares_{number} : ARRAY[0..{axis.points - 1}] OF {of};",
    ]


def _shares(number: int, axis: LookupAxis) -> str:
    coordinate = COORDINATES[axis.coordinate]
    return SHARES.substitute(
        AXIS=number,
        FIELD=axis.name,
        HALVINGS=max(axis.values.size - 1, 1).bit_length(),
        BEFORE=axis.before,
        POINTS=axis.points,
        LASTPOINT=axis.points - 1,
        AT=coordinate.format(axis.name),
        NODE=coordinate.format(f"axis_{number}[first_{number} + i]"),
        SCALE="nodes[i] / at_node" if axis.scales else "1.0",
    )
