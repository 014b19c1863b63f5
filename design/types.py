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


def require_positive(name: str, value: float) -> None:
    """Raise InvalidInputError unless ``value`` is finite and > 0."""
    if not (math.isfinite(value) and value > 0):
        raise InvalidInputError(name, value, "finite and > 0")


SMALLEST, LARGEST = 1e-12, 1e12
"""Bounds of any frequency, time or length in SI units: beyond them squares overflow."""


def require_scale(name: str, value: float) -> None:
    """Raise InvalidInputError unless ``value`` is > 0 and of a size that can be computed with."""
    require_positive(name, value)
    require_between(name, value, SMALLEST, LARGEST)


def require_between(name: str, value: float, lowest: float, highest: float) -> None:
    """Raise InvalidInputError unless ``lowest <= value <= highest``."""
    if not lowest <= value <= highest:
        raise InvalidInputError(name, value, f"between {lowest:g} and {highest:g}")
