"""Wire form of sensitivity curves, without what they are of."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.insensitivity import Insensitivity
from design.analysis.sensitivity import Sensitivity
from schemas.base import Wire, leave_out_none


class InsensitivityOut(Wire):
    """The interval around 1 on which the residual is within the tolerance."""

    tolerance: float
    lower_ratio: Annotated[
        float | None, Field(description="Lower edge; null where the search found none [-].")
    ]
    upper_ratio: Annotated[
        float | None, Field(description="Upper edge; null where the search found none [-].")
    ]
    width: Annotated[
        float | None, Field(description="Upper edge less lower edge; null where either is [-].")
    ]
    searched_from_ratio: Annotated[
        float,
        Field(
            description="Lower end of what is known to be within the tolerance: the edge, or "
            "where the search for it ended [-]."
        ),
    ]
    searched_to_ratio: Annotated[float, Field(description="Upper end of the same [-].")]

    @classmethod
    def from_design(cls, insensitivity: Insensitivity) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            tolerance=insensitivity.tolerance,
            lower_ratio=insensitivity.lower_ratio,
            upper_ratio=insensitivity.upper_ratio,
            width=insensitivity.width,
            searched_from_ratio=insensitivity.searched_from_ratio,
            searched_to_ratio=insensitivity.searched_to_ratio,
        )


class DampingOut(Wire):
    """Residual over the damping ratio of the plant, at its natural frequency."""

    damping_ratio: list[float]
    residual: list[float]
    worst: Annotated[float, Field(description="Largest residual of the curve's points [-].")]


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
