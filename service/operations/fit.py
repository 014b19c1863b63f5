"""Curve coefficients of a shaper over one field of the plant."""

from typing import TYPE_CHECKING, Any

from design.analysis.warnings import DesignWarning
from design.curve_fit.fit import fit
from design.curve_fit.fit_range import FitRange, plants_at_ends
from design.curve_fit.polynomials import Fit
from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.pipeline import design
from design.shapers.refusals import require_small_swings
from schemas.base import name_field
from schemas.fits import FitDesign, FitIn, FitOut, FitRequest, name_fit
from schemas.samples import continuous_options
from schemas.shapers import ShaperIn
from service.operations.operation import Operation
from service.operations.subject import subject_of
from service.version import version

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NO_FIT_ON_SAMPLES = (
    "a fit is over times that change smoothly, which whole samples do not; take a table over the "
    "same range, whose rows are on samples"
)


def fit_curves(request: FitRequest) -> FitOut:
    """Return curve coefficients of a shaper over one field of the plant.

    Parameters
    ----------
    request
        The plant, the actuator, the shaper, and the range of the field.

    Returns
    -------
    FitOut
        The coefficients, with the largest residual over the range.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the range goes beyond the bounds of the plant.
    InfeasibleDesignError
        If some point of the range has no such shaper, or no degree is good enough.
    """
    subject = FitDesign(plant=request.plant, actuator=request.actuator, shaper=request.shaper)
    return fit_with_residual(subject, request.fit)


def fit_with_residual(subject: FitDesign, fit_in: FitIn) -> FitOut:
    """Return curve coefficients of a design, and their worst residual.

    Parameters
    ----------
    subject
        The plant, the actuator and the shaper.
    fit_in
        Field of the plant, range and quality.

    Returns
    -------
    FitOut
        The coefficients, with the largest residual over the range.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the range goes beyond the bounds of the plant.
    InfeasibleDesignError
        If some point of the range has no such shaper, or no degree is good enough.
    """
    _, _, _, found, warnings = _fitted(subject, fit_in)
    return FitOut.from_design(found, subject, warnings)


def fit_picture(request: FitRequest) -> "Figure":
    """Draw the coefficients that `fit_curves` returns.

    Parameters
    ----------
    request
        The plant, the actuator, the shaper, and the range of the field.

    Returns
    -------
    Figure
        The times over the field, and the residual of the fitted times.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the range goes beyond the bounds of the plant.
    InfeasibleDesignError
        If some point of the range has no such shaper, or no degree is good enough.
    """
    from design.pictures.fit_sheet import fit_sheet  # noqa: PLC0415 - matplotlib takes a second

    return fit_sheet(request.shaper.kind, *_fitted(request, request.fit), version())


def _fitted(
    subject: FitDesign, fit_in: FitIn
) -> tuple[Plant, Actuator, FitRange, Fit, list[DesignWarning]]:
    plant, actuator = subject_of(subject)
    options, wanted, ends = read_fit(subject.shaper, fit_in, subject.plant.kind, plant)
    kind = subject.shaper.shaper_kind()
    with name_fit():
        found = fit(plant, actuator, kind, wanted, options)
    # Polynomials are no better than what they were fitted to.
    ignored = [
        warning
        for end in ends
        for warning in design(end, actuator, kind, options).warnings
        if warning.code == "actuator_ignored"
    ]
    return plant, actuator, wanted, found, ignored[-1:]


def read_fit(
    shaper: ShaperIn, fit_in: FitIn, plant_kind: str, plant: Plant
) -> tuple[Any, FitRange, tuple[Plant, Plant]]:
    """Return options, range and plants of a fit; every fault of it is found.

    Parameters
    ----------
    shaper, fit_in, plant_kind
        The shaper, the fit and the kind of the plant as the request has them.
    plant
        The plant that the request describes.

    Returns
    -------
    tuple of Any, FitRange and tuple of Plant
        Options of the kind of shaper, the range, and the plants at its ends.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the kind of shaper is not served.
    """
    require_small_swings(shaper.shaper_kind(), "fits")
    with name_field("shaper"):
        options = continuous_options(shaper, NO_FIT_ON_SAMPLES)
    with name_field("fit"):
        wanted = fit_in.to_design(plant_kind)
        return options, wanted, plants_at_ends(plant, wanted)


OPERATION = Operation(request=FitRequest, response=FitOut, run=fit_curves, draw=fit_picture)
