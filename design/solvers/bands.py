"""The fastest shaper that keeps a band of frequencies within a tolerance, with proof of how fast.

A cone program over a time grid (`clarabel`) finds the structure: how many impulses, which peaks of
the residual touch the tolerance. Newton's method on the conditions of optimality then moves times,
amplitudes and peaks where they belong, off the grid.

Time runs backwards here, from the last impulse: ``u = t_n - t``, so that what rings after the last
impulse is ``F(r) = sum A_i exp(s(r) u_i)``, ``s(r) = r (-z + j sqrt(1 - z^2))``. A shaper shorter
than D is one of duration D too: the problem of a longer duration contains that of a shorter one.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.errors import InfeasibleDesignError, SolverFailedError
from design.shapers.problem import BandProblem, Obstacle
from design.solvers import clarabel
from design.solvers.clarabel import ConeOutcome, ConeProgram
from design.solvers.outcome import Status
from design.types import BoolArray, ComplexArray, FloatArray

LAGS_A_HALF_PERIOD = 12
RATIOS_A_PEAK = 6
FEWEST_LAGS = 12
FEWEST_RATIOS = 9
"""Points of the even grids: for each half turn of the last impulse, and at least."""

REFINEMENT = 13
REACH = 1.5
REFINED_PITCHES = (1.0, 0.2, 0.04, 0.008)
"""Points added around each impulse and peak, how far to either side, in pitches of what length."""

DISTINCT = 1e-3
"""Share of the refined pitch that two points are apart at least [-]."""

CLOSE_DURATION = 1e-6
"""Relative width of the bracket around the duration at which the search ends [-]."""

KEPT_INSIDE = 0.1
"""Share of the bracket that is left on either side of the next duration [-]."""

EVEN_ONLY = 4
"""Durations tried on even grids before those are refined."""

COARSE = 0.03
"""Relative error of durations by which even grids bracket the one that is looked for [-]."""

MOST_HALF_PERIODS = 26.0
"""Half periods of a shaper, and so about its impulses, up to which cone programs are solved [-]."""

MOST_WORK = 4e6
"""Entries of the cone programs, in all, after which the structure is not looked for further."""

MOST_SEEN = 64
"""Impulses beyond which a structure is none but a command that dithers on the grid."""

ROUGH = (1e-3, 3e-3, 0.01, 0.03, 0.1)
ROUGH_FINENESS = 2
ROUGH_SHARES = (1e-3, 1e-5, 1e-7)
"""How much longer than the shortest a command of the grid's own cells may be, the grid how many
times finer, and share of the largest step below which one is none: of the last alone, where the
command has limits that it would pass without them [-]."""

MOST_DURATIONS = 12
"""Durations tried in all."""

AWAY = (0.005, -0.005, 0.02, -0.02)
"""How far from the duration found the structure is looked at if none led to it [-]."""

SHORTEST_FOLLOWED = 1e-5
"""Relative step of the tolerance below which an optimum cannot be followed on [-]."""

SHORTENED = (0.003, 0.01, 0.03, 0.1)
"""By how much a duration is shortened where only a cone program can tell that it is short [-]."""

PRESENT = 1e-3
"""Share of the largest amplitude below which the cone program's is none [-]."""

PRESENT_WEIGHT = 1e-5
"""The same of weights: damping makes peaks at high frequencies cheap, but not absent [-]."""

MOST_STEPS = 30
CONVERGED = 1e-12
"""Change of times and amplitudes at which Newton's method is done [rad, -]."""

MOST_EXCHANGES = 8
"""How often peaks are exchanged before the grid is refined."""

DESIGN_MARGIN = 1e-10
"""Peaks are put this far below the tolerance, so that rounding lifts none above it [-]."""

ABOVE = 1e-11
"""Excess over the tolerance at which a peak counts as above: below the margin [-]."""

EASED = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
"""By how much the tolerance is eased for a duration that is just too short, least first [-]."""

