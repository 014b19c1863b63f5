"""The search for whole moves."""

from types import SimpleNamespace

import pytest

from design.moves.maneuvers import maneuver
from design.solvers.outcome import Outcome, Status
from design.types import FloatArray
from tests.design.moves.cranes import NUMZV, SPEED_M_S
from tests.refusals import refused
from tests.shaper_table import CRANE, THESIS


def test_a_solver_out_of_time_ends_the_search_for_a_move(monkeypatch: pytest.MonkeyPatch) -> None:
    def late(_: object, start: FloatArray) -> Outcome:
        return Outcome(status=Status.TIME_LIMIT, unknowns=start, iterations=1)

    monkeypatch.setattr("design.solvers.moves.ipopt", SimpleNamespace(solve=late, ITERATION_WORK=1))
    with refused("move_past_time", says="^ipopt ran past its time at start 1 of a move$"):
        maneuver(CRANE, THESIS, NUMZV, speed_m_s=SPEED_M_S, distance_m=0.05)
