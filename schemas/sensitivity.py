"""Wire form of what is asked and answered about sensitivity."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.sensitivity import Sensitivity
from design.model.plants.mode import Mode
from schemas.actuators import ActuatorIn
from schemas.base import Wire, leave_out_none
from schemas.drive_sensitivity import DriveIn, DriveOut
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn
from schemas.sensitivity_curves import SensitivityIn, SensitivityOut
from schemas.warnings import Warnings


class SensitivityRequest(SensitivityIn):
    """Body of `POST /v1/sensitivity`."""

    impulses: Annotated[ImpulsesWire, Field(description="Command whose residual is asked for.")]
    plant: PlantIn
    actuator: ActuatorIn
    drive: Annotated[
        DriveIn | None,
        Field(description="By how much the drive may be off; null for no such curve."),
    ] = None


class ModeOut(Wire):
    """The residual of a shaper in one of several modes."""

    natural_frequency_rad_s: Annotated[
        float, Field(description="Undamped natural frequency of the mode [rad/s].")
    ]
    damping_ratio: Annotated[float, Field(description="Share of critical damping [-].")]
    residual: Annotated[float, Field(description="Residual in this mode [-].")]
    sensitivity: Annotated[
        SensitivityOut | None, Field(description="Curve of this mode; null if not asked for.")
    ]

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
        "Figures of each mode of a plant of several. Residual and sensitivity beside it are "
        "then of the worst mode, with all frequencies changing alike. Otherwise left out."
    ),
]


class SensitivityResponse(Wire):
    """Answer of `POST /v1/sensitivity`."""

    sensitivity: Annotated[
        SensitivityOut, Field(description="Curve of the residual, and its band.")
    ]
    residual: Annotated[
        float, Field(description="Residual vibration at the nominal frequency [-].")
    ]
    modes: OfModes
    drive: Annotated[
        DriveOut | None,
        leave_out_none("Residual where the drive is off, where that is asked for."),
    ]
    warnings: Warnings
