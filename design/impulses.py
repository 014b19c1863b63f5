"""The impulses of a shaper, or of a whole command."""

from dataclasses import dataclass, field

import numpy as np

from design.errors import InvalidInputError
from design.types import LARGEST, BoolArray, FloatArray

ROUNDING = 1e-12
"""Share of all steps' sizes below which one is none: rounding of their sum, not a command [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Impulses:
    """Steps of a velocity command, in order of time.

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
        chance: it decreases.
    """

    times_s: FloatArray
    amplitudes: FloatArray
    accelerates: BoolArray = field(init=False)

    def __post_init__(self) -> None:
        if self.times_s.ndim != 1 or self.times_s.size == 0:
            raise InvalidInputError(
                "times_s", list(self.times_s.shape), "a list of one or more times"
            )
        if self.amplitudes.shape != self.times_s.shape:
            raise InvalidInputError(
                "amplitudes",
                f"{self.amplitudes.size} numbers",
                f"as many as times_s, which has {self.times_s.size}",
            )
        times, total = self.times_s, float(np.abs(self.amplitudes).sum())
        ordered = bool((times[1:] >= times[:-1]).all())
        if not (ordered and times[0] >= -LARGEST and times[-1] <= LARGEST and 0 < total <= LARGEST):
            self._require_numbers()
        levels = np.abs(self.amplitudes.cumsum())
        margin = ROUNDING * total
        increases = levels > margin
        increases[1:] = levels[1:] - levels[:-1] > margin
        object.__setattr__(self, "accelerates", increases)

    def _require_numbers(self) -> None:
        """Raise InvalidInputError for the first fault, if there is one."""
        for name, values in (("times_s", self.times_s), ("amplitudes", self.amplitudes)):
            if not np.abs(values).max() <= LARGEST:  # not a number is not
                index = int(np.flatnonzero(~(np.abs(values) <= LARGEST))[0])
                raise InvalidInputError(
                    f"{name}.{index}", float(values[index]), f"between {-LARGEST:g} and {LARGEST:g}"
                )
        backward = self.times_s[1:] < self.times_s[:-1]
        if backward.any():
            index = int(backward.argmax()) + 1
            raise InvalidInputError(
                f"times_s.{index}",
                float(self.times_s[index]),
                f"not before the time ahead of it, {float(self.times_s[index - 1])!r}",
            )
        if not self.amplitudes.any():
            raise InvalidInputError("amplitudes", self.amplitudes.tolist(), "not all zero")

    @property
    def duration_s(self) -> float:
        """Time from the first step to the last [s]."""
        return float(self.times_s[-1] - self.times_s[0])
