"""Designs behind limits to acceleration beside a plain bisection by linear programs.

The peer is what one writes in an afternoon: is there a course on a grid that ends by then? Its grid
is as fine as the first one of the search here; it ends at a thousandth, and proves nothing.
"""

import functools
import math
import time
from collections.abc import Callable, Iterator
from statistics import median

import numpy as np

from benchmarks.measure import Figure, alternating_medians, ratio
from design.analysis.ramp_figures import end_of_reference
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.recommendations.recommendation import recommend
from design.recommendations.requirements import Requirements
from design.shapers.registry import SHAPERS
from design.solvers.ramps.structure import CELLS_PER_TURN, MIN_CELLS

CRANE = Pendulum(cable_length_m=9.0, gravity_m_s2=9.81)
DRIVE = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0)
SHORT_M = 0.3
PRECISION = 1e-3
"""Share of the end at which the bisection stops [-]."""


def is_possible(end_s: float, derivatives: int, travel_s: float | None) -> bool:
    """Return whether a course on the grid ends by then: from 0 to 1, or over a distance back."""
    from scipy.optimize import linprog

    w = CRANE.mode.natural_frequency_rad_s
    cells = max(MIN_CELLS, math.ceil(CELLS_PER_TURN * end_s / CRANE.mode.period_s))
    edges = np.linspace(0, end_s, cells + 1)
    width, middles = end_s / cells, (edges[1:] + edges[:-1]) / 2
    turns = np.exp(-1j * w * middles) * np.sinc(w * width / (2 * math.pi))
    rows = [turns.real, turns.imag]
    if derivatives:
        rows += [middles * turns.real, middles * turns.imag]
    sides = [0.0] * len(rows)
    rows.append(np.ones(cells))
    sides.append(1.0 if travel_s is None else 0.0)
    if travel_s is not None:
        rows.append(end_s - middles)
        sides.append(travel_s)
    levels = np.tril(np.ones((cells, cells)))
    up, down = (width / ramp_s for ramp_s in DRIVE.unit_ramps_s)
    found = linprog(
        np.zeros(cells),
        A_ub=np.vstack((levels, -levels)),
        b_ub=np.concatenate((np.ones(cells), np.zeros(cells))),
        A_eq=np.array(rows),
        b_eq=sides,
        bounds=(-down, up),
        method="highs",
    )
    return bool(found.status == 0)


def bisection(derivatives: int, travel_s: float | None = None) -> float:
    """Return the earliest end on the grid."""
    low, high = 0.0, 3 * CRANE.mode.period_s
    while high - low > PRECISION * high:
        middle = (low + high) / 2
        if is_possible(middle, derivatives, travel_s):
            high = middle
        else:
            low = middle
    return high


def design_end(kind: str) -> float:
    """Return when the last ramp of a design ends."""
    return end_of_reference(design(CRANE, DRIVE, SHAPERS[kind]).impulses, DRIVE)


def move_end() -> float:
    """Return when the last ramp of a short move ends."""
    move = maneuver(CRANE, DRIVE, SHAPERS["numzvd"], speed_m_s=1.0, distance_m=SHORT_M)
    return end_of_reference(move.command, DRIVE)


def figures() -> Iterator[Figure]:
    """Measure."""
    cases: tuple[tuple[str, Callable[[], float], Callable[[], float]], ...] = (
        ("`numzv`", functools.partial(design_end, "numzv"), functools.partial(bisection, 0)),
        ("`numzvd`", functools.partial(design_end, "numzvd"), functools.partial(bisection, 1)),
        ("move of 0.3 m by `numzvd`", move_end, functools.partial(bisection, 1, SHORT_M)),
    )
    for name, ours, peer in cases:
        seconds = alternating_medians(
            {"ours": ours, "peer": peer}, rounds=5, calls=2, clock=time.process_time
        )
        took = {one: 1e3 * median(values) for one, values in seconds.items()}
        yield Figure(
            what=f"{name} behind limits, bound and certificate / bisection by HiGHS on a grid, "
            "nothing proven",
            value=f"{ratio(seconds, 'ours', 'peer'):.3f} ({took['ours']:.1f} / {took['peer']:.0f} "
            f"ms, last ramp ends {ours():.4f} / {peer():.4f} s)",
            limit="<= 0.5",
            met=ratio(seconds, "ours", "peer") <= 0.5,
            over_peer=ratio(seconds, "ours", "peer"),
        )
    seconds = alternating_medians(
        {
            "recommendation": lambda: recommend(CRANE, DRIVE, Requirements()),
            "bisection": lambda: bisection(1),
        },
        rounds=3,
        calls=1,
        clock=time.process_time,
    )
    yield Figure(
        what="recommendation behind limits, every kind / one bisection for `numzvd`",
        value=f"{ratio(seconds, 'recommendation', 'bisection'):.1f} "
        f"({1e3 * median(seconds['recommendation']):.0f} ms)",
        limit="",
        met=None,
    )
