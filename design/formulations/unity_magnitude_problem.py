"""The problem of steps up and down for one mode and drive: parameters, bounds, published seeds."""

import cmath
import math
from dataclasses import replace

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.equations import GapProblem
from design.formulations.gaps import MIN_GAP_RAD, PERIOD_RAD, settling_gaps_rad
from design.formulations.lag_parameters import decel_over_accel, lag_parameters, switched_order
from design.formulations.published_times import ZV_POLYNOMIALS, ZVD_POLYNOMIALS
from design.formulations.seeds import Seed
from design.formulations.unity_magnitude import UnityMagnitude
from design.formulations.vector_diagram import undamped_seeds
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.types import FloatArray


def alternating(impulses: int) -> FloatArray:
    """Return the amplitudes +1, -1, +1 ..., shape (impulses,)."""
    return np.array([1.0 - 2.0 * (number % 2) for number in range(impulses)])


def unity_magnitude_problem(
    model: UnityMagnitude,
    mode: Mode,
    actuator: Actuator,
    *,
    settle: bool = False,
    max_duration_periods: float,
    amplitudes: FloatArray | None = None,
    seeds: tuple[Seed, ...] = (),
) -> GapProblem:
    """Formulate a shaper of steps up and down for one mode.

    Parameters
    ----------
    model, mode, actuator
        Number of impulses and order of the equations; the plant's mode and its drive.
    settle, max_duration_periods
        Whether each step must settle before the next; longest shaper in undamped periods [-].
    amplitudes, seeds
        Heights, +1, -1, +1, ... if not given; of three others the undamped triangle is the seed, of
        more the seeds are needed.

    Returns
    -------
    GapProblem
        In the gaps.

    Raises
    ------
    InfeasibleDesignError
        If ramps and settling take longer than the longest shaper.
    """
    lags = lag_parameters(mode, actuator)
    shortest = settling_gaps_rad(mode, actuator, model.impulses, settle=settle)
    horizon = max_duration_periods * PERIOD_RAD
    if shortest.sum() > horizon:
        raise InfeasibleDesignError(
            f"ramps and settling between switches take {shortest.sum() / PERIOD_RAD:.4g} periods "
            f"in all, more than max_duration_periods = {max_duration_periods:g}",
            code="settling_exceeds_duration",
        )
    ratio = decel_over_accel(mode, actuator)
    if amplitudes is None:
        weights: FloatArray = np.zeros(0)
        heights = alternating(model.impulses)
        seeds = _seeds(model, mode.damping_ratio, ratio, shortest)
    else:
        weights = heights = amplitudes
        seeds = seeds or undamped_seeds(ratio, shortest, horizon, amplitudes)
    return GapProblem(
        model=replace(
            model,
            switched_order=switched_order(actuator),
            ramped=isinstance(actuator, RateLimited),
            weighted=weights.size > 0,
        ),
        parameters=np.concatenate((lags, weights)),
        amplitudes=heights,
        natural_frequency_rad_s=mode.natural_frequency_rad_s,
        shortest_gaps_rad=shortest,
        horizon_rad=horizon,
        seeds=seeds,
        designed_for=actuator,
    )


def _seeds(
    model: UnityMagnitude, damping_ratio: float, ratio: complex, shortest: FloatArray
) -> tuple[Seed, ...]:
    """Polynomials of the literature, shifted by the actuators' phase, then as published.

    A step through the deceleration set acts as if it came later by the phase of the ratio, so its
    time in the seed moves by that. Where a gap is too short to settle, no seed shows which branch
    is the fastest: all are searched.
    """
    label = "umzv_polynomials" if model.derivatives == 0 else "umzvd_polynomials"
    table = ZV_POLYNOMIALS if model.derivatives == 0 else ZVD_POLYNOMIALS
    published = [
        PERIOD_RAD * (a + damping_ratio * (b + damping_ratio * (c + damping_ratio * d)))
        for a, b, c, d in table
    ]
    shift = cmath.phase(ratio) / math.sqrt(1 - damping_ratio**2)
    shifted = [time + shift * (index % 2 == 0) for index, time in enumerate(published)]
    seeds = []
    if shortest.size != len(table):  # of more steps none are published
        return ()
    for name, times in ((label, shifted), (f"{label}_as_published", published)):
        gaps = np.diff([0.0, *times])
        if shortest.max() <= MIN_GAP_RAD or (gaps >= shortest).all():
            seeds.append(Seed(name=name, gaps_rad=gaps))
    return tuple(seeds)
