"""Wire form of sensitivity curves: which part is wanted, and the curve."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.damping_curve import MAX_CURVE_POINTS
from design.analysis.sensitivity import RATIO_BOUNDS, Sensitivity, SensitivityRange
from schemas.base import Wire, leave_out_none
from schemas.damping import DampingIn, DampingOut
from schemas.insensitivity import InsensitivityOut

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


class SensitivityOut(Wire):
    """A sensitivity curve."""

    frequency_ratio: Annotated[list[float], Field(description="Frequency over the plant's [-].")]
    residual: Annotated[list[float], Field(description="Residual at each ratio [-].")]
    insensitivity: Annotated[InsensitivityOut | None, Field(description="Its band, or null.")]
    damping: Annotated[
        DampingOut | None,
        leave_out_none("Curve over the damping ratio, where a range is asked for."),
    ]

    @classmethod
    def from_design(cls, sensitivity: Sensitivity) -> Self:
        """Wrap the design record."""
        band, curve = sensitivity.insensitivity, sensitivity.damping
        return cls.model_construct(
            frequency_ratio=sensitivity.frequency_ratios.tolist(),
            residual=sensitivity.residuals.tolist(),
            insensitivity=None if band is None else InsensitivityOut.from_design(band),
            damping=None if curve is None else DampingOut.from_design(*curve),
        )
