"""Parts of the answer with a design that not every request has: fit, range, limits, drive."""

from design.analysis.drive_sensitivity import drive_sensitivity
from design.analysis.ramp_figures import RampFigures
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.scheduled import Scheduled
from design.solving.textbooks import figures_beside_textbooks
from schemas.design_request import DesignRequest
from schemas.drive_sensitivity import DriveIn, DriveOut
from schemas.fits import FitDesign, FitIn, FitOut
from schemas.ranges import RangeOut
from service.operations.fit import fit_with_residual
from service.operations.requested_design import RequestedDesign


def fit_part(request: DesignRequest, wanted: FitIn) -> FitOut:
    """Return the coefficients that are asked for with a design.

    Parameters
    ----------
    request, wanted
        The request, and its range of the fit.

    Returns
    -------
    FitOut
        As `fit_with_residual` does.
    """
    subject = FitDesign(plant=request.plant, actuator=request.actuator, shaper=request.shaper)
    return fit_with_residual(subject, wanted)


def range_part(done: RequestedDesign) -> RangeOut | None:
    """Return the figures over the range of a scheduled plant; None of another."""
    if isinstance(done.plant, Scheduled) and done.design.worst_in_range is not None:
        return RangeOut.from_design(done.plant, done.design.worst_in_range)
    return None


def ramps_part(done: RequestedDesign, actuator: RateLimited) -> RampFigures:
    """Return what the limits of a drive make of a design.

    Parameters
    ----------
    done, actuator
        The design, and the limits.

    Returns
    -------
    RampFigures
        Beside those of the textbook's shapers.
    """
    claims = () if done.design.for_ideal else done.design.certificate.claims
    return figures_beside_textbooks(done.design.impulses, done.plant.modes, actuator, claims)


def drive_part(done: RequestedDesign, wanted: DriveIn) -> DriveOut:
    """Return the residual of a design where its drive is off.

    Parameters
    ----------
    done, wanted
        The design, and by how much the drive may be off.

    Returns
    -------
    DriveOut
        As of `POST /v1/sensitivity`.
    """
    found = done.design.impulses, done.plant.modes, done.actuator
    return DriveOut.from_design(drive_sensitivity(*found, wanted.to_design()))
