"""Design one shaper, prove it, and add what is asked: its curve, its coefficients, its file."""

from design.analysis.worst_mode import worst_of
from design.model.actuators.rate_limited import RateLimited
from schemas.design_request import DesignRequest
from schemas.designs import DesignResponse
from schemas.sensitivity_curves import SensitivityOut
from schemas.trace import TraceStepOut
from service.operations import design_parts
from service.operations.design_picture import design_picture
from service.operations.operation import Operation
from service.operations.requested_design import requested_design
from service.operations.residuals_of_modes import of_modes
from service.version import version


def design_shaper(request: DesignRequest) -> DesignResponse:
    """Design one shaper and prove it; raises what `requested_design` does."""
    done = requested_design(request)
    curves, modes, limits = done.curves, done.plant.modes, done.actuator
    curve = None
    if curves:
        curve = SensitivityOut.from_design(curves[0] if len(curves) == 1 else worst_of(curves))
    trace = [TraceStepOut.from_design(step) for step in done.trace]
    return DesignResponse.from_design(
        request.shaper.kind,
        done.design,
        design_parts.ramps_part(done, limits) if isinstance(limits, RateLimited) else None,
        done.sampled,
        curve,
        None if request.drive is None else design_parts.drive_part(done, request.drive),
        of_modes(modes, done.design.residuals, curves) if len(modes) > 1 else None,
        design_parts.range_part(done) if done.design.worst_in_range is not None else None,
        None if request.fit is None else design_parts.fit_part(request, request.fit),
        trace if request.trace else None,
        version(),
    )


OPERATION = Operation(
    request=DesignRequest, response=DesignResponse, run=design_shaper, draw=design_picture
)