SCAN_TURN_RAD = math.pi / 16
"""Turn of the last impulse between two points of the search for peaks [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandCandidate:
    """An optimum by the solver's word, not yet verified.

    Attributes
    ----------
    times_rad
        Times of the impulses, shape (n,) [rad].
    amplitudes
        Their amplitudes, shape (n,) [-].
    iterations
        Steps of Newton's method.
    cone_programs
        Cone programs solved until then.
    point
        What it is an optimum by; None for one of a grid's own steps.
    """

    times_rad: FloatArray
    amplitudes: FloatArray
    iterations: int
    cone_programs: int
    point: "_Point | None"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Point:
    """Impulses and touching peaks.

    Attributes
    ----------
    lags
        ``u_i``, ascending from 0 to the duration, shape (n,) [rad].
    amplitudes
        shape (n,) [-].
    ratios
        Frequency ratios of the peaks, ascending, shape (m,) [-].
    inner
        Which of them lie inside the band and may move, shape (m,).
    weights
        Cost of each, shape (m,), sum 1 [-].
    """

    lags: FloatArray
    amplitudes: FloatArray
    ratios: FloatArray
    inner: BoolArray
    weights: FloatArray
    steps: int = 0


# ---------------------------------------------------------------- structure


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Grid:
    """Where a cone program looks.

    Attributes
    ----------
    lags
        Ascending from 0 to the duration [rad].
    ratios
        Ascending over the band [-].
    """

    lags: FloatArray
    ratios: FloatArray


def _even_grid(problem: BandProblem, duration_rad: float, fineness: int = 1) -> _Grid:
    lower, upper = problem.band
    turns = fineness * (upper - lower) * duration_rad / math.pi
    last = fineness * duration_rad / math.pi * upper
    return _Grid(
        lags=np.linspace(0, duration_rad, FEWEST_LAGS + math.ceil(LAGS_A_HALF_PERIOD * last)),
        ratios=np.linspace(lower, upper, FEWEST_RATIOS + math.ceil(RATIOS_A_PEAK * turns)),
    )


def _refined(even: _Grid, point: _Point, share: float) -> _Grid:
    """Add points around impulses and peaks, within a share of three even pitches."""
    around = np.linspace(-REACH, REACH, REFINEMENT)

    def added(evenly: FloatArray, places: FloatArray) -> FloatArray:
        pitch = share * (evenly[1] - evenly[0])
        near = np.clip(np.add.outer(places, pitch * around), evenly[0], evenly[-1])
        together = np.unique(np.concatenate((evenly, near.ravel())))
        kept: FloatArray = together[np.diff(together, prepend=-math.inf) > DISTINCT * pitch]
        kept[-1] = evenly[-1]
        return kept

    return _Grid(lags=added(even.lags, point.lags), ratios=added(even.ratios, point.ratios))


def _least_residual(problem: BandProblem, grid: _Grid) -> ConeOutcome:
    """Return the least largest residual over the band of commands of one duration, on a grid."""
    turned = np.exp(np.multiply.outer(problem.unit_pole * grid.ratios, grid.lags))
    zeros = np.zeros(grid.ratios.size, dtype=complex)
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
    if outcome.status is not Status.SOLVE_SUCCEEDED:
        raise SolverFailedError(f"clarabel ended with {outcome.status.value} on a band problem")
    return outcome


def _ripples(residual: float) -> float:
    """Turn a residual into what grows about evenly with the duration, as Chebyshev's windows do."""
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
    return _ripples(problem.tolerance) / edge


def require_solvable(problem: BandProblem) -> None:
    """Raise InfeasibleDesignError where a shaper has more impulses than can be solved for."""
    half_periods = _half_periods(problem)
    if half_periods > MOST_HALF_PERIODS:
        lower, upper = problem.band
        tolerance = 1 / math.cosh(MOST_HALF_PERIODS / half_periods * _ripples(problem.tolerance))
        raise InfeasibleDesignError(
            f"a residual within {problem.tolerance:g} from {lower:g} to {upper:g} of the natural "
            f"frequency takes about {half_periods:.3g} half periods of its middle and an impulse "
            f"in each; at most {MOST_HALF_PERIODS:g} are solved for: narrow the band, or allow a "
            f"tolerance of {1.01 * tolerance:.4g}"
        )


