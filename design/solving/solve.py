"""What solves a formulation, by the solver that it is for: not yet verified."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from design.analysis.shortest import excluded_rad
from design.errors import InfeasibleDesignError
from design.formulations.bands import BandProblem, BandSearch
from design.formulations.formulation import ClosedForm, Convolution, Formulation, JointProblem
from design.model.impulses import Impulses
from design.solvers.budget import Budget
from design.solvers.joint import shortest
from design.solvers.search import Candidate, candidates
from design.solvers.unity_band.search import BandCandidate, band_candidates
from design.solving.bounded import fastest
from design.types import FloatArray

OVER_RANGE = 1e-9
"""What a command may be out of range by: rounding of its amplitudes [-]."""

SAME_TIME = 1e-12
"""Steps of convolved shapers closer than this, over the duration, are one [-]."""

NO_STEP = 1e-15
"""Share of all steps' sizes that is what their sum is rounded by, a few times [-].

Larger ones may count, small as they are: those that end a command in a heavily damped mode, where
what came before has decayed.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverReport:
    """How the impulses were found.

    Attributes
    ----------
    name
        ``ipopt``, ``clarabel``, ``highs``, ``closed_form``, or ``newton``: followed from a closed
        form.
    status
        How the run ended.
    iterations
        Iterations of the run that led to the design.
    seed
        Name of its start.
    starts
        Starts tried until then; cone or linear programs of ``clarabel`` and ``highs``.
    lower_bound_s
        No shaper of its class is as short: proven for all times; None where nothing is proven [s].
    gap
        How far the duration may be above the shortest, over itself; None likewise [-].
    """

    name: str
    status: str
    iterations: int
    seed: str
    starts: int
    lower_bound_s: float | None = None
    gap: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solution:
    """What solves a formulation, not yet verified.

    Attributes
    ----------
    impulses
        The shaper.
    solver
        How it was found.
    ratios
        Where its curve has zeros and peaks, if they were unknown too, shape (r,) [-].
    """

    impulses: Impulses
    solver: SolverReport
    ratios: FloatArray = field(default_factory=lambda: np.zeros(0))


def solutions(formulation: Formulation, budget: Budget | None = None) -> Iterator[Solution]:
    """Yield what solves a formulation, not yet verified; raises where no more is found.

    No impulse of a solution is as small as rounding, and no two are at one time. A search ends
    where its budget is spent; that of one design if none is given.
    """
    for solution in _by_its_solver(formulation, Budget() if budget is None else budget):
        yield replace(solution, impulses=merged(solution.impulses))


def _by_its_solver(formulation: Formulation, budget: Budget) -> Iterator[Solution]:
    if isinstance(formulation, ClosedForm):
        yield Solution(
            impulses=formulation.impulses,
            solver=SolverReport(
                name=formulation.method,
                status="solve_succeeded",
                iterations=0,
                seed="none",
                starts=0,
            ),
        )
        return
    if isinstance(formulation, JointProblem):
        yield from _joint_solutions(formulation, budget)
        return
    if isinstance(formulation, Convolution):
        yield _convolution(formulation, budget)
        return
    if isinstance(formulation, BandProblem):
        yield from _band_solutions(formulation, budget)
        return
    w = formulation.natural_frequency_rad_s
    found: Iterator[Candidate | BandCandidate] = (
        band_candidates(formulation, budget)
        if isinstance(formulation, BandSearch)
        else candidates(formulation, budget)
    )
    for candidate in found:
        phases = np.concatenate(([0.0], np.cumsum(candidate.gaps_rad)))
        yield Solution(
            impulses=Impulses(times_s=phases / w, amplitudes=candidate.problem.amplitudes),
            solver=SolverReport(
                name="ipopt",
                status="solve_succeeded",
                iterations=candidate.iterations,
                seed=candidate.seed,
                starts=candidate.starts,
            ),
            ratios=candidate.ratios if isinstance(candidate, Candidate) else np.zeros(0),
        )


def _joint_solutions(problem: JointProblem, budget: Budget) -> Iterator[Solution]:
    w = problem.natural_frequency_rad_s
    for found in shortest(problem, budget):
        duration = float(found.times_rad[-1])
        bound = excluded_rad(problem.unit_poles, found.vectors, duration, positive=problem.positive)
        yield Solution(
            impulses=Impulses(times_s=found.times_rad / w, amplitudes=found.amplitudes),
            solver=SolverReport(
                name="highs",
                status="solve_succeeded",
                iterations=found.iterations,
                seed="linear_program",
                starts=found.programs,
                lower_bound_s=bound / w,
                gap=1 - bound / duration,
            ),
        )


def _convolution(convolution: Convolution, budget: Budget) -> Solution:
    """Convolve the first solution of each part, and refuse what leaves the range of the command."""
    solved = [next(solutions(part, budget)) for part in convolution.parts]
    impulses = solved[0].impulses
    for further in solved[1:]:
        impulses = _convolved(impulses, further.impulses)
    levels = np.cumsum(impulses.amplitudes)
    low, high = float(levels.min()), float(levels.max())
    if low < -OVER_RANGE or high > 1 + OVER_RANGE:
        raise InfeasibleDesignError(
            f"the convolved command would go from {low:.6g} to {high:.6g} of full speed, beyond 0 "
            "to 1; multi_umzv solves all modes jointly within that range"
        )
    report = replace(
        solved[0].solver,
        iterations=sum(one.solver.iterations for one in solved),
        starts=sum(one.solver.starts for one in solved),
    )
    return Solution(impulses=impulses, solver=report)


def _convolved(first: Impulses, second: Impulses) -> Impulses:
    """Return each step of one shaper shaped by the other; small steps may count, see `NO_STEP`."""
    times = np.add.outer(first.times_s, second.times_s).ravel()
    amplitudes = np.multiply.outer(first.amplitudes, second.amplitudes).ravel()
    order = np.argsort(times, kind="stable")
    return merged(Impulses(times_s=times[order], amplitudes=amplitudes[order]))


def merged(impulses: Impulses) -> Impulses:
    """Join steps at the same time but for rounding, and leave out those that are rounding.

    Left out are the smallest steps as long as they are less than `NO_STEP` of all together, so
    that what the others claim to be zero stays so.
    """
    times, amplitudes = impulses.times_s, impulses.amplitudes
    apart = np.diff(times, prepend=-np.inf) > SAME_TIME * impulses.duration_s
    summed = np.add.reduceat(amplitudes, np.flatnonzero(apart))
    sizes = np.abs(summed)
    order = np.argsort(sizes, kind="stable")
    kept = np.empty(sizes.size, dtype=np.bool_)
    kept[order] = np.cumsum(sizes[order]) > NO_STEP * sizes.sum()
    if apart.all() and kept.all():
        return impulses
    times = times[apart][kept]
    return Impulses(times_s=times - times[0], amplitudes=summed[kept] / summed[kept].sum())


def _band_solutions(problem: BandProblem, budget: Budget) -> Iterator[Solution]:
    w = problem.natural_frequency_rad_s
    for found in fastest(problem, budget):
        yield Solution(
            impulses=Impulses(times_s=found.times_rad / w, amplitudes=found.amplitudes),
            solver=SolverReport(
                name="clarabel",
                status="solve_succeeded",
                iterations=found.iterations,
                seed="cone_program",
                starts=found.cone_programs,
                lower_bound_s=found.lower_bound_rad / w,
                gap=found.gap,
            ),
        )
