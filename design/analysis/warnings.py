"""What to know of an answer that is right all the same."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from design.model.impulses import Impulses

SUM_ROUNDING = 1e-9
"""What a sum of amplitudes may be off by, over the sum of their sizes: printed digits [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignWarning:
    """Something a user should know of an answer that is right all the same.

    Attributes
    ----------
    code
        A name that programs can rely on.
    detail
        The same in words, with the figure.
    """

    code: str
    detail: str


def sum_warnings(impulses: Impulses) -> Iterator[DesignWarning]:
    """Yield a warning for amplitudes whose sum is neither 1 nor 0.

    A shaper has the sum 1 or -1, a whole move 0, to nine digits.
    """
    total = float(impulses.amplitudes.sum())
    rounding = SUM_ROUNDING * max(1.0, float(np.abs(impulses.amplitudes).sum()))
    if min(abs(abs(total) - 1), abs(total)) > rounding:
        yield DesignWarning(
            code="sum_not_one",
            detail=f"the amplitudes add up to {total:.9g}: those of a shaper add up to 1, those "
            "of a whole move to 0. The residual is a share of the vibration of an "
            "unshaped step of height 1",
        )


def actuator_ignored(name: str, found: str) -> DesignWarning:
    """Return the warning for claims that hold for an ideal actuator only.

    Parameters
    ----------
    name, found
        What the command is called, and what its claims are with the actuator given, in words.

    Returns
    -------
    DesignWarning
        With both.
    """
    return DesignWarning(
        code="actuator_ignored",
        detail=f"{name} is made, and its claims are proven, for an actuator that follows "
        f"its command; with the one given {found}",
    )
