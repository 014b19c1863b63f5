"""The impulses of a shaper, or of a whole command."""

from dataclasses import dataclass, field

import numpy as np

from design.errors import InvalidInputError
from design.types import MAX_VALUE, BoolArray, FloatArray

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

    Attributes
    ----------
    times_s
        Times of the steps, shape (n,), finite and not decreasing [s].
    amplitudes
        Heights of the steps as shares of full speed, shape (n,), finite [-].
    accelerates
        Which steps increase the magnitude of the command, shape (n,), derived. They drive the
        actuator by its acceleration set, the others by its deceleration set. The sums are compared
        with a margin of rounding, so that a step from 0.3 to -0.3 does not fall on either side by
        chance: it decreases. Those at one time do so together, and one of no height does not
        change the set in force.
    """

    times_s: FloatArray
    amplitudes: FloatArray
    accelerates: BoolArray = field(init=False)

    def __post_init__(self) -> None:
        if self.times_s.ndim != 1 or self.times_s.size == 0:
            raise InvalidInputError(
                "times_s", list(self.times_s.shape), "a list of one or more times", code="no_times"
            )
        if self.amplitudes.shape != self.times_s.shape:
            raise InvalidInputError(
                "amplitudes",
                f"{self.amplitudes.size} numbers",
                f"as many as times_s, which has {self.times_s.size}",
                code="amplitudes_unlike_times",
            )
        heights = np.abs(self.amplitudes)
        times, total = self.times_s, float(heights.sum())
        gaps = times[1:] - times[:-1]
        shortest = float(gaps.min()) if gaps.size else np.inf
        ordered = shortest >= 0
        if not (
            ordered and times[0] >= -MAX_VALUE and times[-1] <= MAX_VALUE and 0 < total <= MAX_VALUE
        ):
            self._require_numbers()
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

    def _last_of_instants(self) -> BoolArray:
        """Return which steps are the last at their time, shape (n,)."""
        last = np.ones(self.times_s.size, dtype=np.bool_)
        last[:-1] = self.times_s[1:] - self.times_s[:-1] > self._instant_s
        return last

    def _increases_by_instants(self, margin: float) -> BoolArray:
        """Return `accelerates` where steps are at one time, or of no height."""
        last = self._last_of_instants()
        levels = self.amplitudes.cumsum()[last]
        increases = _increases(levels, margin)
        still = np.abs(np.diff(levels, prepend=0.0)) <= margin
        moved = np.maximum.accumulate(np.where(still, 0, np.arange(still.size)))
        return np.repeat(increases[moved], np.diff(np.flatnonzero(last), prepend=-1))

    def merge(self) -> "Impulses":
        """Return the same command with one step for each of its changes.

        Steps at one time are added up; those of no height, which change nothing, are left out.

        Returns
        -------
        Impulses
            Of k <= n steps; this very record if none are to be added up or left out.

        Raises
        ------
        InvalidInputError
            If all cancel.

        Examples
        --------
        >>> given = Impulses(
        ...     times_s=np.array([0.0, 2.0, 2.0]), amplitudes=np.array([0.5, 0.5, -0.5])
        ... )
        >>> given.merge().times_s.tolist()
        [0.0]
        """
        first = np.roll(self._last_of_instants(), 1)  # after the last of one comes the next's first
        summed = np.add.reduceat(self.amplitudes, np.flatnonzero(first))
        moves = np.abs(summed) > ROUNDING * float(np.abs(self.amplitudes).sum())
        if moves.all() and first.all():
            return self
        if not moves.any():
            raise InvalidInputError(
                "amplitudes",
                self.amplitudes.tolist(),
                "not all zero, added up at each time",
                code="amplitudes_cancel",
            )
        # What is left out is added to the step before it: levels stay as they are.
        kept = np.flatnonzero(first)[moves]
        return Impulses(
            times_s=self.times_s[kept], amplitudes=np.add.reduceat(self.amplitudes, kept)
        )

    def _require_numbers(self) -> None:
        """Raise InvalidInputError for the first fault, if there is one."""
        for name, values in (("times_s", self.times_s), ("amplitudes", self.amplitudes)):
            if not np.abs(values).max() <= MAX_VALUE:  # not a number is not
                index = int(np.flatnonzero(~(np.abs(values) <= MAX_VALUE))[0])
                raise InvalidInputError(
                    f"{name}.{index}",
                    float(values[index]),
                    f"between {-MAX_VALUE:g} and {MAX_VALUE:g}",
                    code="out_of_range",
                )
        backward = self.times_s[1:] < self.times_s[:-1]
        if backward.any():
            index = int(backward.argmax()) + 1
            raise InvalidInputError(
                f"times_s.{index}",
                float(self.times_s[index]),
                f"not before the time ahead of it, {float(self.times_s[index - 1])!r}",
                code="time_before_last",
            )
        if not self.amplitudes.any():
            raise InvalidInputError(
                "amplitudes", self.amplitudes.tolist(), "not all zero", code="amplitudes_all_zero"
            )

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