def _structure(problem: BandProblem, grid: _Grid, found: ConeOutcome) -> _Point | None:
    """Read impulses and touching peaks off the grid; None where there is but one impulse."""
    if problem.levels is None:
        lags, amplitudes = _clusters(grid.lags, found.unknowns, PRESENT)
    else:
        lags, amplitudes = _switches(grid.lags, found.unknowns, problem.levels)
    if lags.size < 2 or np.diff(lags).min() <= 0:  # noqa: PLR2004
        return None
    lags[0], lags[-1] = 0.0, grid.lags[-1]
    ratios, weights = _clusters(grid.ratios, found.weights, PRESENT_WEIGHT)
    # A peak so near the edge that the grid cannot tell the two apart sits on the edge.
    low_edge = ratios < grid.ratios[:2].mean()
    high_edge = ratios > grid.ratios[-2:].mean()
    ratios[low_edge], ratios[high_edge] = grid.ratios[0], grid.ratios[-1]
    return _Point(
        lags=lags,
        amplitudes=amplitudes / amplitudes.sum(),
        ratios=ratios,
        inner=~(low_edge | high_edge),
        weights=weights / weights.sum(),
    )


def _clusters(
    places: FloatArray, weights: FloatArray, present: float
) -> tuple[FloatArray, FloatArray]:
    """Join neighbours that have weight: centres and sums, at least two of them."""
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


# ---------------------------------------------------------------- Newton's method


