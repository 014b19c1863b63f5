"""Numbers as Structured Text has them, in lines of a few."""

import numpy as np

from design.export.program import decimal
from design.types import FloatArray

NUMBERS_PER_LINE = 8


def real(value: float) -> str:
    """Return a finite number as an LREAL literal."""
    return decimal(value).replace("e", "E")


def reals(values: FloatArray) -> str:
    """Return the lines of an array, 0 where a number is not known."""
    return lines([real(value) for value in np.nan_to_num(values, nan=0.0).ravel().tolist()])


def lines(texts: list[str]) -> str:
    """Return texts in lines of a few."""
    parts = [
        ", ".join(texts[start : start + NUMBERS_PER_LINE])
        for start in range(0, len(texts), NUMBERS_PER_LINE)
    ]
    return ",\n".join(f"        {part}" for part in parts)
