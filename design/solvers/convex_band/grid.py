"""The structure of the fastest shaper over bands, by cone programs over grids of time and ratio.

How many impulses there are, and which peaks of the residual touch the tolerance. A shaper shorter
than D is one of duration D too: the problem of a longer duration contains that of a shorter one.
Time runs backwards, as in `optimality`.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from design.errors import SolverFailedError
from design.formulations.bands import BandProblem
from design.solvers import clarabel
from design.solvers.budget import Budget
from design.solvers.clarabel import ConeOutcome, ConeProgram
from design.solvers.convex_band.optimality import Point
from design.solvers.outcome import Status
from design.types import BoolArray, ComplexArray, FloatArray, IntArray

LAGS_PER_HALF_PERIOD = 12
RATIOS_PER_PEAK = 6
MIN_LAGS = 12
MIN_RATIOS = 9
"""Points of the even grids: for each half turn of the last impulse, and at least."""

REFINEMENT = 13
REACH = 1.5
REFINED_PITCHES = (1.0, 0.2, 0.04, 0.008)
"""Points added around each impulse and peak, how far to either side, in pitches of what length."""

DISTINCT = 1e-3
"""Share of the refined pitch that two points are apart at least [-]."""

PRESENT = 1e-3
"""Share of the largest amplitude below which the cone program's is none [-]."""

PRESENT_WEIGHT = 1e-5
"""The same of weights: damping makes peaks at high frequencies cheap, but not absent [-]."""

ROUGH_SHARES = (1e-3, 1e-5, 1e-7)
"""Share of the largest step below which one of a grid's own command is none: of the last alone,
where the command has limits that it would pass without them [-]."""

