"""A root followed from a problem that is solved to the one that is asked."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from design.types import FloatArray

FIRST_STEP = 0.25
"""Step of the share that is tried first [-]."""

MAX_MOVE_RAD = 0.5
"""Farthest that an unknown may go in one step: beyond it, it is another branch [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Path:
    """How far a root could be followed.

    Attributes
    ----------
    unknowns
        The last root, shape (n,) [rad].
    share
        Share of what is asked that it solves, 0 to 1 [-].
    """

    unknowns: FloatArray
    share: float

    @property
    def complete(self) -> bool:
        """Whether it solves what is asked."""
        return self.share == 1.0


def follow(
    start: FloatArray,
    solve: Callable[[FloatArray, float], FloatArray | None],
    shortest_step: float,
) -> Path:
    """Follow a root while a share goes from 0 to 1.

    Parameters
    ----------
    start
        The root at share 0, shape (n,) [rad].
    solve
        From a guess and a share to the root near it, within its bounds; None where there is none.
    shortest_step
        Step of the share below which the path has ended [-].

    Returns
    -------
    Path
        The last root and its share, 1 where the path is complete.
    """
    now, share = start, 0.0
    slope = np.zeros_like(start)
    step = FIRST_STEP
    while share < 1 and step >= shortest_step:
        target = min(1.0, share + step)
        root = solve(now + slope * (target - share), target)
        if root is None or np.abs(root - now).max() > MAX_MOVE_RAD:
            step /= 2
            continue
        slope = (root - now) / (target - share)
        now, share = root, target
        step = min(2 * step, FIRST_STEP)
    return Path(unknowns=now, share=share)