# Where it diverges, numbers overflow: what is not finite then ends it.
@np.errstate(over="ignore", invalid="ignore")
def _newton(problem: BandProblem, point: _Point, tolerance: float) -> _Point | None:
    """Solve the conditions of optimality from a point near by; None where that fails.

    Unknown are the lags but the first, the amplitudes where they are free, the ratios of the inner
    peaks and the weights. With ``e_ki = exp(s_k u_i) / F_k``::

        ln |F_k| = ln V                                 every peak touches
        Re(e_k' of r) = 0                               and is a peak, or sits on the band's edge
        Re(sum_k weight_k s_k e_ki) = 0                 no inner impulse gains by moving
        Re(sum_k weight_k e_ki) = 1,  sum A = 1         none by growing: free amplitudes
        sum weight = 1                                  a scale: fixed amplitudes
    """
    sigma, free = problem.unit_pole, problem.levels is None
    lags, amplitudes = point.lags.copy(), point.amplitudes.copy()
    ratios, weights = point.ratios.copy(), point.weights.copy()
    inner = np.flatnonzero(point.inner)
    n, m, p = lags.size, ratios.size, inner.size
    amount = n if free else 0
    # Columns: lags 1.., amplitudes, inner ratios, weights. Rows: in the order above.
    columns = n - 1 + amount + p + m
    at_amplitudes, at_ratios, at_weights = n - 1, n - 1 + amount, n - 1 + amount + p
    if m + p + (n - 2) + (n + 1 if free else 1) != columns:
        return None
    lower, upper = problem.band
    for step in range(MOST_STEPS):
        poles = sigma * ratios
        turned = np.exp(np.multiply.outer(poles, lags))
        vector = turned @ amplitudes
        if not np.abs(vector).min() > 0:
            return None
        e = turned / vector[:, None]
        d = poles[:, None] * e
        to_lag = amplitudes * d
        weighted_lags = amplitudes * lags
        rho = sigma * (e @ weighted_lags)
        rho2 = sigma**2 * (e @ (weighted_lags * lags))
        drift = sigma * lags - rho[:, None]

        jacobian = np.zeros((columns, columns))
        value = np.empty(columns)
        # every peak touches
        value[:m] = np.log(np.abs(vector)) - math.log(tolerance)
        jacobian[:m, : n - 1] = to_lag[:, 1:].real
        if free:
            jacobian[:m, at_amplitudes:at_ratios] = e.real
        jacobian[inner, at_ratios + np.arange(p)] = rho[inner].real
        # and is a peak
        rows = slice(m, m + p)
        value[rows] = rho[inner].real
        by_lag = amplitudes * (sigma * e + drift * d)
        jacobian[rows, : n - 1] = by_lag[inner, 1:].real
        if free:
            jacobian[rows, at_amplitudes:at_ratios] = (e * drift)[inner].real
        jacobian[m + np.arange(p), at_ratios + np.arange(p)] = (rho2 - rho**2)[inner].real
        # no inner impulse gains by moving
        rows = slice(m + p, m + p + n - 2)
        weighted = weights @ d
        value[rows] = weighted.real[1:-1]
        bent = -(weights[:, None] * d).T @ to_lag
        bent[np.diag_indices(n)] += weights @ (poles[:, None] * d)
        jacobian[rows, : n - 1] = bent[1:-1, 1:].real
        if free:
            jacobian[rows, at_amplitudes:at_ratios] = -((weights[:, None] * d).T @ e)[1:-1].real
        turning = weights[:, None] * (sigma * e + d * drift)
        jacobian[rows, at_ratios:at_weights] = turning[inner, 1:-1].real.T
        jacobian[rows, at_weights:] = d[:, 1:-1].real.T
        if free:
            rows = slice(m + p + n - 2, m + p + 2 * n - 2)
            value[rows] = (weights @ e).real - 1
            jacobian[rows, : n - 1] = -((weights[:, None] * e).T @ to_lag)[:, 1:].real
            jacobian[rows, : n - 1][np.arange(1, n), np.arange(n - 1)] += weighted.real[1:]
            jacobian[rows, at_amplitudes:at_ratios] = -((weights[:, None] * e).T @ e).real
            jacobian[rows, at_ratios:at_weights] = (weights[:, None] * e * drift)[inner].real.T
            jacobian[rows, at_weights:] = e.real.T
            value[-1] = amplitudes.sum() - 1
            jacobian[-1, at_amplitudes:at_ratios] = 1.0
        else:
            value[-1] = weights.sum() - 1
            jacobian[-1, at_weights:] = 1.0
        try:
            change = np.linalg.solve(jacobian, -value)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(change).all():
            return None
        lag_change = np.concatenate(([0.0], change[: n - 1]))
        # Impulses keep their order: no gap more than halves.
        shrink = -np.diff(lag_change) / np.diff(lags)
        scale = min(1.0, 0.5 / max(float(shrink.max()), 1e-9))
        if p:
            reach = float(np.abs(change[at_ratios:at_weights]).max())
            scale = min(scale, 0.25 * (upper - lower) / max(reach, 1e-9))
        change *= scale
        lags += scale * lag_change
        if free:
            amplitudes += change[at_amplitudes:at_ratios]
        ratios[inner] += change[at_ratios:at_weights]
        weights += change[at_weights:]
        if lags[-1] > 2 * point.lags[-1]:
            return None
        if scale == 1 and np.abs(change[:at_weights]).max() < CONVERGED * max(1.0, lags[-1]):
            return _Point(
                lags=lags,
                amplitudes=amplitudes,
                ratios=ratios,
                inner=point.inner,
                weights=weights,
                steps=point.steps + step + 1,
            )
    return None


# ---------------------------------------------------------------- exchange


