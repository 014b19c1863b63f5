"""Wire form of a damping ratio, and of a curve over it."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.damping_curve import MAX_CURVE_POINTS, DampingRange
from design.model.plants.mode import MAX_DAMPING_RATIO
from design.types import FloatArray
from schemas.base import Wire

PlantDamping = Annotated[
    float, Field(ge=0, le=MAX_DAMPING_RATIO, description="Share of critical damping [-].")
]


class DampingRangeIn(Wire):
    """Which damping ratios the plant may have."""

    from_: Annotated[PlantDamping, Field(alias="from", description="Least damping ratio [-].")]
    to: Annotated[PlantDamping, Field(description="Largest damping ratio [-].")]


class DampingIn(Wire):
    """Which damping ratios the plant may have."""

    from_: Annotated[PlantDamping, Field(alias="from", description="Least damping ratio [-].")]
    to: Annotated[PlantDamping, Field(description="Largest damping ratio [-].")]
    points: Annotated[int, Field(ge=2, le=MAX_CURVE_POINTS, description="Points of the curve.")] = (
        101
    )

    def to_design(self) -> DampingRange:
        """Build the design record."""
        return DampingRange(start=self.from_, stop=self.to, points=self.points)


class DampingOut(Wire):
    """What is left over the plant's damping ratio, its natural frequency as given."""

    damping_ratio: Annotated[list[float], Field(description="Damping ratios of the plant [-].")]
    residual: Annotated[list[float], Field(description="Residual at each of them [-].")]
    worst: Annotated[float, Field(description="Largest residual of the curve's points [-].")]

    @classmethod
    def from_design(cls, ratios: FloatArray, residuals: FloatArray) -> Self:
        """Wrap a curve.

        Parameters
        ----------
        ratios, residuals
            Damping ratios, and the residual at each, shape (n,) [-].

        Returns
        -------
        Self
            With its largest residual.
        """
        return cls.model_construct(
            damping_ratio=ratios.tolist(),
            residual=residuals.tolist(),
            worst=float(residuals.max()),
        )
