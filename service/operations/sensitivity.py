"""The sensitivity curve of any impulses."""

from typing import TYPE_CHECKING, NamedTuple

from design.analysis.drive_sensitivity import drive_sensitivity
from design.analysis.residual import residual_vibration
from design.analysis.sensitivity import Sensitivity, sensitivity
from design.analysis.warnings import sum_warnings
from design.analysis.workable import require_workable
from design.analysis.worst_mode import worst_of
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from schemas.base import name_field
from schemas.drive_sensitivity import DriveOut
from schemas.sensitivity import SensitivityRequest, SensitivityResponse
from schemas.sensitivity_curves import SensitivityOut
from schemas.warnings import WarningOut
from service.operations.operation import Operation
from service.operations.residuals_of_modes import of_modes
from service.operations.subject import subject_of
from service.version import version

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def sensitivity_curve(request: SensitivityRequest) -> SensitivityResponse:
    """Return the sensitivity curve of any impulses."""
    found = _curves_of(request)
    several = len(found.residuals) > 1
    drive = None
    if request.drive is not None:
        off = drive_sensitivity(
            found.impulses, found.plant.modes, found.actuator, request.drive.to_design()
        )
        drive = DriveOut.from_design(off)
    return SensitivityResponse(
        sensitivity=SensitivityOut.from_design(worst_of(found.curves)),
        residual=max(found.residuals),
        modes=of_modes(found.plant.modes, found.residuals, found.curves) if several else None,
        drive=drive,
        warnings=[WarningOut.from_design(one) for one in sum_warnings(found.impulses)],
    )


def sensitivity_picture(request: SensitivityRequest) -> "Figure":
    """Draw the curve that `sensitivity_curve` returns.

    Parameters
    ----------
    request
        The impulses, the plant and the actuator.

    Returns
    -------
    Figure
        The curve of each mode, over damping too where that is asked for.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    """
    from design.pictures.sensitivity_sheet import sensitivity_sheet  # noqa: PLC0415 - matplotlib takes a second

    found = _curves_of(request)
    return sensitivity_sheet(*found, tuple(sum_warnings(found.impulses)), version())


class _Curves(NamedTuple):
    """Impulses with their curve and residual in each mode."""

    plant: Plant
    actuator: Actuator
    impulses: Impulses
    curves: list[Sensitivity]
    residuals: list[float]


def _curves_of(request: SensitivityRequest) -> _Curves:
    plant, actuator = subject_of(request)
    wanted = request.to_design()
    with name_field("impulses"):
        impulses = request.impulses.to_design()
    for mode in plant.modes:
        require_workable(mode, actuator)
    curves = [sensitivity(impulses, mode, actuator, wanted) for mode in plant.modes]
    residuals = [residual_vibration(impulses, mode, actuator) for mode in plant.modes]
    return _Curves(plant, actuator, impulses, curves, residuals)


OPERATION = Operation(
    request=SensitivityRequest,
    response=SensitivityResponse,
    run=sensitivity_curve,
    draw=sensitivity_picture,
)
