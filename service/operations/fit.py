"""Curve coefficients of a shaper over one field of the plant."""

from design.curve_fit.fit import fit
from design.curve_fit.fit_range import plants_at_ends
from design.pipeline import design
from schemas.base import name_field
from schemas.fits import FitDesign, FitIn, FitOut, FitRequest
from service.operations.operation import Operation
from service.operations.subject import NO_FIT_ON_SAMPLES, subject_of


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
    plant, actuator = subject_of(subject)
    with name_field("shaper"):
        options = subject.shaper.continuous_options(NO_FIT_ON_SAMPLES)
    with name_field("fit"):
        wanted = fit_in.to_design(subject.plant.kind)
        ends = plants_at_ends(plant, wanted)
    kind = subject.shaper.shaper_kind()
    found = fit(plant, actuator, kind, wanted, options)
    # Polynomials are no better than what they were fitted to.
    ignored = [
        warning
        for end in ends
        for warning in design(end, actuator, kind, options).warnings
        if warning.code == "actuator_ignored"
    ]
    return FitOut.from_design(found, subject, ignored[-1:])


OPERATION = Operation(request=FitRequest, response=FitOut, run=fit_curves)
