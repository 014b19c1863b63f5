"""Cone programs with a known answer, and impossible ones."""

import math

import numpy as np
import pytest

from design.solvers.clarabel import ConeProgram, CourseSteps, Levels, solve
from design.solvers.outcome import Status


def test_a_cone_program_with_a_known_answer() -> None:
    # Two vectors one against the other: half of each leaves nothing.
    found = solve(
        ConeProgram(
            offset=np.zeros(1, dtype=complex),
            rows=np.array([[1.0 + 0j, -1.0]]),
            lowest=0.0,
            highest=math.inf,
            unit_sum=True,
        )
    )
    assert found.status is Status.SOLVE_SUCCEEDED
    assert found.unknowns == pytest.approx([0.5, 0.5], abs=1e-6)
    assert found.largest == pytest.approx(0, abs=1e-7)


def test_an_impossible_cone_program_is_told_as_such() -> None:
    found = solve(
        ConeProgram(
            offset=np.zeros(1, dtype=complex),
            rows=np.array([[1.0 + 0j]]),
            lowest=0.0,
            highest=0.5,
            unit_sum=True,
        )
    )
    assert found.status is Status.INFEASIBLE


def test_slopes_of_levels_rise_as_a_limit_to_their_change_allows() -> None:
    # From rest to rest over a level of 1: up by 1, 2, 3 and down again, in cells of 1/9.
    found = solve(
        ConeProgram(
            offset=np.zeros(1, dtype=complex),
            rows=np.array([[0.0, 0.0, 1.0 + 0j, 0.0, 0.0]]),
            lowest=-9.0,
            highest=9.0,
            unit_sum=False,
            steps=CourseSteps(rise=1.0, fall=1.0, last=0.0),
            levels=Levels(cell=1 / 9, last=1.0),
        )
    )
    assert found.status is Status.SOLVE_SUCCEEDED
    assert found.unknowns == pytest.approx([1, 2, 3, 2, 1], abs=1e-6)
    assert found.largest == pytest.approx(3, abs=1e-6)


def test_a_level_too_high_for_the_slopes_is_impossible() -> None:
    found = solve(
        ConeProgram(
            offset=np.zeros(1, dtype=complex),
            rows=np.ones((1, 5), dtype=complex),
            lowest=-9.0,
            highest=2.0,
            unit_sum=False,
            steps=CourseSteps(rise=1.0, fall=1.0, last=0.0),
            levels=Levels(cell=1 / 9, last=1.0),
        )
    )
    assert found.status is Status.INFEASIBLE
