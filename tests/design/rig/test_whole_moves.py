"""Whole moves beside other commands: they are played as they are, one after the other."""

import numpy as np
import pytest

from design.model.actuators.rate_limited import RateLimited
from design.model.commands import pulse
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.rig.crane import AxisName
from design.rig.runs import Scenario, run
from design.rig.scenario import Drive, Played
from design.rig.whole_moves import WholeMove, with_moves
from design.shapers.registry import SHAPERS
from tests.design.rig.cranes import CRANE, THESIS
from tests.refusals import refused

SHORT = Impulses(times_s=np.array([0.0, 0.3, 2.0]), amplitudes=np.array([1.0, -0.5, -0.5]))
LIMITED = RateLimited(accel_limit_m_s2=0.4, decel_limit_m_s2=0.5, speed_m_s=0.2)


def move(at_s: float, event: int = 0, axis: AxisName = "x", command: Impulses = SHORT) -> WholeMove:
    return WholeMove(event=event, axis=axis, at_s=at_s, command=command)


def test_moves_are_put_beside_what_else_is_commanded() -> None:
    pressed = pulse(1.0)
    made = with_moves(pressed, [move(4.0, 1), move(1.0), move(0.0, 2, "y")], "x", THESIS)
    assert made is not None
    assert made.times_s.tolist() == [0.0, 1.3, 3.0, 4.0, 4.3, 6.0]
    # At 1 s the press ends and the move begins: there the level stays.
    assert np.cumsum(made.amplitudes) == pytest.approx([1.0, 0.5, 0.0, 1.0, 0.5, 0.0])


def test_the_last_step_and_the_first_of_the_next_are_one() -> None:
    made = with_moves(None, [move(0.0), move(2.0, 1)], "x", THESIS)
    assert made is not None
    assert made.times_s.tolist() == [0.0, 0.3, 2.0, 2.3, 4.0]
    assert with_moves(None, [move(0.0)], "y", THESIS) is None


@pytest.mark.parametrize(
    ("moves", "says"),
    [
        ([move(0.0), move(1.9, 1)], r"one does from 0 s until 2 s.*from 1\.9 to 3\.9 s"),
        ([move(1.9, 1), move(0.0)], r"from 0 s until 2 s"),
        ([move(0.0), move(0.0, 1)], r"from 0 s until 2 s"),
    ],
)
def test_moves_that_overlap_are_refused(moves: list[WholeMove], says: str) -> None:
    with refused("moves_overlap", "events.1.move.x_m", says=says):
        with_moves(None, moves, "x", THESIS)


@pytest.mark.parametrize(
    ("command", "at_s"),
    [
        (pulse(1.0), 0.9),
        (Impulses(times_s=np.array([3.0]), amplitudes=np.array([1.0])), 4.0),
        (Impulses(times_s=np.array([3.0]), amplitudes=np.array([1.0])), 2.0),
    ],
    ids=["before its end", "held for good", "begins during the move"],
)
def test_a_move_while_something_else_commands_the_axis_is_refused(
    command: Impulses, at_s: float
) -> None:
    with refused("moves_overlap", "events.0.move.x_m"):
        with_moves(command, [move(at_s)], "x", THESIS)
    assert with_moves(None, [move(at_s)], "x", THESIS) is not None


def test_behind_limits_a_move_lasts_until_its_last_ramp_ends() -> None:
    # The last half of full speed falls by 0.5 m/s^2: 0.2 s.
    with refused("moves_overlap", "events.1.move.x_m", says=r"until 2\.2 s"):
        with_moves(None, [move(0.0), move(2.19, 1)], "x", LIMITED)
    with_moves(None, [move(0.0), move(2.2, 1)], "x", LIMITED)
    with refused("moves_overlap", "events.0.move.x_m"):
        with_moves(pulse(1.0), [move(1.3)], "x", LIMITED)
    with_moves(pulse(1.0), [move(1.4)], "x", LIMITED)


@pytest.mark.parametrize("drive", [THESIS, LIMITED], ids=["thesis", "limits"])
def test_moves_there_and_back_leave_nothing(drive: RateLimited) -> None:
    plant = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
    moves = []
    for event, (at_s, distance_m) in enumerate(((0.5, 0.42), (8.0, -0.42))):
        made = maneuver(plant, drive, SHAPERS["numzv"], speed_m_s=0.2, distance_m=distance_m)
        command = Impulses(
            times_s=made.command.times_s, amplitudes=made.direction * made.command.amplitudes
        )
        moves.append(move(at_s, event, command=command))
    crane = Scenario(crane=CRANE, drive=drive, speed_m_s=0.2, moves=moves)
    done = run(crane, 16.0, 161)
    assert done.track.position_m[70, 0] == pytest.approx(0.42, abs=1e-9)
    assert done.track.position_m[-1, 0] == pytest.approx(0.0, abs=1e-9)
    assert done.residual is not None
    assert done.residual < 0.004  # of the nonlinear crane at 0.2 m/s
    assert set(done.commands) == {"x"}


def test_a_course_and_a_move_of_one_axis_are_refused() -> None:
    played = Played(times_s=np.array([0.0, 0.1, 0.2]), velocity_m_s=np.array([0.1, 0.1, 0.0]))
    both = Scenario(
        crane=CRANE, drive=THESIS, speed_m_s=0.2, moves=[move(1.0)], played={"x": played}
    )
    with refused("played_beside_events", "played.x"):
        run(both, 4.0, 2)
    other = Scenario(
        crane=CRANE,
        drive=THESIS,
        speed_m_s=0.2,
        moves=[move(1.0, axis="y")],
        drives=[Drive(event=1, axis="x", at_s=0.0, level=1.0, for_s=1.0)],
    )
    assert set(run(other, 4.0, 2).commands) == {"x", "y"}
