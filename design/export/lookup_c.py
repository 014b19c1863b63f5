"""The functions of C that interpolate between the rows of a table."""

from string import Template

from design.export.lookup import Lookup, LookupAxis
from design.export.program import decimal

AXIS = Template("""\
/* The rows along $FIELD, and the share of each at a value: Lagrange's weights in
   $COORDINATE, in which the phases of the impulses are smooth. Returns the first of these rows. */
static const shapersmith_real ${NAME}_axis_$AXIS[${UPPER}_ROWS] = {
$VALUES
};

static inline size_t ${NAME}_shares_$AXIS(shapersmith_real value, size_t *cell,
                                  shapersmith_real shares[$POINTS])
{
    const shapersmith_real at = $AT;
    shapersmith_real nodes[$POINTS];
    size_t low = 0, high = ${UPPER}_ROWS - 1, first, i, j;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (value < ${NAME}_axis_$AXIS[middle]) {
            high = middle;
        } else {
            low = middle;
        }
    }
    *cell = low;
$START    first = first + $POINTS > ${UPPER}_ROWS ? ${UPPER}_ROWS - $POINTS : first;
    for (i = 0; i < $POINTS; ++i) {
        nodes[i] = $NODE;
    }
    for (i = 0; i < $POINTS; ++i) {
        shares[i] = $SCALE;
        for (j = 0; j < $POINTS; ++j) {
            if (j != i) {
                shares[i] *= (at - nodes[j]) / (nodes[i] - nodes[j]);
            }
        }
    }
    return first;
}

""")

LOOKUP = Template("""\
/* Times of the impulses [s] at values between the rows; amplitudes are ${NAME}_amplitudes. Returns
   0, or -1 and writes nothing outside of the rows$HOLES. Compile with -lm for sqrt.

     shapersmith_real times_s[${UPPER}_IMPULSES];
     if (${NAME}_lookup($EXAMPLE, times_s) == 0) {
         ${NAME}_set(&shaper, times_s, ${NAME}_amplitudes, sample_time_s);
     } */
static inline int ${NAME}_lookup($INPUTS,
                              shapersmith_real *times_s)
{
    shapersmith_real $SHARES;
    size_t $CELLS, $FIRSTS, i, ${J}k;
    if (!($WITHIN)) {
        return -1;
    }
$FOUND
$USABLE    for (k = 0; k < ${UPPER}_IMPULSES; ++k) {
        times_s[k] = SHAPERSMITH_C(0.0);
    }
$JOINS
    return 0;
}

""")

JOIN = """\
    for (i = 0; i < {points}; ++i) {{
        for (k = 0; k < {upper}_IMPULSES; ++k) {{
            times_s[k] += shares_1[i] * {name}_times[first_1 + i][k];
        }}
    }}"""

JOIN_OF_TWO = """\
    for (i = 0; i < {points}; ++i) {{
        for (j = 0; j < {other}; ++j) {{
            const size_t row = (first_1 + i) * {rows} + first_2 + j;
            const shapersmith_real share = shares_1[i] * shares_2[j];
            for (k = 0; k < {upper}_IMPULSES; ++k) {{
                times_s[k] += share * {name}_times[row][k];
            }}
        }}
    }}"""

COORDINATES = {
    "inverse_root": "SHAPERSMITH_C(1.0) / SHAPERSMITH_SQRT({})",
    "root": "SHAPERSMITH_SQRT({})",
    "inverse": "SHAPERSMITH_C(1.0) / {}",
    "itself": "{}",
}
"""Of a value."""

IN_WORDS = {"inverse_root": "1 / sqrt({})", "root": "sqrt({})", "inverse": "1 / {}", "itself": "{}"}