MAX_GRID_IMPULSES = 64
"""Impulses beyond which a structure is none but a command that dithers on the grid."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grid:
    """Where a cone program looks.

    Attributes
    ----------
    lags
        Ascending from 0 to the duration [rad].
    ratios
        Of each band, ascending over it [-].
    """

    lags: FloatArray
    ratios: tuple[FloatArray, ...]

    def poles_of(self, problem: BandProblem) -> ComplexArray:
        """Return the poles at all ratios, band after band, shape (k,) [-]."""
        return np.concatenate([
            band.unit_pole * ratios for band, ratios in zip(problem.bands, self.ratios, strict=True)
        ])


def even_grid(problem: BandProblem, duration_rad: float, fineness: int = 1) -> Grid:
    """Return a grid of even pitches.

    The pitches are fine against the turn of the last impulse.

    Parameters
    ----------
    problem
        The bands.
    duration_rad
        Last lag of the grid [rad].
    fineness
        How many times finer than usual both pitches are.

    Returns
    -------
    Grid
        Lags from 0 to the duration, ratios from one end of each band to the other.
    """
    half_turns = fineness * duration_rad / math.pi
    last = half_turns * max(abs(band.unit_pole) * band.upper for band in problem.bands)
    turns = [half_turns * abs(band.unit_pole) * band.width for band in problem.bands]
    return Grid(
        lags=np.linspace(0, duration_rad, MIN_LAGS + math.ceil(LAGS_PER_HALF_PERIOD * last)),
        ratios=tuple(
            np.linspace(band.lower, band.upper, MIN_RATIOS + math.ceil(RATIOS_PER_PEAK * turned))
            for band, turned in zip(problem.bands, turns, strict=True)
        ),
    )


def _refine(even: Grid, point: Point, share: float) -> Grid:
    """Add points around impulses and peaks, within a share of three even pitches."""
    around = np.linspace(-REACH, REACH, REFINEMENT)

    def add_points(evenly: FloatArray, places: FloatArray) -> FloatArray:
        pitch = share * (evenly[1] - evenly[0])
        near = np.clip(np.add.outer(places, pitch * around), evenly[0], evenly[-1])
        together = np.unique(np.concatenate((evenly, near.ravel())))
        kept: FloatArray = together[np.diff(together, prepend=-math.inf) > DISTINCT * pitch]
        kept[-1] = evenly[-1]
        return kept

    return Grid(
        lags=add_points(even.lags, point.lags),
        ratios=tuple(
            add_points(evenly, point.ratios[point.bands == band])
            for band, evenly in enumerate(even.ratios)
        ),
    )


def least_on_grid(problem: BandProblem, grid: Grid, budget: Budget) -> ConeOutcome:
    """Solve for the command on a grid with the least largest residual.

    Parameters
    ----------
    problem
        The bands, and whether the command has levels.
    grid
        Lags that end with the duration, and ratios at which residuals count.
    budget
        The work of the cone program is counted in it.

    Returns
    -------
    ConeOutcome
        The amplitudes at the lags, or the level between each lag and the next; ``largest`` is the
        largest residual on the grid [-].

    Raises
    ------
    SolverFailedError
        If Clarabel did not solve the cone program.
    """
    turned = np.exp(np.multiply.outer(grid.poles_of(problem), grid.lags))
    zeros = np.zeros(turned.shape[0], dtype=complex)
    if problem.levels is None:
        program = ConeProgram(
            offset=zeros, rows=turned, lowest=0.0, highest=math.inf, unit_sum=True
        )
    else:
        # Unknown is the command between two points of the grid: 0 before the first, 1 at last.
        program = ConeProgram(
            offset=zeros + 1,
            rows=np.diff(turned, axis=1),
            lowest=problem.levels[0],
            highest=problem.levels[1],
            unit_sum=False,
        )
    outcome = clarabel.solve(program)
    budget.spend(clarabel.work_of(program, outcome))
    if outcome.status is not Status.SOLVE_SUCCEEDED:
        raise SolverFailedError(
            f"clarabel ended with {outcome.status.value} on a band problem", code="clarabel_failed"
        )
    return outcome


def structure(problem: BandProblem, grid: Grid, found: ConeOutcome) -> Point | None:
    """Read impulses and touching peaks off the grid.

    Parameters
    ----------
    problem
        The bands that the cone program was of.
    grid
        The grid of the cone program.
    found
        What the cone program found.

    Returns
    -------
    Point or None
        A start for Newton's method; None where there is but one impulse, or two impulses coincide.
    """
    if problem.levels is None:
        lags, amplitudes = clusters(grid.lags, found.unknowns, PRESENT)
    else:
        lags, amplitudes = _switches(grid.lags, found.unknowns, problem.levels)
    if lags.size < 2 or np.diff(lags).min() <= 0:  # noqa: PLR2004
        return None
    lags[0], lags[-1] = 0.0, grid.lags[-1]
    bands, ratios, inner, weights = _touching(grid, found.weights)
    return Point(
        lags=lags,
        amplitudes=amplitudes / amplitudes.sum(),
        bands=bands,
        ratios=ratios,
        inner=inner,
        weights=weights / weights.sum(),
    )


def _touching(
    grid: Grid, weights: FloatArray
) -> tuple[IntArray, FloatArray, BoolArray, FloatArray]:
    """Return numbers of bands, ratios, whether they are inner, and weights of what touches."""
    of_bands = np.split(weights, np.cumsum([ratios.size for ratios in grid.ratios])[:-1])
    least = PRESENT_WEIGHT * weights.max()
    bands, places, inner, sums = [], [], [], []
    for number, (ratios, own) in enumerate(zip(grid.ratios, of_bands, strict=True)):
        if own.max() <= least:
            continue
        centres, heights = clusters(ratios, own, least / own.max())
        # A peak so near the edge that the grid cannot tell the two apart sits on the edge.
        low_edge = centres < ratios[:2].mean()
        high_edge = centres > ratios[-2:].mean()
        centres[low_edge], centres[high_edge] = ratios[0], ratios[-1]
        bands.append(np.full(centres.size, number))
        places.append(centres)
        inner.append(~(low_edge | high_edge))
        sums.append(heights)
    return (
        np.concatenate(bands),
        np.concatenate(places),
        np.concatenate(inner),
        np.concatenate(sums),
    )


def clusters(
    places: FloatArray, weights: FloatArray, present: float
) -> tuple[FloatArray, FloatArray]:
    """Join neighbours that have weight.

    Parameters
    ----------
    places, weights
        Where they are, ascending, and their weights, shape (n,).
    present
        Share of the largest weight below which one is none [-].

    Returns
    -------
    tuple of FloatArray
        Centres and sums of the groups.
    """
    weights = np.where(weights > present * weights.max(), weights, 0.0)
    group = np.cumsum(np.diff(weights > 0, prepend=False) & (weights > 0)) - 1
    kept = weights > 0
    sums: FloatArray = np.bincount(group[kept], weights[kept]).astype(float)
    centres = np.bincount(group[kept], (weights * places)[kept]) / sums
    return centres, sums


def _switches(
    edges: FloatArray, levels: FloatArray, limits: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Read the switches of a command between two levels off its cells, areas kept."""
    lowest, highest = limits
    share = (levels - lowest) / (highest - lowest)
    high = share > 0.5  # noqa: PLR2004 - nearer to the upper level
    changes = np.flatnonzero(high[1:] != high[:-1])
    lags = edges[changes + 1].copy()
    if changes.size:
        nearest = np.abs(np.arange(levels.size)[:, None] - changes - 0.5).argmin(axis=1)
        areas = (share - high) * np.diff(edges)
        left_over = np.bincount(nearest, areas, minlength=changes.size)
        lags += np.where(high[changes], left_over, -left_over)
    command = np.where(np.append(high[changes], high[-1]), highest, lowest)
    around = np.concatenate(([1.0], command, [0.0]))
    return np.concatenate(([0.0], lags, [edges[-1]])), around[:-1] - around[1:]


