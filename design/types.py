"""Array types and the checks that records share."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from design.errors import InvalidInputError

FloatArray = NDArray[np.floating[Any]]
ComplexArray = NDArray[np.complexfloating[Any, Any]]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]

Symbolic = Any
"""A number or an expression of CasADi, which ships no types."""


def require_positive(name: str, value: float) -> None:
    """Check that ``value`` is finite and > 0.

    Parameters
    ----------
    name
        Field that the error names.
    value
        The number, in any unit; nan is refused.

    Raises
    ------
    InvalidInputError
        If it is not.
    """
    if not (math.isfinite(value) and value > 0):
        raise InvalidInputError(name, value, "finite and > 0", code="not_positive")


MIN_VALUE, MAX_VALUE = 1e-12, 1e12
"""Bounds of any frequency, time or length in SI units: beyond them squares overflow."""


def require_scale(name: str, value: float) -> None:
    """Check that ``MIN_VALUE <= value <= MAX_VALUE``.

    Parameters
    ----------
    name
        Field that the error names.
    value
        A frequency, time or length in SI units.

    Raises
    ------
    InvalidInputError
        If it is not.
    """
    require_positive(name, value)
    require_between(name, value, MIN_VALUE, MAX_VALUE)


def require_between(name: str, value: float, lowest: float, highest: float) -> None:
    """Check that ``lowest <= value <= highest``.

    Parameters
    ----------
    name
        Field that the error names.
    value
        The number; nan is refused.
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
