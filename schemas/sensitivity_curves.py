"""Wire form of sensitivity curves, without what they are of."""

from typing import Annotated, Self

from design.analysis.sensitivity import Sensitivity
from schemas.base import Wire, leave_out_none
from schemas.damping import DampingOut
from schemas.insensitivity import InsensitivityOut


class SensitivityOut(Wire):
    """A sensitivity curve."""

    frequency_ratio: list[float]
    residual: list[float]
    insensitivity: InsensitivityOut | None
    damping: Annotated[
        DampingOut | None,
        leave_out_none("Curve over the damping ratio, where a range is asked for."),
    ]

    @classmethod
    def from_design(cls, sensitivity: Sensitivity) -> Self:
        """Wrap the design record."""
        band, over_damping = sensitivity.insensitivity, None
        if sensitivity.damping is not None:
            ratios, residuals = sensitivity.damping
            over_damping = DampingOut.model_construct(
                damping_ratio=ratios.tolist(),
                residual=residuals.tolist(),
                worst=float(residuals.max()),
            )
        return cls.model_construct(
            frequency_ratio=sensitivity.frequency_ratios.tolist(),
            residual=sensitivity.residuals.tolist(),
            insensitivity=None if band is None else InsensitivityOut.from_design(band),
            damping=over_damping,
        )
