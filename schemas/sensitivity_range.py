"""Wire form of which part of a sensitivity curve is wanted."""

from typing import Annotated

from pydantic import Field

from design.analysis.damping_curve import MAX_CURVE_POINTS
from design.analysis.sensitivity_range import RATIO_BOUNDS, SensitivityRange
from schemas.base import Wire
from schemas.damping import DampingIn

Ratio = Annotated[float, Field(ge=RATIO_BOUNDS[0], le=RATIO_BOUNDS[1])]


class SensitivityIn(Wire):
    """Range of the sensitivity curve that is wanted."""

    from_ratio: Annotated[Ratio, Field(description="First frequency ratio [-].")] = 0.5
    to_ratio: Annotated[Ratio, Field(description="Last frequency ratio [-].")] = 1.5
    points: Annotated[int, Field(ge=2, le=MAX_CURVE_POINTS, description="Points of the curve.")] = (
        201
    )
    tolerance: Annotated[
        float, Field(gt=0, lt=1, description="Residual of the insensitivity [-].")
    ] = 0.05

    damping: Annotated[
        DampingIn | None,
        Field(description="Range of a curve over the damping ratio; null for none."),
    ] = None

    def to_design(self) -> SensitivityRange:
        """Build the design record."""
        return SensitivityRange(
            from_ratio=self.from_ratio,
            to_ratio=self.to_ratio,
            points=self.points,
            tolerance=self.tolerance,
            damping=None if self.damping is None else self.damping.to_design(),
        )
