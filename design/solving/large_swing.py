"""Times of steps for large swings: from those of small swings, speed by speed."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.errors import InfeasibleDesignError
from design.formulations.large_swing import LargeSwingProblem
from design.model.impulses import Impulses
from design.model.plants.large_swing import MAX_SWING_RAD
from design.response.large_swing import swing_ends
from design.solvers.budget import Budget
from design.solvers.solution import Solution, SolverReport
from design.solving.solve import solve
from design.trace import TraceStep
from design.types import ComplexArray, FloatArray

ADVANCE = 0.3
"""Growth of the square of the small angle from one speed to the next [rad^2]."""

MIN_ADVANCE = 1 / 64
"""Share of `ADVANCE` below which a branch counts as ended [-]."""

TIME_STEP_RAD = 1e-6
"""Step of a time for the differences that stand for derivatives: Newton's method forgives them."""

RATIO_STEP = 1e-3
RATIO_STEPS = RATIO_STEP * np.array([0.0, -2.0, -1.0, 1.0, 2.0])
RATIO_WEIGHTS = np.array([0.0, 1.0, -8.0, 8.0, -1.0]) / (12 * RATIO_STEP)
"""Difference of order four in ln w: off by 1e-9 of a step, and by rounding of 1e-12 [-]."""

SOLVED, NEARLY = 1e-13, 1e-10
"""Largest equation that counts as zero; one that does if rounding ends the iteration [-]."""

WEIGHTS = np.array([1.0, 1.0, 0.01, 0.01])
"""Of equations, residual before slope, which may be off by a hundred times as much [-]."""

ITERATIONS, MOST_RISES = 15, 2
"""Most steps of Newton's method at one speed, of which three or four are usual; and most of them
after which the equations are farther off."""

MOST_OF_A_GAP = 0.5
"""Share of a gap by which one step may shorten it [-]."""

COURSE_WORK = 4_000.0
"""Work of one course of a command [units]."""

