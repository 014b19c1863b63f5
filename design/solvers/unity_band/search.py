"""From a band to candidates: of the fewest impulses first, two seeds of each number compared."""

import math
import threading
from collections.abc import Iterator

from design.errors import InfeasibleDesignError
from design.formulations.bands import BandSearch, UnityBandProblem
from design.formulations.gaps import of_gaps
from design.formulations.seeds import Seed
from design.solvers.budget import Budget
from design.solvers.solution import Solution, SolverReport
from design.solvers.unity_band.descent import Descent, Run
from design.trace import TraceStep

COMPARED = 2
"""Seeds of one number of impulses of whose designs the shorter is taken."""

FAR_MISS = 1.2
"""A run that ends at this many times the tolerance does so wherever it began [-]."""

_one_at_a_time = threading.Lock()


def solve(search: BandSearch, budget: Budget) -> Iterator[Solution]:
    """Yield designs over a band, of the fewest impulses first.

    Two seeds of every number of impulses are compared. Where one ends far above the tolerance, the
    others wait until more impulses have been tried.

    Parameters
    ----------
    search
        The band, and a problem for each number of impulses.
    budget
        What the search may do; its work is counted in it.

    Yields
    ------
    Solution
        Impulses and the report of the solver, not yet certified.

    Raises
    ------
    InfeasibleDesignError
        When all candidates, if any, are used up: says what came nearest.
    TimeLimitError
        If IPOPT ran past its time.
    """
    runs = _Runs(search, budget)
    later = []
    for problem in search.problems:
        tried, found = 0, []
        for seed in problem.seeds:
            if runs.budget.spent:
                break
            run = runs.run(problem, seed)
            tried += 1
            found += runs.candidate(problem, seed, run)
            if run.highest > FAR_MISS or (found and tried >= COMPARED):
                break
        yield from sorted(found, key=lambda one: one.impulses.duration_s)
        later += [(problem, seed) for seed in problem.seeds[tried:]]
    for problem, seed in later:
        if runs.budget.spent:
            break
        yield from runs.candidate(problem, seed, runs.run(problem, seed))
    raise InfeasibleDesignError(runs.describe_search(), code="no_band_solution_found")


class _Runs:
    """What was tried so far."""

    def __init__(self, search: BandSearch, budget: Budget) -> None:
        self.search, self.budget = search, budget
        self.starts = 0
        self.nearest, self.late = math.inf, math.inf

    def run(self, problem: UnityBandProblem, seed: Seed) -> Run:
        """Run from a seed."""
        self.starts += 1
        with _one_at_a_time:
            descent = Descent(problem, self.search.half_width, self.search.tolerance, self.budget)
            run = descent.run(seed.gaps_rad)
        self.nearest = min(self.nearest, run.highest)
        duration = float(run.gaps_rad.sum())
        in_time = duration <= self.search.horizon_rad
        self.budget.note(
            TraceStep(
                stage="solve",
                method="ipopt",
                start=seed.name,
                outcome=("solve_succeeded" if in_time else "rejected")
                if run.converged
                else "failed",
                iterations=run.steps,
                duration_s=duration / self.search.natural_frequency_rad_s,
                detail=f"{problem.amplitudes.size} impulses, {run.highest:.4g} of the tolerance"
                f"{'' if in_time else ', longer than max_duration_periods'}",
            )
        )
        return run

    def candidate(self, problem: UnityBandProblem, seed: Seed, run: Run) -> list[Solution]:
        """Return the end of a run, if it is a candidate."""
        duration = float(run.gaps_rad.sum())
        if run.converged and duration > self.search.horizon_rad:
            self.late = min(self.late, duration)
        elif run.converged:
            w = self.search.natural_frequency_rad_s
            return [
                Solution(
                    impulses=of_gaps(run.gaps_rad, w, problem.amplitudes),
                    solver=SolverReport(
                        name="ipopt",
                        status="solve_succeeded",
                        iterations=run.steps,
                        seed=seed.name,
                        starts=self.starts,
                    ),
                )
            ]
        return []

    def describe_search(self) -> str:
        """Say how far was searched, and what came nearest."""
        search, period = self.search, 2 * math.pi
        counts = sorted(problem.amplitudes.size for problem in search.problems)
        report = (
            f"no shaper of {' or '.join(map(str, counts))} impulses of unity magnitude was found "
            f"whose residual is at most {search.tolerance:g} from {search.band[0]:.6g} to "
            f"{search.band[1]:.6g} of the frequency, within {search.horizon_rad / period:g} "
            f"periods in {self.starts} starts"
        )
        if self.budget.spent:
            report = f"{report} until {self.budget.in_words}"
        if self.late < math.inf:
            return f"{report}; the shortest takes {self.late / period:.6g} periods"
        nearest = self.nearest * search.tolerance
        return f"{report}; the residual of the nearest miss is {nearest:.4g} there"