def lookup_in_c(name: str, lookup: Lookup) -> str:
    """Return the functions of a lookup.

    Parameters
    ----------
    name
        Start of the names.
    lookup
        What is interpolated.

    Returns
    -------
    str
        Constants and functions; they follow the table.
    """
    upper, axes = name.upper(), lookup.axes
    numbers = range(1, len(axes) + 1)
    holes, usable = "", ""
    text = "".join(_axis(name, number, axis) for number, axis in zip(numbers, axes, strict=True))
    if not lookup.usable.all():
        holes = ", or between rows of other branches or without a design"
        cells = ", ".join(str(int(one)) for one in lookup.usable.ravel().tolist())
        text += f"static const unsigned char {name}_usable[{lookup.usable.size}] = {{{cells}}};\n\n"
        rows = "" if len(axes) == 1 else f" * ({_macro(upper, axes[1])}_ROWS - 1) + cell_2"
        usable = f"    if (!{name}_usable[cell_1{rows}]) {{\n        return -1;\n    }}\n"
    joins = JOIN.format(points=axes[0].points, upper=upper, name=name)
    if len(axes) > 1:
        joins = JOIN_OF_TWO.format(
            points=axes[0].points,
            other=axes[1].points,
            upper=upper,
            name=name,
            rows=f"{_macro(upper, axes[1])}_ROWS",
        )
    return text + LOOKUP.substitute(
        NAME=name,
        UPPER=upper,
        HOLES=holes,
        EXAMPLE=", ".join(
            f"SHAPERSMITH_C({decimal(float(f'{(axis.values[0] + axis.values[-1]) / 2:.4g}'))})"
            for axis in axes
        ),
        INPUTS=", ".join(f"shapersmith_real {axis.name}" for axis in axes),
        SHARES=", ".join(
            f"shares_{number}[{axis.points}]" for number, axis in zip(numbers, axes, strict=True)
        ),
        CELLS=", ".join(f"cell_{number}" for number in numbers),
        FIRSTS=", ".join(f"first_{number}" for number in numbers),
        J="j, " if len(axes) > 1 else "",
        WITHIN="\n          && ".join(
            f"{axis.name} >= {macro}_FIRST && {axis.name} <= {macro}_LAST"
            for axis, macro in zip(axes, (_macro(upper, axis) for axis in axes), strict=True)
        ),
        FOUND="\n".join(
            f"    first_{number} = {name}_shares_{number}({axis.name}, &cell_{number}, "
            f"shares_{number});"
            for number, axis in zip(numbers, axes, strict=True)
        ),
        USABLE=usable,
        JOINS=joins,
    )


def axes_in_c(name: str, lookup: Lookup) -> str:
    """Return the constants of the axes: first and last value, number of rows.

    Parameters
    ----------
    name
        Start of the names.
    lookup
        What is interpolated.

    Returns
    -------
    str
        A definition a line.
    """
    texts = []
    for axis in lookup.axes:
        start = f"#define {_macro(name.upper(), axis)}"
        texts += [
            f"{start}_FIRST SHAPERSMITH_C({decimal(float(axis.values[0]))})",
            f"{start}_LAST SHAPERSMITH_C({decimal(float(axis.values[-1]))})",
            f"{start}_ROWS {axis.values.size}",
        ]
    return "\n".join(texts) + "\n"


def _macro(upper: str, axis: LookupAxis) -> str:
    return f"{upper}_{axis.name.upper()}"


def _axis(name: str, number: int, axis: LookupAxis) -> str:
    coordinate = COORDINATES[axis.coordinate]
    numbers = [f"SHAPERSMITH_C({decimal(value)})" for value in axis.values.tolist()]
    parts = [numbers[start : start + 4] for start in range(0, len(numbers), 4)]
    return AXIS.substitute(
        NAME=name,
        UPPER=_macro(name.upper(), axis),
        FIELD=axis.name,
        COORDINATE=IN_WORDS[axis.coordinate].format(axis.name),
        AXIS=number,
        VALUES=",\n".join("    " + ", ".join(part) for part in parts),
        POINTS=axis.points,
        START=(
            f"    first = low > {axis.before} ? low - {axis.before} : 0;\n"
            if axis.before
            else "    first = low;\n"
        ),
        AT=coordinate.format("value"),
        NODE=coordinate.format(f"{name}_axis_{number}[first + i]"),
        SCALE="nodes[i] / at" if axis.scales else "SHAPERSMITH_C(1.0)",
    )
