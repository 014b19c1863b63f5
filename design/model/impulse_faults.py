"""What is wrong with times and amplitudes that are no impulses."""

import numpy as np

from design.checks import MAX_VALUE
from design.errors import InvalidInputError
from design.types import FloatArray


def require_shapes(times_s: FloatArray, amplitudes: FloatArray) -> None:
    """Check that there is an amplitude for each of one or more times.

    Parameters
    ----------
    times_s, amplitudes
        Of the impulses, of any shape.

    Raises
    ------
    InvalidInputError
        If there is not.
    """
    if times_s.ndim != 1 or times_s.size == 0:
        raise InvalidInputError(
            "times_s", list(times_s.shape), "a list of one or more times", code="no_times"
        )
    if amplitudes.shape != times_s.shape:
        raise InvalidInputError(
            "amplitudes",
            f"{amplitudes.size} numbers",
            f"as many as times_s, which has {times_s.size}",
            code="amplitudes_unlike_times",
        )


def require_numbers(times_s: FloatArray, amplitudes: FloatArray) -> None:
    """Check that impulses are in order, in the range of numbers, not zero.

    Parameters
    ----------
    times_s, amplitudes
        Shape (n,) each [s], [-].

    Raises
    ------
    InvalidInputError
        For the first fault, if there is one.
    """
    for name, values in (("times_s", times_s), ("amplitudes", amplitudes)):
        if not np.abs(values).max() <= MAX_VALUE:  # not a number is not
            index = int(np.flatnonzero(~(np.abs(values) <= MAX_VALUE))[0])
            raise InvalidInputError(
                f"{name}.{index}",
                float(values[index]),
                f"between {-MAX_VALUE:g} and {MAX_VALUE:g}",
                code="out_of_range",
            )
    backward = times_s[1:] < times_s[:-1]
    if backward.any():
        index = int(backward.argmax()) + 1
        raise InvalidInputError(
            f"times_s.{index}",
            float(times_s[index]),
            f"not before the time ahead of it, {float(times_s[index - 1])!r}",
            code="time_before_last",
        )
    if not amplitudes.any():
        raise InvalidInputError(
            "amplitudes", amplitudes.tolist(), "not all zero", code="amplitudes_all_zero"
        )
