"""What amplitudes on few samples can do at best, by dense programs and by listing commands.

Nothing of the package's is called: V is a sum of turns, and circles are polygons around them.
"""

import math
from dataclasses import dataclass

import numpy as np

from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.types import ComplexArray, FloatArray
from tests.second_route import gain_and_slope

MAX_SAMPLES = 40
"""Longest command of a dense program [-]."""

MAX_LISTED = 12
"""Longest command of level 0 or 1 that is listed with all others, 2^10 of them [-]."""

ANGLES, RATIOS = 24, 41
"""Sides of a polygon around a circle, and frequencies of a band [-]."""

LISTED_RATIOS = 81
"""Frequencies of a band for listed commands: every fifth is one of the 17 of a search, so that what
a search proves of these holds here [-]."""

ERROR = 0.05
"""Error in frequency by which a slope is weighed against the residual [-]."""

DIFFERENCE = 1e-5


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """A tolerance over a band of one mode; of equal ends at one frequency.

    ``order`` is that of a Taylor term of V, seen at the last sample, that counts in its place: at
    5 % of error.
    """

    mode: Mode
    band: tuple[float, float]
    limit: float
    order: int = 0


def rows_of(
    wanted: Wanted, samples: int, sample_time_s: float, ratios: int = RATIOS
) -> ComplexArray:
    """Return V of a step on each sample, seen at the last, shape (r, samples)."""
    count = 1 if wanted.band[0] == wanted.band[1] else ratios
    poles = wanted.mode.pole_rad_s * np.linspace(*wanted.band, count)
    turns = np.multiply.outer(poles, sample_time_s * np.arange(samples)[::-1])
    factor = (ERROR * turns) ** wanted.order / math.factorial(wanted.order)
    rows: ComplexArray = factor * np.exp(turns)
    return rows


def best_amplitudes(
    wanted: list[Wanted], samples: int, sample_time_s: float, levels: tuple[float, float] | None
) -> FloatArray | None:
    """Return amplitudes on all samples that miss least; between levels, or positive if None."""
    from scipy.optimize import linprog

    rows = np.concatenate([rows_of(one, samples, sample_time_s) / one.limit for one in wanted])
    turns = np.exp(1j * np.linspace(0, 2 * np.pi, ANGLES, endpoint=False))
    sides = np.concatenate([(turn * rows).real for turn in turns])
    above = [np.hstack((sides, -np.ones((len(sides), 1))))]
    most = [np.zeros(len(sides))]
    if levels is not None:
        sums = np.hstack((np.tril(np.ones((samples, samples))), np.zeros((samples, 1))))
        above += [sums, -sums]
        most += [np.full(samples, levels[1]), np.full(samples, -levels[0])]
    reach = 0.0 if levels is None else levels[1] - levels[0]
    found = linprog(
        np.append(np.zeros(samples), 1.0),
        A_ub=np.concatenate(above),
        b_ub=np.concatenate(most),
        A_eq=np.append(np.ones(samples), 0.0)[None],
        b_eq=np.ones(1),
        bounds=[(-reach, None)] * samples + [(0, None)],
    )
    return found.x[:-1] if found.status == 0 else None


def missed(
    wanted: list[Wanted], amplitudes: FloatArray, sample_time_s: float, ratios: int = 2001
) -> float:
    """Return the largest of what amplitudes leave, over the limits, at many frequencies."""
    largest = 0.0
    for one in wanted:
        grid = [one.band[0]] if one.band[0] == one.band[1] else np.linspace(*one.band, ratios)
        for part in np.array_split(np.array(grid), max(1, len(grid) // RATIOS)):
            narrow = Wanted(
                mode=one.mode, band=(part[0], part[-1]), limit=one.limit, order=one.order
            )
            rows = rows_of(narrow, amplitudes.size, sample_time_s)
            largest = max(largest, float(np.abs(rows @ amplitudes).max()) / one.limit)
    return largest


def least_of_level_0_or_1(
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    samples: int,
    *,
    slope: bool,
    band: tuple[float, float] | None = None,
) -> float:
    """Return what the best of all commands of up to so many samples leaves.

    Behind a drive whose steps add; with ``slope`` 5 % of the slope more, of a band the largest.
    """
    ratios = np.array([1.0, 1 + DIFFERENCE, 1 - DIFFERENCE])
    poles = mode.pole_rad_s * (ratios if band is None else np.linspace(*band, LISTED_RATIOS))
    gains = {
        up: np.array([gain_and_slope(actuator, pole, accel=up)[0] for pole in poles.tolist()])
        for up in (True, False)
    }
    units = np.abs(gains[True])
    best = math.inf
    for last in range(2, samples + 1):
        free = last - 2
        levels = np.ones((2**free, last + 1))
        levels[:, 1 : last - 1] = np.arange(2**free)[:, None] >> np.arange(free) & 1
        levels[:, last - 1] = 0
        steps = np.diff(levels, prepend=0, axis=1)
        turns = np.exp(-np.multiply.outer(np.arange(last + 1) * sample_time_s, poles))
        vectors = (steps > 0) @ (turns * gains[True]) - (steps < 0) @ (turns * gains[False])
        decays = np.exp(poles.real * last * sample_time_s)
        if band is None:
            left = np.abs(vectors[:, 0])
            if slope:
                left = left + ERROR * np.abs(vectors[:, 1] - vectors[:, 2]) / (2 * DIFFERENCE)
            left = left * decays[0] / units[0]
        else:
            left = (np.abs(vectors) * decays / units).max(axis=1)
        best = min(best, float(left.min()))
    return best
