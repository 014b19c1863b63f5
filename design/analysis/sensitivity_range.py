"""Which part of a sensitivity curve is wanted."""

from dataclasses import dataclass

from design.analysis.damping_curve import MAX_CURVE_POINTS, DampingRange
from design.checks import require_between
from design.errors import InvalidInputError

RATIO_BOUNDS = (1e-6, 1e6)
"""Frequency ratios of a curve [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SensitivityRange:
    """What part of the curve is wanted."""

    # First and last frequency ratio, ``0 < from < to`` [-]
    from_ratio: float = 0.5
    to_ratio: float = 1.5
    points: int = 201  # Number of points, 2 to 20,001
    # Residual at which the insensitivity is reported, 0 to 1, both excluded [-]
    tolerance: float = 0.05
    # Range of a curve over the damping ratio; None for no such curve
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
