"""Which part of a sensitivity curve is wanted, over the frequency and over the damping ratio."""

from dataclasses import dataclass

from design.errors import InvalidInputError
from design.model.plants.mode import MAX_DAMPING_RATIO
from design.types import require_between

MAX_CURVE_POINTS = 20_001
"""Longest curve, a bound on the work of one request."""

RATIO_BOUNDS = (1e-6, 1e6)
"""Frequency ratios of a curve [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingRange:
    """Which damping ratios the plant may have.

    Attributes
    ----------
    start, stop
        Least and largest, ``0 <= start < stop <= 0.99`` [-].
    points
        Number of points, 2 to 20,001.
    """

    start: float
    stop: float
    points: int = 101

    def __post_init__(self) -> None:
        require_between("damping.from", self.start, 0.0, MAX_DAMPING_RATIO)
        require_between("damping.to", self.stop, 0.0, MAX_DAMPING_RATIO)
        if self.stop <= self.start:
            raise InvalidInputError(
                "damping.to", self.stop, f"greater than from, {self.start!r}", code="range_reversed"
            )
        require_between("damping.points", self.points, 2, MAX_CURVE_POINTS)


@dataclass(frozen=True, slots=True, kw_only=True)
class SensitivityRange:
    """What part of the curve is wanted.

    Attributes
    ----------
    from_ratio, to_ratio
        First and last frequency ratio, ``0 < from < to`` [-].
    points
        Number of points, 2 to 20,001.
    tolerance
        Residual at which the insensitivity is reported, 0 to 1, both excluded [-].
    damping
        Range of a curve over the damping ratio; None for no such curve.
    """

    from_ratio: float = 0.5
    to_ratio: float = 1.5
    points: int = 201
    tolerance: float = 0.05
    damping: DampingRange | None = None

    def __post_init__(self) -> None:
        require_between("from_ratio", self.from_ratio, *RATIO_BOUNDS)
        require_between("to_ratio", self.to_ratio, *RATIO_BOUNDS)
        if self.to_ratio <= self.from_ratio:
            raise InvalidInputError(
                "to_ratio",
                self.to_ratio,
                f"greater than from_ratio, {self.from_ratio!r}",
                code="ratios_reversed",
            )
        require_between("points", self.points, 2, MAX_CURVE_POINTS)
        if not 0 < self.tolerance < 1:
            raise InvalidInputError(
                "tolerance", self.tolerance, "between 0 and 1, both excluded", code="out_of_range"
            )
