"""About how long the fastest shaper over bands lasts, by Chebyshev's windows."""

import math

from design.errors import InfeasibleDesignError
from design.formulations.bands import BandProblem, PoleBand

MAX_HALF_PERIODS = 26.0
"""Half periods of a shaper, and so about its impulses, up to which cone programs are solved [-]."""

MAX_FAST_HALF_PERIODS = 50.0
"""Half periods of the highest frequency: a grid resolves them, and one mode never has as many [-].

Of a mode that is 25 times as fast as another the fastest shaper is found, of one that is 30 times
as fast no more within the budget.
"""

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
    Windows over several bands, convolved, last as long as all together.
    """
    share = 1.05 if problem.levels is None else 0.8
    durations = [
        math.pi
        / ((band.lower + band.upper) / 2 * band.unit_pole.imag)
        * max(_half_periods(band, problem.tolerance), 0.5)
        for band in problem.bands
    ]
    return share * sum(durations)


def _half_periods(band: PoleBand, tolerance: float) -> float:
    """Return that duration in half periods of the band's centre [-]."""
    edge = math.acosh(1 / math.sin(math.pi / 2 * band.width / (band.upper + band.lower)))
    return ripples_of(tolerance) / edge


def require_solvable(problem: BandProblem) -> None:
    """Raise InfeasibleDesignError where bands take too many impulses."""
    half_periods = sum(_half_periods(band, problem.tolerance) for band in problem.bands)
    if half_periods > MAX_HALF_PERIODS:
        ripples = MAX_HALF_PERIODS / half_periods * ripples_of(problem.tolerance)
        raise InfeasibleDesignError(
            f"{problem.asked} takes about {half_periods:.3g} half periods of its middle, with an "
            f"impulse in each, and the limit is {MAX_HALF_PERIODS:g}: narrow the band, or allow "
            f"a tolerance of {EASIER / math.cosh(ripples):.4g}",
            code="band_too_wide",
        )
    highest = max(abs(band.unit_pole) * band.upper for band in problem.bands)
    fast = first_duration_rad(problem) * highest / math.pi
    if fast > MAX_FAST_HALF_PERIODS:
        raise InfeasibleDesignError(
            f"{problem.asked} takes about {fast:.3g} half periods of the highest frequency, and "
            f"the limit is {MAX_FAST_HALF_PERIODS:g}: narrow the bands, allow a larger tolerance, "
            "or take convolved with an ei base, which has bands that follow from its tolerance",
            code="modes_too_far_apart",
        )
