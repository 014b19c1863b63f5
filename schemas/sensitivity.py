"""Wire form of what is asked and answered about sensitivity."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.sensitivity import Sensitivity
from design.model.plants.mode import Mode
from schemas.actuators import ActuatorIn
from schemas.base import Wire, leave_out_none
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn
from schemas.sensitivity_curves import SensitivityIn, SensitivityOut
from schemas.warnings import Warnings


class SensitivityRequest(SensitivityIn):
    """Body of `POST /v1/sensitivity`."""

    impulses: ImpulsesWire
    plant: PlantIn
    actuator: ActuatorIn


class ModeOut(Wire):
    """The residual of a shaper in one of several modes."""

    natural_frequency_rad_s: float
    damping_ratio: float
    residual: Annotated[float, Field(description="Residual in this mode [-].")]
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
        "Figures of each mode of a plant of several. Residual and sensitivity beside it are "
        "then of the worst mode, with all frequencies changing alike. Otherwise left out."
    ),
]


class SensitivityResponse(Wire):
    """Answer of `POST /v1/sensitivity`."""

    sensitivity: SensitivityOut
    residual: Annotated[
        float, Field(description="Residual vibration at the nominal frequency [-].")
    ]
    modes: OfModes
    warnings: Warnings
