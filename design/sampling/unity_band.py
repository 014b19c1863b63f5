"""Commands of level 0 or 1 over a band, where samples are longer than the gaps of a shaper.

All commands of a few samples are compared. Where none of them is within the tolerance and longer
ones are allowed, a shaper's impulses go to the nearest samples, where those that come to one
cancel, and what remains is changed at one sample or two at a time while that helps.
"""

import itertools

import numpy as np

from design.errors import InfeasibleDesignError
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.every_command import MAX_LISTED_SAMPLES, all_levels, is_listed_exactly
from design.sampling.left import (
    BAND_POINTS,
    FEW_POINTS,
    TIE,
    WANTED,
    Band,
    cuts_ramps,
    largest_over_band,
)
from design.sampling.on_off_search import WORK_ONE_BY_ONE, WORK_PER_LISTED, Searched
from design.sampling.sample_grid import AnyIntArray, nearest_integers
from design.solvers.budget import Budget
from design.types import FloatArray

SHIFTS, SHIFTS_IF_CUT, SHIFTS_IF_SLOW = 8, 3, 1
"""How many shifts of a shaper on its samples searches begin from; fewer where ramps are cut, and
each command takes milliseconds, and fewest where it has no formula."""

MAX_LISTED_IF_CUT, MAX_LISTED_IF_SLOW = 8, 6
"""Samples whose commands are all compared there: 2^6 and 2^4 of them for the longest [-]."""

UNSHAPED = 1.0
"""Residual of an unshaped step at each frequency [-]."""

LATER = 2
"""Samples that a command may take beyond its end."""

MAX_ROUNDS = 20
"""Changes of one command, at most."""

WORK_PER_SEARCH = 1_200_000.0
"""Work of a search; one that is spent ends with the best that it has [units]."""

MAX_CHANGED_IN_PAIRS = 80
"""Samples of a command up to which two are changed at a time."""


def unity_over_band(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    band: Band,
    *,
    tolerance: float,
    longest: int,
) -> tuple[Impulses, Searched]:
    """Return a command of level 0 or 1 that has little residual over a band.

    The shortest within the tolerance, or that of least residual, where all are compared.

    Parameters
    ----------
    impulses
        A shaper of unity magnitude, its gaps of any length.
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time, > 0 [s].
    band
        Lowest and highest ratio of true and nominal frequency [-].
    tolerance
        Largest residual over the band that is wanted, >= 0 [-].
    longest
        Samples of the longest command, >= 2 [-].

    Returns
    -------
    Impulses
        The best that was found, from the sample of the first impulse on.
    Searched
        What is proven of commands of as many samples as were all compared.

    Raises
    ------
    InfeasibleDesignError
        If none was found that has less than an unshaped step.
    """
    cut = cuts_ramps(impulses, actuator, sample_time_s)
    # Of all commands some change after one sample.
    cut = cut or max(unit_ramps_s(actuator)) > sample_time_s
    shifts, most = SHIFTS, MAX_LISTED_SAMPLES
    if cut and is_listed_exactly(actuator):
        shifts, most = SHIFTS_IF_CUT, MAX_LISTED_IF_CUT
    elif cut:
        shifts, most = SHIFTS_IF_SLOW, MAX_LISTED_IF_SLOW
    height = float(impulses.amplitudes[0])
    budget = Budget(most=WORK_PER_SEARCH)
    each = WORK_ONE_BY_ONE if cut else WORK_PER_LISTED

    def worst_of(levels: AnyIntArray) -> FloatArray:
        budget.spend(each * (FEW_POINTS * len(levels) + BAND_POINTS * min(len(levels), WANTED)))
        changes = np.diff(levels, prepend=0, axis=1) != 0
        counts = np.count_nonzero(changes, axis=1)
        worst = np.empty(len(levels))
        for count in np.unique(counts).tolist():
            rows = np.flatnonzero(counts == count)
            times = sample_time_s * np.nonzero(changes[rows])[1].reshape(-1, count)
            signs = height * (-1.0) ** np.arange(count)
            worst[rows] = largest_over_band(times, signs, mode, actuator, band)
        return worst

    best, least, listed = np.ones(1, dtype=int), np.inf, 1
    while least > tolerance and listed < min(longest, most) and not budget.spent:
        listed += 1
        levels = np.pad(all_levels(listed), ((0, 0), (0, 1)), constant_values=1)
        worst = worst_of(levels)
        if worst.min() < least - TIE:
            best, least = levels[np.argmin(worst)], float(worst.min())
    within = least <= tolerance
    proven = Searched(
        samples=None,
        left=least,
        searched=listed,
        complete=within or listed == longest,
        bound=least if listed > 1 else 0.0,
    )
    starts = [] if proven.complete else _starts(impulses, sample_time_s, shifts)
    for start in starts:
        levels, left = start, float(worst_of(start[None])[0])
        for _ in range(MAX_ROUNDS):
            if budget.spent:
                break
            changed = _changed(levels, pairs=not cut)
            worst = worst_of(changed)
            if worst.min() >= left - TIE:
                break
            levels, left = changed[np.argmin(worst)], float(worst.min())
        if left < least - TIE:
            best, least = levels, left
    if least >= UNSHAPED:
        raise InfeasibleDesignError(
            f"no command of level 0 or 1 on samples of {sample_time_s:g} s was found whose "
            f"residual over the band of {band[0]:.4g} to {band[1]:.4g} is less than that of an "
            f"unshaped step; proven: no command of up to {listed} samples has less than "
            f"{100 * proven.bound:.4g} %: take a shorter sample time",
            code="band_not_on_samples",
        )
    samples = np.flatnonzero(np.diff(best, prepend=0))
    first = nearest_integers(impulses.times_s[:1] / sample_time_s)
    command = Impulses(
        times_s=(first + samples - samples[0]) * sample_time_s,
        amplitudes=height * (-1.0) ** np.arange(samples.size),
    )
    return command, proven


def _starts(impulses: Impulses, sample_time_s: float, shifts: int) -> list[AnyIntArray]:
    """Return the levels of a shaper at its nearest samples, from several shifts, each once."""
    positions = (impulses.times_s - impulses.times_s[0]) / sample_time_s
    found: dict[bytes, AnyIntArray] = {}
    for shift in range(shifts):
        samples = nearest_integers(positions + shift / shifts - 0.5)
        samples -= samples[0]
        steps = np.zeros(samples[-1] + 1 + LATER, dtype=int)
        np.add.at(steps, samples, nearest_integers(impulses.amplitudes / impulses.amplitudes[0]))
        levels = np.cumsum(steps)
        levels[0] = 1
        found.setdefault(levels.tobytes(), levels)
    return list(found.values())


def _changed(levels: AnyIntArray, *, pairs: bool) -> AnyIntArray:
    """Return levels with another one at one sample, or at two, shape (m, n); the last stays."""
    free = range(1, levels.size - 1)
    sets: list[tuple[int, ...]] = [(one,) for one in free]
    if pairs and levels.size <= MAX_CHANGED_IN_PAIRS:
        sets += itertools.combinations(free, 2)
    rows = np.repeat(levels[None], len(sets), axis=0)
    for row, places in zip(rows, sets, strict=True):
        row[list(places)] ^= 1
    return rows
