"""Every command of level 0 or 1 on a few samples, behind drives where steps do not just add."""

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.plants.mode import Mode
from design.sampling.left import DIFFERENCE, FREQUENCY_ERROR, residuals_of_many
from design.sampling.sample_grid import AnyIntArray
from design.types import ComplexArray, FloatArray

MAX_LISTED_SAMPLES = 14
"""Samples whose commands are all compared, 2^12 of them for the longest [-]."""

COMPARED_ONE_BY_ONE = 20
"""Commands that are compared exactly where only one at a time can be: some milliseconds each."""


def all_levels(samples: int) -> AnyIntArray:
    """Return the levels of every command of exactly so many samples.

    Parameters
    ----------
    samples
        From the first step to the last, 2 to `MAX_LISTED_SAMPLES` [-].

    Returns
    -------
    AnyIntArray
        Level from each sample on: 1 at first, 0 before the last, shape (2^(samples - 2), samples).
    """
    free = samples - 2
    levels = np.ones((2**free, samples), dtype=int)
    levels[:, 1:-1] = np.arange(2**free)[:, None] >> np.arange(free) & 1
    levels[:, -1] = 0
    return levels


def is_listed_exactly(actuator: Actuator) -> bool:
    """Return whether what many commands leave has a formula.

    Not so where limits to the jerk, or two sets of one state, follow cut ramps.
    """
    if not isinstance(actuator, RateLimited):
        return True
    return actuator.model == "superposed" and actuator.jerk_limit_m_s3 is None


def left_of_levels(
    levels: AnyIntArray, mode: Mode, actuator: Actuator, sample_time_s: float, *, slope: bool
) -> FloatArray:
    """Return what commands leave, exact where `is_listed_exactly`.

    Elsewhere exact for those that seem to leave least by a formula of straight ramps and
    superposed steps, and infinite for the others.

    Parameters
    ----------
    levels
        Level from each sample on, 1 at first and 0 before the last, shape (m, samples).
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time [s].
    slope
        Whether the slope counts, as in `unity_on_grid`.

    Returns
    -------
    FloatArray
        Shape (m,) [-].
    """
    if not isinstance(actuator, RateLimited):
        return _left_one_by_one(levels, mode, actuator, sample_time_s, slope=slope)
    left = _left_by_ramps(levels, mode, actuator, sample_time_s, slope=slope)
    if is_listed_exactly(actuator):
        return left
    few = np.argsort(left, kind="stable")[:COMPARED_ONE_BY_ONE]
    exact = np.full(len(levels), np.inf)
    exact[few] = _left_one_by_one(levels[few], mode, actuator, sample_time_s, slope=slope)
    return exact


def samples_of(levels: AnyIntArray) -> AnyIntArray:
    """Return at which samples levels change; they end at 1."""
    changes = np.diff(levels, prepend=0, append=1)
    found: AnyIntArray = np.flatnonzero(changes)
    return found


def _left_one_by_one(
    levels: AnyIntArray, mode: Mode, actuator: Actuator, sample_time_s: float, *, slope: bool
) -> FloatArray:
    """Return what commands leave, by the formula of many with as many steps, or each by itself."""
    changed = np.diff(levels, prepend=0, append=1, axis=1) != 0
    counts = np.count_nonzero(changed, axis=1)
    left = np.empty(len(levels))
    for count in np.unique(counts).tolist():
        rows = np.flatnonzero(counts == count)
        times = sample_time_s * np.nonzero(changed[rows])[1].reshape(-1, count)
        left[rows] = residuals_of_many(
            times, (-1.0) ** np.arange(count), mode, actuator, slope=slope
        )
    return left


def _left_by_ramps(
    levels: AnyIntArray, mode: Mode, actuator: RateLimited, sample_time_s: float, *, slope: bool
) -> FloatArray:
    """Return what commands leave behind constant slopes, cut where a command turns midway."""
    up_s, down_s = unit_ramps_s(actuator)
    pole = mode.pole_rad_s
    ratios = (1.0, 1 + DIFFERENCE, 1 - DIFFERENCE)[: 3 if slope else 1]
    lags = (actuator.accel_lag, actuator.decel_lag)
    unit = lags[0].denominator(pole)
    sums: list[ComplexArray] = [np.zeros(len(levels), dtype=np.complex128) for _ in ratios]
    reference = np.zeros(len(levels))

    def ramp(rising: bool, lasts_s: FloatArray, at_s: float) -> None:
        """Add ramps of these durations."""
        rate = 1 / up_s if rising else -1 / down_s
        lag = lags[0] if rising else lags[1]
        for one, ratio in enumerate(ratios):
            s = pole * ratio
            swing = np.exp(-s * at_s) * -np.expm1(-s * lasts_s) / s
            sums[one] = sums[one] + rate * swing * unit / lag.denominator(s)

    samples = levels.shape[1]
    for at in range(samples):
        up = np.where(levels[:, at] == 1, np.minimum((1 - reference) * up_s, sample_time_s), 0.0)
        down = np.where(levels[:, at] == 0, np.minimum(reference * down_s, sample_time_s), 0.0)
        ramp(True, up, at * sample_time_s)
        ramp(False, down, at * sample_time_s)
        reference = reference + up / up_s - down / down_s
    last_s = samples * sample_time_s
    final = (1 - reference) * up_s
    ramp(True, final, last_s)
    vectors = [
        total * np.exp(pole * last_s + pole * ratio * final)
        for total, ratio in zip(sums, ratios, strict=True)
    ]
    left: FloatArray = np.abs(vectors[0])
    if slope:
        left = left + FREQUENCY_ERROR * np.abs(vectors[1] - vectors[2]) / (2 * DIFFERENCE)
    return left
