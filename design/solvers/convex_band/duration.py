"""About how long the fastest shaper over a band lasts, by Chebyshev's windows."""

import math

from design.errors import InfeasibleDesignError
from design.formulations.bands import BandProblem

MAX_HALF_PERIODS = 26.0
"""Half periods of a shaper, and so about its impulses, up to which cone programs are solved [-]."""

EASIER = 1.01
"""Margin of a tolerance that is offered instead, over what an estimate or a grid reaches [-]."""


def ripples_of(residual: float) -> float:
    """Return the ripples of a residual, ``acosh(1 / residual)`` [-].

    Ripples grow about evenly with the duration of a shaper, as those of Chebyshev's windows do. A
    residual of 1 or more counts as just below 1.
    """
    return math.acosh(1 / min(residual, 1 - 1e-12))


def first_duration_rad(problem: BandProblem) -> float:
    """Return about how long the fastest shaper lasts [rad].

    ``n`` impulses a half period of the band's centre apart reach, as a Dolph-Chebyshev window,
    ``1 / T_{n-1}(1 / sin(pi h / 2))`` over the relative half width h; here n need not be whole.
    """
    centre = sum(problem.band) / 2 * problem.unit_pole.imag
    share = 1.05 if problem.levels is None else 0.8
    return math.pi / centre * max(_half_periods(problem), 0.5) * share


def _half_periods(problem: BandProblem) -> float:
    """Return that duration in half periods of the band's centre [-]."""
    lower, upper = problem.band
    edge = math.acosh(1 / math.sin(math.pi / 2 * (upper - lower) / (upper + lower)))
    return ripples_of(problem.tolerance) / edge


def require_solvable(problem: BandProblem) -> None:
    """Raise InfeasibleDesignError where a band takes too many impulses."""
    half_periods = _half_periods(problem)
    if half_periods > MAX_HALF_PERIODS:
        lower, upper = problem.band
        ripples = MAX_HALF_PERIODS / half_periods * ripples_of(problem.tolerance)
        raise InfeasibleDesignError(
            f"a residual within {problem.tolerance:g} from {lower:g} to {upper:g} of the natural "
            f"frequency takes about {half_periods:.3g} half periods of its middle, with an "
            f"impulse in each, and the limit is {MAX_HALF_PERIODS:g}: narrow the band, or allow "
            f"a tolerance of {EASIER / math.cosh(ripples):.4g}",
            code="band_too_wide",
        )
