"""The sensitivity curve of any impulses."""

from design.analysis.residual import residual_vibration
from design.analysis.sensitivity import sensitivity
from design.analysis.warnings import sum_warnings
from design.analysis.workable import require_workable
from design.analysis.worst_mode import worst_of
from schemas.base import name_field
from schemas.sensitivity import SensitivityRequest, SensitivityResponse
from schemas.sensitivity_curves import SensitivityOut
from schemas.warnings import WarningOut
from service.operations.operation import Operation
from service.operations.residuals_of_modes import of_modes
from service.operations.subject import subject_of


def sensitivity_curve(request: SensitivityRequest) -> SensitivityResponse:
    """Return the sensitivity curve of any impulses."""
    plant, actuator = subject_of(request)
    wanted = request.to_design()
    with name_field("impulses"):
        impulses = request.impulses.to_design()
    for mode in plant.modes:
        require_workable(mode, actuator)
    curves = [sensitivity(impulses, mode, actuator, wanted) for mode in plant.modes]
    residuals = [residual_vibration(impulses, mode, actuator) for mode in plant.modes]
    return SensitivityResponse(
        sensitivity=SensitivityOut.from_design(worst_of(curves)),
        residual=max(residuals),
        modes=of_modes(plant.modes, residuals, curves) if len(residuals) > 1 else None,
        warnings=[WarningOut.from_design(one) for one in sum_warnings(impulses)],
    )


OPERATION = Operation(
    request=SensitivityRequest, response=SensitivityResponse, run=sensitivity_curve
)