def _peaks(problem: BandProblem, point: _Point) -> tuple[FloatArray, FloatArray]:
    """Return the local maxima of the residual over the band, edges included, refined."""
    lower, upper = problem.band
    turn = (upper - lower) * float(point.lags[-1])
    grid = np.linspace(lower, upper, 9 + math.ceil(turn / SCAN_TURN_RAD))
    values = _residuals(problem, point, grid)
    left = np.concatenate(([-math.inf], values[:-1]))
    right = np.concatenate((values[1:], [-math.inf]))
    tops = np.flatnonzero((values >= left) & (values >= right))
    ratios = grid[tops]
    moving = (tops > 0) & (tops < grid.size - 1)
    pitch = grid[1] - grid[0]
    # A peak may lie between an edge and its neighbour: it does if the residual rises inward.
    inward = np.array([grid[0], grid[-1]])
    slopes = _growth(problem, point, inward)[0] * np.array([1, -1])
    hidden = inward[slopes > 0] + np.array([0.5, -0.5])[slopes > 0] * pitch
    ratios, moving = np.append(ratios, hidden), np.append(moving, np.full(hidden.size, True))
    for _ in range(4):  # Newton's method on the slope: four steps from a fine grid are enough
        slope, bend = _growth(problem, point, ratios)
        step = np.where(moving & (bend < 0), -slope / np.where(bend < 0, bend, 1.0), 0.0)
        ratios = np.clip(ratios + np.clip(step, -pitch, pitch), lower, upper)
    return ratios, _residuals(problem, point, ratios)


