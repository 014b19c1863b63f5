"""Checks that records share, and the bounds of any number in SI units."""

import math

from design.errors import InvalidInputError

MIN_VALUE, MAX_VALUE = 1e-12, 1e12
"""Bounds of any frequency, time or length in SI units: beyond them squares overflow."""


def require_scale(name: str, value: float) -> None:
    """Check that ``MIN_VALUE <= value <= MAX_VALUE``.

    Parameters
    ----------
    name, value
        Field that the error names, and the number; nan is refused.

    Raises
    ------
    InvalidInputError
        If it is not.
    """
    if not (math.isfinite(value) and value > 0):
        raise InvalidInputError(name, value, "finite and > 0", code="not_positive")
    require_between(name, value, MIN_VALUE, MAX_VALUE)


def require_between(name: str, value: float, lowest: float, highest: float) -> None:
    """Check that ``lowest <= value <= highest``.

    Parameters
    ----------
    name, value
        Field that the error names, and the number; nan is refused.
    lowest, highest
        Bounds in the unit of ``value``, both allowed.

    Raises
    ------
    InvalidInputError
        If it is not.
    """
    if not lowest <= value <= highest:
        raise InvalidInputError(
            name, value, f"between {lowest:g} and {highest:g}", code="out_of_range"
        )