TRIALS, NEAR = 8, 1e-3
"""Speeds tried between one that serves and one that does not; how near to the limit [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Point:
    """Times that solve the equations at one speed."""

    speed_m_s: float
    gaps_s: FloatArray
    largest_rad: float


@dataclass(slots=True, eq=False)
class _Branch:
    """Solutions that are followed from small swings on."""

    problem: LargeSwingProblem
    amplitudes: FloatArray
    reached: _Point
    budget: Budget
    beyond: _Point | None = None  # The first that swings too far
    complete: bool = False
    iterations: int = 0

    def follow(self) -> None:
        """Go on to the full speed, or to where the branch ends or swings too far."""
        swing = self.problem.swing
        goal = swing.speed_m_s**2
        most = step = ADVANCE * (swing.speed_m_s / swing.small_angle_rad) ** 2
        before = self.reached
        while not self.complete:
            now = self.reached.speed_m_s**2
            square = goal if now + step >= goal * (1 - NEARLY) else now + step
            gaps, known = self.reached.gaps_s, now - before.speed_m_s**2
            guess = gaps + (gaps - before.gaps_s) * ((square - now) / known if known else 0.0)
            speed = swing.speed_m_s if square == goal else math.sqrt(square)
            point = self._solve(speed, np.maximum(guess, gaps * MOST_OF_A_GAP))
            if point is None:
                step = (square - now) / 2
                if step < MIN_ADVANCE * most or self.budget.spent:
                    return
                continue
            if point.largest_rad > MAX_SWING_RAD:
                self._approach(point)
                return
            before, self.reached = self.reached, point
            self.complete = square == goal
            step = min(2 * step, most)

    def _approach(self, beyond: _Point) -> None:
        """Narrow where the swing becomes too large, by false position."""
        for _ in range(TRIALS):
            inside = self.reached
            share = (MAX_SWING_RAD - NEAR / 2 - inside.largest_rad) / (
                beyond.largest_rad - inside.largest_rad
            )
            if MAX_SWING_RAD - inside.largest_rad <= NEAR or self.budget.spent:
                break
            low, high = inside.speed_m_s**2, beyond.speed_m_s**2
            point = self._solve(
                math.sqrt(low + share * (high - low)),
                inside.gaps_s + share * (beyond.gaps_s - inside.gaps_s),
            )
            if point is None:
                break
            if point.largest_rad > MAX_SWING_RAD:
                beyond = point
            else:
                self.reached = point
        self.beyond = beyond

    def _solve(self, speed_m_s: float, gaps_s: FloatArray) -> _Point | None:
        """Return the solution near gaps at one speed; None where there is none."""
        swing = replace(self.problem.swing, speed_m_s=speed_m_s)
        drive = self.problem.designed_for
        ratios = np.exp(RATIO_STEPS if self.problem.slope else RATIO_STEPS[:1])
        unit = abs(swing_ends(swing, drive, np.zeros((1, 1)), np.ones(1), ratios[:1]).vectors[0, 0])
        step_s = TIME_STEP_RAD / swing.crane.mode.natural_frequency_rad_s
        lanes = step_s * np.vstack((np.zeros(gaps_s.size), np.eye(gaps_s.size)))
        before, rises = math.inf, 0
        for _ in range(ITERATIONS):
            self.budget.spend(COURSE_WORK * len(lanes))
            self.iterations += 1
            times_s = np.cumsum(np.pad(gaps_s + lanes, ((0, 0), (1, 0))), axis=1)
            ends = swing_ends(swing, drive, times_s, self.amplitudes, ratios)
            equations = _equations(ends.vectors / unit)
            miss = float(np.abs(equations[0] * WEIGHTS[: gaps_s.size]).max())
            if miss <= SOLVED or (miss <= NEARLY and miss >= before):
                return _Point(speed_m_s, gaps_s, float(ends.largest_rad[0].max()))
            rises += miss >= before
            if rises > MOST_RISES or not math.isfinite(miss):
                return None
            before = miss
            jacobian = (equations[1:] - equations[0]).T / step_s
            if not np.isfinite(jacobian).all() or np.linalg.matrix_rank(jacobian) < gaps_s.size:
                return None
            change = np.linalg.solve(jacobian, -equations[0])
            gaps_s = gaps_s + change / max(1.0, float((-change / gaps_s).max()) / MOST_OF_A_GAP)
        return None


def _equations(vectors: ComplexArray) -> FloatArray:
    """Return what is to vanish of each course: V, and dV/d ln w if ratios are there."""
    each = vectors[:, :1]
    if vectors.shape[1] > 1:
        each = np.column_stack((each, vectors @ RATIO_WEIGHTS))
    return np.column_stack((each.real, each.imag))


def solve_large_swing(problem: LargeSwingProblem, budget: Budget) -> Iterator[Solution]:
    """Yield times that leave nothing of a large swing.

    Newton's method follows each solution for small swings up to the full speed, by bounded steps
    of the square of the speed, on which the times depend smoothly.

    Parameters
    ----------
    problem, budget
        The problem, and what the search may do.

    Yields
    ------
    Solution
        One for each solution of small swings that leads to the full speed.

    Raises
    ------
    InfeasibleDesignError
        If the cable would swing more than 60 degrees, or no solution leads to the full speed; says
        up to which speed one does.
    """
    ended: list[_Branch] = []
    found = 0
    seeds = solve(problem.linear, budget)
    while (seed := _next_seed(seeds, ended)) is not None:
        start = seed.impulses
        branch = _Branch(
            problem, start.amplitudes, _Point(0.0, np.diff(start.times_s), 0.0), budget
        )
        branch.follow()
        _note(branch)
        if not branch.complete:
            ended.append(branch)
            if branch.beyond is not None:
                break
            continue
        found += 1
        times_s = np.concatenate(([0.0], np.cumsum(branch.reached.gaps_s)))
        yield Solution(
            impulses=Impulses(times_s=times_s, amplitudes=start.amplitudes),
            solver=SolverReport(
                name="newton",
                status="solve_succeeded",
                iterations=branch.iterations,
                seed="linear_design",
                starts=found + len(ended),
            ),
        )
    if ended and not found:
        refusal = _refusal(problem, max(ended, key=lambda one: one.reached.speed_m_s))
        raise refusal


def _next_seed(seeds: Iterator[Solution], ended: list[_Branch]) -> Solution | None:
    """Return the next solution for small swings; that there is none refuses the first alone."""
    try:
        return next(seeds, None)
    except InfeasibleDesignError:
        if ended:
            return None
        raise


def _note(branch: _Branch) -> None:
    """Note a branch in the trace of a search that is watched."""
    reached = branch.reached
    branch.budget.note(
        TraceStep(
            stage="solve",
            method="newton",
            start="linear_design",
            outcome="solve_succeeded" if branch.complete else "branch_ended",
            iterations=branch.iterations,
            duration_s=float(reached.gaps_s.sum()),
            detail=f"followed to {reached.speed_m_s:.6g} m/s",
        )
    )


def _refusal(problem: LargeSwingProblem, branch: _Branch) -> InfeasibleDesignError:
    """Return why no branch reaches the full speed, by the one that came farthest."""
    asked, beyond = problem.swing.speed_m_s, branch.beyond
    digits = 3 - math.floor(math.log10(max(branch.reached.speed_m_s, 1e-12)))
    nearest = math.floor(branch.reached.speed_m_s * 10**digits) / 10**digits
    faults = (("shaper.speed_m_s", f"at most {nearest:g} m/s"),)
    if beyond is None:
        return InfeasibleDesignError(
            f"no times were found that leave nothing of the swing at {asked:g} m/s: those of small "
            f"swings lead up to {nearest:g} m/s",
            code="large_swing_branch_ends",
            faults=faults,
        )
    return InfeasibleDesignError(
        f"at {asked:g} m/s the cable would swing more than {math.degrees(MAX_SWING_RAD):.0f} "
        f"degrees from the vertical: {math.degrees(beyond.largest_rad):.4g} degrees already at "
        f"{beyond.speed_m_s:.4g} m/s; up to {nearest:g} m/s it stays within them",
        code="large_swing_over_60_degrees",
        faults=faults,
    )