def _growth(
    problem: BandProblem, point: _Point, ratios: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the first and second derivative of ln |F| in the ratio."""
    turned = np.exp(np.multiply.outer(problem.unit_pole * ratios, point.lags)) * point.amplitudes
    vector = turned.sum(axis=1)
    rho = problem.unit_pole * (turned @ point.lags) / vector
    rho2 = problem.unit_pole**2 * (turned @ point.lags**2) / vector
    return rho.real, (rho2 - rho**2).real


def _residuals(problem: BandProblem, point: _Point, ratios: FloatArray) -> FloatArray:
    turned: ComplexArray = np.exp(np.multiply.outer(problem.unit_pole * ratios, point.lags))
    return np.abs(turned @ point.amplitudes)


def _optimum(problem: BandProblem, point: _Point, tolerance: float) -> _Point | None:
    """Exchange peaks until none is above the tolerance and none is held that is not needed."""
    lower, upper = problem.band
    for _ in range(MOST_EXCHANGES):
        found = _newton(problem, point, tolerance)
        if found is None:
            return None
        kept = found.weights > 0
        outside = found.inner & ((found.ratios <= lower) | (found.ratios >= upper))
        ratios, values = _peaks(problem, found)
        above = values > tolerance * (1 + ABOVE)
        if kept.all() and not outside.any() and not above.any():
            return found if (problem.levels or found.amplitudes.min() > 0) else None
        if outside.any():
            ratios_held = np.clip(found.ratios, lower, upper)
            inner = found.inner & ~outside
        else:
            ratios_held, inner = found.ratios, found.inner
        held, free_to_move, weights = ratios_held[kept], inner[kept], found.weights[kept]
        pitch = (upper - lower) / 50
        for ratio in ratios[above].tolist():
            at_edge = ratio in {lower, upper}
            near = np.flatnonzero(np.abs(held - ratio) < pitch)
            if near.size:
                held[near[0]] = ratio
                free_to_move[near[0]] = not at_edge
            else:
                held = np.append(held, ratio)
                free_to_move = np.append(free_to_move, not at_edge)
                weights = np.append(weights, PRESENT)
        order = np.argsort(held)
        point = replace(
            found,
            ratios=held[order],
            inner=free_to_move[order],
            weights=weights[order] / weights.sum(),
        )
    return None


def _followed(
    problem: BandProblem, point: _Point, from_tolerance: float, tolerance: float
) -> tuple[_Point, float] | None:
    """Follow an optimum from the tolerance that its duration allows towards the one asked.

    Returns the last optimum and its tolerance: another than asked where impulses or peaks merge.
    """
    now = _optimum(problem, point, from_tolerance)
    if now is None:
        return None
    level, target = math.log(from_tolerance), math.log(tolerance)
    step = target - level
    while level != target and abs(step) >= SHORTEST_FOLLOWED:
        aim = target if abs(target - level) <= abs(step) else level + step
        further = _optimum(problem, now, math.exp(aim))
        if further is None:
            step /= 2
        else:
            now, level = further, aim
            step *= 2
    return now, math.exp(level)


# ---------------------------------------------------------------- the whole


def candidates(problem: BandProblem) -> Iterator[BandCandidate | Obstacle]:
    """Yield optima, the likeliest first, and proofs met on the way; those further on take longer.

    Where impulses or peaks merge at the optimum itself, what comes from longer durations ends
    just before it, a shaper all the same, and what comes from shorter ones is a proof. Where no
    structure is found, as none is to be seen on a grid where a command may as well be between its
    limits, the steps of a grid make a shaper that is a little longer.

    Raises
    ------
    SolverFailedError
        If a cone program was not solved.
    """
    tolerance = problem.tolerance * (1 - DESIGN_MARGIN)
    duration, low, high = first_duration_rad(problem), 0.0, math.inf
    before: tuple[float, float] | None = None
    programs, work, met = 0, 0.0, False
    refine = False
    for attempt in range(MOST_DURATIONS):
        if attempt >= EVEN_ONLY and not refine:
            # What even grids say of a duration is off by what they miss.
            refine, low, high = True, low * (1 - COARSE), high * (1 + COARSE)
        programs += 1 + refine * len(REFINED_PITCHES)
        work += _work(problem, duration, refine=refine)
        least, best = _nearest(problem, duration, refine=refine, follow=refine)
        if best is not None:
            told = _told(problem, *best, programs)
            met = met or isinstance(told, BandCandidate)
            yield told
        if least > tolerance:
            low = max(low, duration)
        else:
            high = min(high, duration)
        now = (duration, _ripples(least))
        duration = _next_duration(before, now, _ripples(tolerance), low, high)
        if best is not None and not refine:
            # No optimum after all, for an impulse that the grid did not show: a closer look there.
            duration, refine = float(best[0].lags[-1]), True
        if high - low < CLOSE_DURATION * low or work > MOST_WORK:
            break
        before = now
    for share in AWAY:
        if work > MOST_WORK:
            break
        programs += 1 + len(REFINED_PITCHES)
        work += _work(problem, duration, refine=True)
        _, best = _nearest(problem, duration * (1 + share), refine=True, follow=True)
        if best is not None:
            told = _told(problem, *best, programs)
            met = met or isinstance(told, BandCandidate)
            yield told
    if not met:
        yield from _of_the_grid(problem, duration, programs)


def _work(problem: BandProblem, duration_rad: float, *, refine: bool) -> float:
    grid = _even_grid(problem, duration_rad)
    return grid.lags.size * grid.ratios.size * (1 + 4 * refine * len(REFINED_PITCHES))


def _of_the_grid(
    problem: BandProblem, duration_rad: float, programs: int
) -> Iterator[BandCandidate]:
    """Yield the command of a grid's own cells or points at the first duration that allows one."""
    for longer in ROUGH:
        duration = duration_rad * (1 + longer)
        grid = _even_grid(problem, duration, ROUGH_FINENESS)
        found = _least_residual(problem, grid)
        programs += 1
        if problem.levels is None:
            steps = np.maximum(found.unknowns, 0.0)
        else:
            steps = -np.diff(np.concatenate(([1.0], np.clip(found.unknowns, *problem.levels), [0])))
        for share in ROUGH_SHARES if problem.levels is None else ROUGH_SHARES[-1:]:
            held = np.abs(steps) > share * np.abs(steps).max()
            point = _Point(
                lags=grid.lags[held] - grid.lags[held][0],
                amplitudes=steps[held] / steps[held].sum(),
                ratios=np.zeros(0),
                inner=np.zeros(0, dtype=np.bool_),
                weights=np.zeros(0),
            )
            if _peaks(problem, point)[1].max() <= problem.tolerance:
                yield replace(_candidate(point, programs), point=None)
                return


def _nearest(
    problem: BandProblem, duration_rad: float, *, refine: bool, follow: bool
) -> tuple[float, tuple[_Point, float] | None]:
    """Return the least residual of a duration, and what its structure leads to."""
    tolerance = problem.tolerance * (1 - DESIGN_MARGIN)
    if refine:
        grid, found = _closer_look(problem, duration_rad)
    else:
        grid = _even_grid(problem, duration_rad)
        found = _least_residual(problem, grid)
    start = _structure(problem, grid, found)
    if start is None:
        return found.largest, None
    best = _optimum(problem, start, tolerance)
    if best is not None:
        return found.largest, (best, tolerance)
    return found.largest, _followed(problem, start, found.largest, tolerance) if follow else None


def _told(
    problem: BandProblem, point: _Point, tolerance: float, programs: int
) -> BandCandidate | Obstacle:
    if tolerance > problem.tolerance:
        return _obstacle(problem, point)
    return _candidate(point, programs)


def _candidate(point: _Point, programs: int) -> BandCandidate:
    return BandCandidate(
        times_rad=point.lags[-1] - point.lags[::-1],
        amplitudes=point.amplitudes[::-1],
        iterations=point.steps,
        cone_programs=programs,
        point=point,
    )


def _next_duration(
    before: tuple[float, float] | None,
    now: tuple[float, float],
    wanted: float,
    low: float,
    high: float,
) -> float:
    """Return the duration to try next: secant through the last two, inside the bracket."""
    (duration, ripples), (other, others) = now, before or (0.0, 0.0)
    slope = (ripples - others) / (duration - other)
    guess = duration + (wanted - ripples) / slope if slope > 0 else 0.0
    if low == 0:
        return guess if duration / 2 < guess < duration else duration / 2
    if high == math.inf:
        return guess if duration < guess < 2 * duration else 1.2 * duration
    inside = KEPT_INSIDE * (high - low)
    return min(max(guess, low + inside), high - inside) if guess > 0 else (low + high) / 2


def obstacles(problem: BandProblem, candidate: BandCandidate) -> Iterator[Obstacle]:
    """Yield what may prove that no shaper is as short as durations ever further below."""
    longest = float(candidate.times_rad[-1])
    start = candidate.point
    for eased in EASED:
        point = start and _newton(problem, start, problem.tolerance * (1 + eased))
        if point is not None and point.lags[-1] < longest:
            yield _obstacle(problem, point)
    for shortened in SHORTENED:
        yield obstacle_at(problem, longest * (1 - shortened))[0]


def _obstacle(problem: BandProblem, point: _Point) -> Obstacle:
    """Return the dual function of an optimum."""
    vector = np.exp(np.multiply.outer(problem.unit_pole * point.ratios, point.lags))
    along = (vector @ point.amplitudes).conj()
    return Obstacle(
        duration_rad=float(point.lags[-1]),
        ratios=point.ratios,
        vectors=point.weights * along / np.abs(along),
    )


def obstacle_at(problem: BandProblem, duration_rad: float) -> tuple[Obstacle, float]:
    """Return what may prove that no shaper is as short as a duration, from the cone program.

    With it about the least tolerance that the duration allows [-].
    """
    grid = _even_grid(problem, duration_rad)
    found = _least_residual(problem, grid)
    obstacle = Obstacle(duration_rad=duration_rad, ratios=grid.ratios, vectors=found.obstacle)
    return obstacle, found.largest


def _closer_look(problem: BandProblem, duration_rad: float) -> tuple[_Grid, ConeOutcome]:
    """Solve the cone program of a duration on a grid refined around impulses and peaks."""
    even = grid = _even_grid(problem, duration_rad)
    found = _least_residual(problem, grid)
    for share in REFINED_PITCHES:
        start = _structure(problem, grid, found)
        if start is None or start.lags.size > MOST_SEEN:
            break
        grid = _refined(even, start, share)
        found = _least_residual(problem, grid)
    return grid, found