def closer_look(
    problem: BandProblem, duration_rad: float, budget: Budget
) -> tuple[Grid, ConeOutcome]:
    """Solve a duration on a grid refined around impulses and peaks.

    An even grid comes first. Each finer grid has points around the impulses and peaks that the grid
    before shows. Refinement ends early where a grid shows one impulse only, or more than
    `MAX_GRID_IMPULSES`.

    Parameters
    ----------
    problem
        The bands.
    duration_rad
        The duration [rad].
    budget
        The work of the cone programs is counted in it.

    Returns
    -------
    tuple of Grid and ConeOutcome
        The last grid, and what its cone program found.

    Raises
    ------
    SolverFailedError
        If Clarabel did not solve a cone program.
    """
    even = grid = even_grid(problem, duration_rad)
    found = least_on_grid(problem, grid, budget)
    for share in REFINED_PITCHES:
        start = structure(problem, grid, found)
        if start is None or start.lags.size > MAX_GRID_IMPULSES:
            break
        grid = _refine(even, start, share)
        found = least_on_grid(problem, grid, budget)
    return grid, found


def commands_of(problem: BandProblem, grid: Grid, budget: Budget) -> Iterator[Point]:
    """Yield the commands of a grid's own cells or points.

    Later commands keep smaller steps of the grid's command. A command that has levels comes once.

    Parameters
    ----------
    problem
        The bands.
    grid
        Lags that end with the duration, and ratios at which residuals count.
    budget
        The work of the cone program is counted in it.

    Yields
    ------
    Point
        Impulses that sum to 1, without peaks.

    Raises
    ------
    SolverFailedError
        If Clarabel did not solve the cone program.
    """
    found = least_on_grid(problem, grid, budget)
    if problem.levels is None:
        steps = np.maximum(found.unknowns, 0.0)
    else:
        steps = -np.diff(np.concatenate(([1.0], np.clip(found.unknowns, *problem.levels), [0])))
    for share in ROUGH_SHARES if problem.levels is None else ROUGH_SHARES[-1:]:
        held = np.abs(steps) > share * np.abs(steps).max()
        yield Point(
            lags=grid.lags[held] - grid.lags[held][0],
            amplitudes=steps[held] / steps[held].sum(),
            bands=np.zeros(0, dtype=np.intp),
            ratios=np.zeros(0),
            inner=np.zeros(0, dtype=np.bool_),
            weights=np.zeros(0),
        )
