"""Wire form of sensitivity curves."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.insensitivity import Insensitivity
from design.analysis.sensitivity import (
    MAX_CURVE_POINTS,
    RATIO_BOUNDS,
    DampingRange,
    Sensitivity,
    SensitivityRange,
)
from design.model.plants.mode import Mode
from schemas.actuators import ActuatorIn
from schemas.base import PlantDamping, Wire, leave_out_none
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn
from schemas.warnings import Warnings

Ratio = Annotated[float, Field(ge=RATIO_BOUNDS[0], le=RATIO_BOUNDS[1])]


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


class SensitivityIn(Wire):
    """What part of the curve is wanted."""

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


class SensitivityRequest(SensitivityIn):
    """Body of `POST /v1/sensitivity`."""

    impulses: ImpulsesWire
    plant: PlantIn
    actuator: ActuatorIn


class InsensitivityOut(Wire):
    """The interval around 1 on which the residual is within the tolerance."""

    tolerance: float
    lower_ratio: Annotated[
        float | None, Field(description="Lower edge; null where the search found none [-].")
    ]
    upper_ratio: Annotated[float | None, Field(description="Upper edge; null likewise [-].")]
    width: Annotated[
        float | None, Field(description="Upper less lower edge; null without either [-].")
    ]
    searched_from_ratio: Annotated[
        float,
        Field(
            description="Lower end of what is known to be within the tolerance: the edge, or "
            "where the search for it ended [-]."
        ),
    ]
    searched_to_ratio: Annotated[float, Field(description="Upper end, likewise [-].")]

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
    """What is left over the plant's damping ratio, its natural frequency as given."""

    damping_ratio: list[float]
    residual: list[float]
    worst: Annotated[float, Field(description="Largest residual of the curve's points [-].")]


class SensitivityOut(Wire):
    """A sensitivity curve."""

    frequency_ratio: list[float]
    residual: list[float]
    insensitivity: InsensitivityOut | None
    damping: Annotated[DampingOut | None, leave_out_none("Where a range of damping is asked for.")]

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


class ModeOut(Wire):
    """What a shaper leaves in one of several modes."""

    natural_frequency_rad_s: float
    damping_ratio: float
    residual: Annotated[float, Field(description="Left in this mode [-].")]
    sensitivity: SensitivityOut | None

    @classmethod
    def from_design(cls, mode: Mode, residual: float, curve: Sensitivity | None) -> Self:
        """Wrap the design records.

        Parameters
        ----------
        mode
            The mode.
        residual
            Residual vibration in it [-].
        curve
            Its sensitivity; None where it was not asked for.

        Returns
        -------
        Self
            Without the curve where there is none.
        """
        return cls.model_construct(
            natural_frequency_rad_s=mode.natural_frequency_rad_s,
            damping_ratio=mode.damping_ratio,
            residual=residual,
            sensitivity=None if curve is None else SensitivityOut.from_design(curve),
        )


OfModes = Annotated[
    list[ModeOut] | None,
    leave_out_none(
        "Of a plant of several modes, what each has; residual and sensitivity beside it are then "
        "of the worst, all frequencies changing alike. Left out else."
    ),
]


class SensitivityResponse(Wire):
    """Answer of `POST /v1/sensitivity`."""

    sensitivity: SensitivityOut
    residual: Annotated[float, Field(description="Residual vibration at the nominal [-].")]
    modes: OfModes
    warnings: Warnings
