"""Cone programs with a known answer, and impossible ones."""

import math

import numpy as np
import pytest

from design.solvers.clarabel import ConeProgram, solve
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
