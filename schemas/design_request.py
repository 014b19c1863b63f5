"""Wire form of a request for a design."""

from typing import Annotated

from pydantic import Field

from schemas.actuators import ActuatorIn
from schemas.base import Wire
from schemas.drive_sensitivity import DriveIn
from schemas.fits import FitIn
from schemas.plants import PlantIn
from schemas.sensitivity_curves import SensitivityIn
from schemas.shapers import ShaperIn


def _is_false(value: object) -> bool:
    return value is False


class DesignRequest(Wire):
    """Body of `POST /v1/designs`."""

    plant: PlantIn
    actuator: ActuatorIn
    shaper: ShaperIn
    sensitivity: Annotated[
        SensitivityIn | None, Field(description="Range of the curve; null for no curve.")
    ] = SensitivityIn()
    drive: Annotated[
        DriveIn | None,
        Field(description="By how much the drive may be off; null for no residual of such drives."),
    ] = None
    fit: Annotated[
        FitIn | None, Field(description="Request for curve coefficients with the design.")
    ] = None
    trace: Annotated[
        bool,
        Field(
            description="Report each step of the search, with what was rejected and why. A "
            "refusal has the trace as well.",
            exclude_if=_is_false,
        ),
    ] = False
