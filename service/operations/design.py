"""Design one shaper, prove it, and add what is asked: its curve, its coefficients, its file."""

from design.analysis.worst_mode import worst_of
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.scheduled import Scheduled
from design.solving.textbooks import figures_beside_textbooks
from schemas.design_request import DesignRequest
from schemas.designs import DesignResponse
from schemas.fits import FitDesign
from schemas.ranges import RangeOut
from schemas.sensitivity_curves import SensitivityOut
from schemas.trace import TraceStepOut
from service.operations.design_picture import design_picture
from service.operations.fit import fit_with_residual
from service.operations.operation import Operation
from service.operations.requested_design import requested_design
from service.operations.residuals_of_modes import of_modes
from service.version import version


def design_shaper(request: DesignRequest) -> DesignResponse:
    """Design one shaper and prove it; raises what `requested_design` does."""
    done = requested_design(request)
    fits = None
    if request.fit is not None:
        subject = FitDesign(plant=request.plant, actuator=request.actuator, shaper=request.shaper)
        fits = fit_with_residual(subject, request.fit)
    scheduled = None
    if isinstance(done.plant, Scheduled) and done.design.worst_in_range is not None:
        scheduled = RangeOut.from_design(done.plant, done.design.worst_in_range)
    curves, modes, ramps = done.curves, done.plant.modes, None
    if isinstance(done.actuator, RateLimited):
        certificate = done.design.certificate
        claims = () if done.design.for_ideal else certificate.claims
        ramps = figures_beside_textbooks(done.design.impulses, modes, done.actuator, claims)
    curve = None
    if curves:
        curve = SensitivityOut.from_design(curves[0] if len(curves) == 1 else worst_of(curves))
    trace = [TraceStepOut.from_design(step) for step in done.trace]
    return DesignResponse.from_design(
        request.shaper.kind,
        done.design,
        ramps,
        done.sampled,
        curve,
        of_modes(modes, done.design.residuals, curves) if len(modes) > 1 else None,
        scheduled,
        fits,
        trace if request.trace else None,
        version(),
    )


OPERATION = Operation(
    request=DesignRequest, response=DesignResponse, run=design_shaper, draw=design_picture
)
