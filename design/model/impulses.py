"""The impulses of a shaper, or of a whole command."""

from dataclasses import dataclass, field

import numpy as np

from design.checks import MAX_VALUE
from design.model.impulse_faults import require_numbers, require_shapes
from design.types import BoolArray, FloatArray

ROUNDING = 1e-12
"""Share of all steps' sizes below which one is none: rounding of their sum, not a command [-]."""

SAME_TIME = 1e-12
"""Share of the duration within which steps are at one time [-]."""

LAST_DIGITS = 4 * float(np.finfo(np.float64).eps)
"""Share of a time by which it is off when it is a sum of two [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Impulses:
    """Steps of a velocity command, in order of time.

    Steps at one time are one change of the command, whatever their order: a level between them is
    never commanded.
    """

    times_s: FloatArray  # Times of the steps, shape (n,), finite and not decreasing [s]
    amplitudes: FloatArray  # Heights of the steps as shares of full speed, shape (n,), finite [-]
    # Which steps increase the magnitude of the command, shape (n,): they drive the actuator by its
    # acceleration set. Within a margin of rounding a step decreases it, as one from 0.3 to -0.3.
    # Steps at one time are one, and one of no height leaves the set in force that was.
    accelerates: BoolArray = field(init=False)

    def __post_init__(self) -> None:
        shape = self.times_s.shape
        if len(shape) != 1 or shape == (0,) or self.amplitudes.shape != shape:
            require_shapes(self.times_s, self.amplitudes)
        heights = np.abs(self.amplitudes)
        times, total = self.times_s, float(heights.sum())
        gaps = times[1:] - times[:-1]
        shortest = float(gaps.min()) if gaps.size else np.inf
        ordered = shortest >= 0
        if not (
            ordered and times[0] >= -MAX_VALUE and times[-1] <= MAX_VALUE and 0 < total <= MAX_VALUE
        ):
            require_numbers(self.times_s, self.amplitudes)
        margin = ROUNDING * total
        if shortest > self._instant_s and heights.min() > margin:
            increases = _increases(self.amplitudes.cumsum(), margin)
        else:
            increases = self._increases_by_instants(margin)
        object.__setattr__(self, "accelerates", increases)

    @property
    def _instant_s(self) -> float:
        """How far apart steps are at most that are at one time [s]."""
        first, last = float(self.times_s[0]), float(self.times_s[-1])
        return SAME_TIME * (last - first) + LAST_DIGITS * max(abs(first), abs(last))

    def last_of_instants(self) -> BoolArray:
        """Return which steps are the last at their time, shape (n,)."""
        last = np.ones(self.times_s.size, dtype=np.bool_)
        last[:-1] = self.times_s[1:] - self.times_s[:-1] > self._instant_s
        return last

    def _increases_by_instants(self, margin: float) -> BoolArray:
        """Return `accelerates` where steps are at one time, or of no height."""
        last = self.last_of_instants()
        levels = self.amplitudes.cumsum()[last]
        increases = _increases(levels, margin)
        still = np.abs(np.diff(levels, prepend=0.0)) <= margin
        moved = np.maximum.accumulate(np.where(still, 0, np.arange(still.size)))
        return np.repeat(increases[moved], np.diff(np.flatnonzero(last), prepend=-1))

    @property
    def duration_s(self) -> float:
        """Time from the first step to the last [s]."""
        return float(self.times_s[-1] - self.times_s[0])


def _increases(levels: FloatArray, margin: float) -> BoolArray:
    """Return which levels are larger than the one before, shape (n,); the first is, than rest."""
    sizes = np.abs(levels)
    increases = np.ones(sizes.size, dtype=np.bool_)
    increases[1:] = sizes[1:] - sizes[:-1] > margin
    return increases
