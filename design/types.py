"""Array types and the checks that records share."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from design.errors import InvalidInputError

FloatArray = NDArray[np.floating[Any]]
ComplexArray = NDArray[np.complexfloating[Any, Any]]
BoolArray = NDArray[np.bool_]


def require_positive(name: str, value: float) -> None:
    """Raise InvalidInputError unless ``value`` is finite and > 0."""
    if not (math.isfinite(value) and value > 0):
        raise InvalidInputError(name, value, "finite and > 0")


def require_between(name: str, value: float, lowest: float, highest: float) -> None:
    """Raise InvalidInputError unless ``lowest <= value <= highest``."""
    if not lowest <= value <= highest:
        raise InvalidInputError(name, value, f"between {lowest:g} and {highest:g}")
