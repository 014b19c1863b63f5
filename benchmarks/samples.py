"""Designs on the samples of a controller beside dense linear programs and plain listing.

The first peer is what one writes for amplitudes: on each number of samples in turn the least peak
on 41 frequencies, circles as 24-sided polygons, until the tolerance is met. The second is what one
writes for unity magnitude: all commands of level 0 or 1 in an array. Neither looks between its
frequencies, at the drive, or at what comes next.
"""

import functools
import math
import time
from collections.abc import Callable, Iterator
from statistics import median

import numpy as np

from benchmarks.measure import Figure, alternating_medians, ratio
from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.sampling.on_grid import SampleGrid, design_on_grid
from design.shapers.registry import SHAPERS

TOLERANCE, HALF_WIDTH = 0.05, 0.15
RATIOS, SIDES = 41, 24
FIRST_SAMPLES = 3
LEFT = 0.0031
"""Residual that unity magnitude may leave on samples [-]."""

BANDS = {"180 Hz, 1 ms": (180.0, 0.05, 1e-3), "11 Hz, 8 ms": (11.0, 0.03, 8e-3)}
"""Natural frequency [Hz], damping ratio [-] and sample time [s]."""

UNITY = (60.0, 0.08, 2e-3)


def mode_of(frequency_hz: float, damping_ratio: float) -> Mode:
    """Return a mode of a frequency in hertz."""
    return Mode(natural_frequency_rad_s=2 * math.pi * frequency_hz, damping_ratio=damping_ratio)


def design_length(
    kind: str, plant: tuple[float, float, float], tolerance: float = TOLERANCE
) -> int:
    """Return how many samples a design takes."""
    mode, sample_time_s = mode_of(*plant[:2]), plant[2]
    grid = SampleGrid(sample_time_s=sample_time_s, sample_tolerance=tolerance)
    found = design_on_grid(mode, Ideal(), SHAPERS[kind], SHAPERS[kind].options(), grid)
    return round(found.impulses.duration_s / sample_time_s) + 1


def length_by_programs(plant: tuple[float, float, float]) -> int:
    """Return the first number of samples on which a dense program keeps the tolerance."""
    from scipy.optimize import linprog

    mode, sample_time_s = mode_of(*plant[:2]), plant[2]
    poles = mode.pole_rad_s * np.linspace(1 - HALF_WIDTH, 1 + HALF_WIDTH, RATIOS)
    turns = np.exp(2j * np.pi * np.arange(SIDES) / SIDES)
    samples = FIRST_SAMPLES
    while True:
        rows = np.exp(np.multiply.outer(poles, sample_time_s * np.arange(samples)[::-1]))
        sides = np.concatenate([(turn * rows).real for turn in turns])
        found = linprog(
            np.append(np.zeros(samples), 1.0),
            A_ub=np.hstack((sides, -np.ones((len(sides), 1)))),
            b_ub=np.zeros(len(sides)),
            A_eq=np.append(np.ones(samples), 0.0)[None],
            b_eq=np.ones(1),
            bounds=(0, None),
        )
        if found.fun <= TOLERANCE:
            return samples
        samples += 1


def length_by_listing(plant: tuple[float, float, float]) -> int:
    """Return the first number of samples on which some command of level 0 or 1 leaves little."""
    mode, sample_time_s = mode_of(*plant[:2]), plant[2]
    last = 2
    while True:
        free = last - 2
        levels = np.ones((2**free, last + 1))
        levels[:, 1 : last - 1] = np.arange(2**free)[:, None] >> np.arange(free) & 1
        levels[:, last - 1] = 0
        turns = np.exp(mode.pole_rad_s * sample_time_s * np.arange(last + 1)[::-1])
        if np.abs(np.diff(levels, prepend=0, axis=1) @ turns).min() <= LEFT:
            return last + 1
        last += 1


def figures() -> Iterator[Figure]:
    """Measure."""
    cases: list[tuple[str, Callable[[], int], Callable[[], int], int]] = [
        (
            f"`si` on samples, {name}, bound and certificate / dense programs, nothing proven",
            functools.partial(design_length, "si", plant),
            functools.partial(length_by_programs, plant),
            5,
        )
        for name, plant in BANDS.items()
    ]
    cases.append((
        "`umzv` on samples, 60 Hz, 2 ms, shortest within 0.31 % / listing of all",
        functools.partial(design_length, "umzv", UNITY, LEFT),
        functools.partial(length_by_listing, UNITY),
        1,
    ))
    for what, ours, peer, calls in cases:
        seconds = alternating_medians(
            {"ours": ours, "peer": peer}, rounds=5, calls=calls, clock=time.process_time
        )
        beside = ratio(seconds, "ours", "peer")
        took = {one: 1e3 * median(values) for one, values in seconds.items()}
        yield Figure(
            what=what,
            value=f"{beside:.2f} ({took['ours']:.1f} / {took['peer']:.1f} "
            f"ms, {ours()} / {peer()} samples)",
            limit="<= 1",
            met=beside <= 1,
            over_peer=beside,
        )
