"""Numbers as Structured Text has them, in lines of a few."""

import numpy as np

from design.export.program import Listing, decimal
from design.tables.rows import Real
from design.types import FloatArray

NUMBERS_PER_LINE = 8

BYTES: dict[Real, int] = {"LREAL": 8, "REAL": 4}
"""Of a number of each type."""


def real(value: float, of: Real = "LREAL") -> str:
    """Return a finite number as a literal.

    Parameters
    ----------
    value
        The number.
    of
        Its type in the program; one of single precision has the fewest digits that it is
        known by.

    Returns
    -------
    str
        With a decimal point.

    Raises
    ------
    InvalidInputError
        If the number is not finite in its type.
    """
    if of == "REAL":
        with np.errstate(over="ignore"):
            value = float(str(np.float32(value)))
    return decimal(value).replace("e", "E")


def reals(values: FloatArray, of: Real = "LREAL") -> str:
    """Return the lines of an array, 0 where a number is not known.

    Parameters
    ----------
    values
        The numbers.
    of
        Their type in the program.

    Returns
    -------
    str
        Lines without a last comma.
    """
    return lines([real(value, of) for value in np.nan_to_num(values, nan=0.0).ravel().tolist()])


def lines(texts: list[str]) -> str:
    """Return texts in lines of a few."""
    parts = [
        ", ".join(texts[start : start + NUMBERS_PER_LINE])
        for start in range(0, len(texts), NUMBERS_PER_LINE)
    ]
    return ",\n".join(f"        {part}" for part in parts)


COPIED = """\
    FOR k := 1 TO columns_of_row DO
        columns[k] := all_columns[row * columns_of_row + k - 1];
    END_FOR;
"""


def columns_in_text(rows: Listing, of: Real) -> dict[str, str]:
    """Return the parts of a block that give the columns of a row.

    Parameters
    ----------
    rows
        The rows.
    of
        Type of the numbers.

    Returns
    -------
    dict of str
        ``COLUMNS``: the output, ``ALLCOLUMNS``: the constants, ``COPIED``: the statements; empty
        where a row has none.
    """
    columns = len(rows.names)
    if not columns:
        return dict.fromkeys(("COLUMNS", "ALLCOLUMNS", "COPIED"), "")
    return {
        "COLUMNS": f"    columns : ARRAY[1..{columns}] OF {of};\n",
        "ALLCOLUMNS": f"    columns_of_row : DINT := {columns};\n"
        f"    all_columns : ARRAY[0..{rows.numbers.size - 1}] OF {of} := [\n"
        f"{reals(rows.numbers, of)}];\n",
        "COPIED": COPIED,
    }
