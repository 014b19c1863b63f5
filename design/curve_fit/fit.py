"""Curve coefficients: impulse times as polynomials, so that a controller needs no solver.

``t ~ 1/w`` is no polynomial in w, which is why the thesis's fit is off by a third of a second.
The phases ``w t`` behind an actuator depend on the ratio of the plant's frequency to the
actuator's alone, smoothly: a few coefficients do.
"""

import math

from design.curve_fit.exact_curve import ExactCurve
from design.curve_fit.fit_range import MAX_DEGREE, FitRange
from design.curve_fit.polynomials import Fit
from design.curve_fit.variable import axis_of_fit
from design.errors import InfeasibleDesignError, SolverFailedError
from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.shapers.refusals import require_small_swings


def fit(
    plant: Plant,
    actuator: Actuator,
    kind: ShaperKind,
    wanted: FitRange,
    options: ShaperOptions | None = None,
) -> Fit:
    """Fit the impulse times of a shaper over a range of the plant.

    Parameters
    ----------
    plant
        The plant; its own value of the fitted field does not matter.
    actuator, kind, options
        As for `design.pipeline.design`.
    wanted
        Field, range and quality.

    Returns
    -------
    Fit
        By interpolation at Chebyshev nodes in a dimensionless variable, or by the thesis's least
        squares; judged on a separate grid by the residual of the fitted times.

    Raises
    ------
    InvalidInputError
        If the plant has no such field, or the range exceeds its bounds.
    InfeasibleDesignError
        If some point of the range has no such shaper, or no degree up to 20 is good enough.
    SolverFailedError
        If fitted times leave the range of numbers: those of the degree asked for, or of degree 0.
    """
    require_small_swings(kind, "fits")
    curve = ExactCurve(axis_of_fit(plant, actuator, wanted), actuator, kind, options)
    if wanted.degree is not None:
        return curve.fit(wanted.degree)
    limit = wanted.max_residual or 0.0
    best = math.inf, 0
    for degree in range(MAX_DEGREE + 1):
        try:
            tried = curve.fit(degree)
        except SolverFailedError as error:
            if error.code != "fit_overflows" or math.isinf(best[0]):
                raise
            break  # more powers of so narrow a range leave the numbers too
        if tried.worst_residual <= limit:
            return tried
        best = min(best, (tried.worst_residual, degree))
        if curve.budget.spent:
            break
    exact = curve.exact_worst_residual
    itself = (
        f"; the exact times of {kind.name} have {exact:.3g} themselves" if exact > limit else ""
    )
    raise InfeasibleDesignError(
        f"no degree up to {degree} has a residual of at most max_residual = {limit:g}; that of "
        f"the best, degree {best[1]}, is "
        f"{best[0]:.3g}{itself}{f'; {curve.budget.in_words}' if curve.budget.spent else ''}",
        code="no_degree_suffices",
    )
