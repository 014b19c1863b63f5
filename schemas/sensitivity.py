"""Wire form of sensitivity curves."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.sensitivity import (
    MOST_POINTS,
    RATIO_BOUNDS,
    Insensitivity,
    Sensitivity,
    SensitivityRange,
)
from schemas.actuators import ActuatorIn
from schemas.base import Wire
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn

Ratio = Annotated[float, Field(ge=RATIO_BOUNDS[0], le=RATIO_BOUNDS[1])]


class SensitivityIn(Wire):
    """What part of the curve is wanted."""

    from_ratio: Annotated[Ratio, Field(description="First frequency ratio [-].")] = 0.5
    to_ratio: Annotated[Ratio, Field(description="Last frequency ratio [-].")] = 1.5
    points: Annotated[int, Field(ge=2, le=MOST_POINTS, description="Points of the curve.")] = 201
    tolerance: Annotated[
        float, Field(gt=0, lt=1, description="Residual of the insensitivity [-].")
    ] = 0.05

    def to_design(self) -> SensitivityRange:
        """Build the design record."""
        return SensitivityRange(
            from_ratio=self.from_ratio,
            to_ratio=self.to_ratio,
            points=self.points,
            tolerance=self.tolerance,
        )


class SensitivityRequest(SensitivityIn):
    """Body of `POST /v1/sensitivity`."""

    impulses: ImpulsesWire
    plant: PlantIn
    actuator: ActuatorIn


class InsensitivityOut(Wire):
    """The interval around 1 on which the residual is within the tolerance."""

    tolerance: float
    lower_ratio: float
    upper_ratio: float
    width: float

    @classmethod
    def from_design(cls, insensitivity: Insensitivity) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            tolerance=insensitivity.tolerance,
            lower_ratio=insensitivity.lower_ratio,
            upper_ratio=insensitivity.upper_ratio,
            width=insensitivity.width,
        )


class SensitivityOut(Wire):
    """A sensitivity curve."""

    frequency_ratio: list[float]
    residual: list[float]
    insensitivity: InsensitivityOut | None

    @classmethod
    def from_design(cls, sensitivity: Sensitivity) -> Self:
        """Wrap the design record."""
        band = sensitivity.insensitivity
        return cls.model_construct(
            frequency_ratio=sensitivity.frequency_ratios.tolist(),
            residual=sensitivity.residuals.tolist(),
            insensitivity=None if band is None else InsensitivityOut.from_design(band),
        )


class SensitivityResponse(Wire):
    """Answer of `POST /v1/sensitivity`."""

    sensitivity: SensitivityOut
    residual: Annotated[float, Field(description="Residual vibration at the nominal [-].")]
