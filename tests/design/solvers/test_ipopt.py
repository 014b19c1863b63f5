"""IPOPT on small problems with known answers, and the table of its words."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import pytest

from design.formulations.equations import GapProblem
from design.formulations.expressions import Expressions, Model
from design.formulations.unity_magnitude import ZERO_VIBRATION_DERIVATIVE
from design.formulations.unity_magnitude_problem import unity_magnitude_problem
from design.model.actuators.ideal import Ideal
from design.solvers import ipopt
from design.solvers.ipopt_setup import STATUS, solver_of
from design.solvers.outcome import Status
from tests.shaper_table import DAMPED, THESIS


@dataclass(frozen=True)
class Hyperbola:
    """Least x + y on x y = p: sqrt(p) each."""

    def expressions(self) -> Expressions:
        import casadi as ca

        x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 1)
        return Expressions(
            unknowns=x, parameters=p, objective=ca.sum1(x), equations=x[0] * x[1] - p
        )


@dataclass(frozen=True)
class Nowhere:
    """x^2 + y^2 = -p: no point for p > 0."""

    def expressions(self) -> Expressions:
        import casadi as ca

        x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 1)
        return Expressions(
            unknowns=x, parameters=p, objective=ca.sum1(x), equations=ca.sumsqr(x) + p
        )


def problem(
    model: Model, parameter: float, shortest: tuple[float, float] = (1e-6, 1e-6)
) -> GapProblem:
    return GapProblem(
        model=model,
        parameters=np.array([parameter]),
        amplitudes=np.array([1.0, -1.0, 1.0]),
        natural_frequency_rad_s=1.0,
        shortest_gaps_rad=np.array(shortest),
        horizon_rad=20.0,
        seeds=(),
        designed_for=Ideal(),
    )


@pytest.mark.parametrize("parameter", [0.25, 4.0, 9.0])
def test_the_duration_is_minimised_on_the_equations(parameter: float) -> None:
    outcome = ipopt.solve(problem(Hyperbola(), parameter), np.array([1.0, 5.0]))
    assert outcome.status is Status.SOLVE_SUCCEEDED
    assert outcome.iterations > 0
    # A minimum is known to the root of its tolerance, its equations to the tolerance.
    assert outcome.unknowns == pytest.approx(np.sqrt([parameter, parameter]), abs=1e-5)
    assert outcome.unknowns.prod() == pytest.approx(parameter, rel=1e-11)


def test_gaps_are_kept_as_long_as_asked() -> None:
    outcome = ipopt.solve(problem(Hyperbola(), 4.0, (3.0, 1e-6)), np.array([4.0, 4.0]))
    assert outcome.status is Status.SOLVE_SUCCEEDED
    # IPOPT relaxes bounds by 1e-8 of their size.
    assert outcome.unknowns == pytest.approx([3.0, 4.0 / 3.0], abs=1e-6)


def test_a_problem_without_a_point_is_no_success() -> None:
    outcome = ipopt.solve(problem(Nowhere(), 1.0), np.array([1.0, 1.0]))
    assert outcome.status in {Status.INFEASIBLE, Status.FAILED}


def test_an_answer_is_the_callers_to_keep() -> None:
    first = ipopt.solve(problem(Hyperbola(), 4.0), np.array([1.0, 5.0]))
    kept = first.unknowns.copy()
    ipopt.solve(problem(Hyperbola(), 9.0), np.array([1.0, 5.0]))
    assert (first.unknowns == kept).all()


def test_an_acceptable_level_is_not_zero_vibration() -> None:
    assert STATUS["Solved_To_Acceptable_Level"] is Status.FAILED


def test_only_one_of_ipopts_words_is_success() -> None:
    succeeded = [word for word, status in STATUS.items() if status is Status.SOLVE_SUCCEEDED]
    assert succeeded == ["Solve_Succeeded"]


@pytest.mark.parametrize(
    ("word", "status"),
    [
        ("Solve_Succeeded", Status.SOLVE_SUCCEEDED),
        ("Infeasible_Problem_Detected", Status.INFEASIBLE),
        ("Maximum_WallTime_Exceeded", Status.TIME_LIMIT),
        ("Maximum_CpuTime_Exceeded", Status.TIME_LIMIT),
        ("Maximum_Iterations_Exceeded", Status.FAILED),
        ("A word of a later version", Status.FAILED),
    ],
)
def test_ipopts_words_become_ours_and_unknown_ones_are_failures(
    word: str, status: Status, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = problem(Hyperbola(), 4.0)
    told = {"return_status": word, "iter_count": 3}
    monkeypatch.setattr(solver_of(asked.model), "stats", lambda: told)
    outcome = ipopt.solve(asked, np.array([1.0, 5.0]))
    assert (outcome.status, outcome.iterations) == (status, 3)


def test_threads_take_turns_and_get_their_own_answers() -> None:
    problems = [
        unity_magnitude_problem(
            ZERO_VIBRATION_DERIVATIVE, DAMPED, actuator, settle=False, max_duration_periods=3.0
        )
        for actuator in (Ideal(), THESIS)
    ] * 8
    alone = [ipopt.solve(one, one.seeds[0].gaps_rad).unknowns for one in problems[:2]] * 8
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda one: ipopt.solve(one, one.seeds[0].gaps_rad), problems))
    assert [one.unknowns.tolist() for one in together] == [one.tolist() for one in alone]
