"""Maps against single cells, closed forms, integration and moves played."""

import math
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.analysis.residuals_of_many import residuals_of_cases
from design.fields import Axis
from design.maps.commands import design_command
from design.maps.field_map import field_map
from design.maps.map_case import MapCase, Move, Recipe
from design.model.actuators.ideal import Ideal
from design.model.actuators.second_order import SecondOrder
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.moves.playback import motion
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.design.test_switched import SWITCHED, random_case
from tests.integration_route import residual_by_integration
from tests.map_cases import CORNER, FREQUENCY, LENGTH, PULSES, case
from tests.refusals import refused
from tests.second_route import claims_by_formula
from tests.shaper_table import CRANE, THESIS


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("seed", range(60))
def test_many_cases_at_once_are_each_alone(seed: int, model: str) -> None:
    command, mode, actuator = random_case(seed)
    changed: Any = {"model": model}
    actuator = replace(actuator, **changed)
    lags = (actuator.accel_lag, actuator.decel_lag)
    told = residuals_of_cases(
        command,
        np.array([mode.pole_rad_s] * 2),
        np.array([[lag.first_s for lag in lags]] * 2),
        np.array([[lag.second_s2 for lag in lags]] * 2),
        actuator.model,
    )
    alone = residual_vibration(command, mode, actuator)
    assert told == pytest.approx([alone, alone], abs=1e-12)  # rounding


@pytest.mark.parametrize("actuator", [THESIS, SWITCHED], ids=["superposed", "switched"])
def test_a_held_shaper_is_judged_in_each_cell(actuator: SecondOrder) -> None:
    shaper = design(CRANE, actuator, SHAPERS["numzvd"]).impulses
    found = residuals(MapCase(plant=CRANE, actuator=actuator, shaper=shaper), CORNER, LENGTH)
    assert found.shape == (7, 5)
    for row, length in enumerate(LENGTH.values.tolist()):
        for column, corner in enumerate(CORNER.values.tolist()):
            plant = Pendulum(cable_length_m=length, gravity_m_s2=CRANE.gravity_m_s2)
            drive = replace(actuator, accel=replace(actuator.accel, natural_frequency_rad_s=corner))
            expected = residual_vibration(shaper, plant.mode, drive)
            assert found[row, column] == pytest.approx(expected, abs=1e-13)


def test_a_shaper_designed_anew_leaves_nothing_in_any_cell() -> None:
    anew = residuals(case("numzv"), CORNER, LENGTH)
    assert np.all(anew < 1e-12)


def test_one_that_knows_no_actuator_leaves_more_behind_a_slower_one() -> None:
    # Kim 2011, fig. 3-18: the difference of the two sets is what matters.
    left = residuals(case("umzv"), CORNER, LENGTH)
    assert np.all(np.diff(left[:, :3], axis=1) < 0)


def test_a_cell_without_a_shaper_is_not_a_number() -> None:
    # About the crane's own, 0.3348.
    found = residuals(case("numzv", max_duration_periods=0.335), CORNER, LENGTH)
    assert np.isnan(found).any()
    assert not np.isnan(found).all()


def residuals(of: MapCase, x: Axis, y: Axis | None = None) -> Any:
    return field_map(of, x, y).values[:, :, 0]


@pytest.mark.parametrize("actuator", [THESIS, SWITCHED], ids=["superposed", "switched"])
def test_over_the_pulse_of_a_held_move_the_stop_alone_is_re_timed(actuator: SecondOrder) -> None:
    held = case("numzvd", actuator, each=False, move=Move(pulse_s=2.5))
    found = residuals(held, PULSES, CORNER)
    move = maneuver(CRANE, actuator, SHAPERS["numzvd"], speed_m_s=0.2, pulse_s=2.5)
    for (row, corner), (column, pulse) in product(
        enumerate(CORNER.values.tolist()), enumerate(PULSES.values.tolist())
    ):
        if pulse < move.start.duration_s:
            assert np.isnan(found[row, column])
            continue
        command = Impulses(
            times_s=np.concatenate((move.start.times_s, move.stop.times_s + pulse - 2.5)),
            amplitudes=move.command.amplitudes,
        )
        drive = replace(actuator, accel=replace(actuator.accel, natural_frequency_rad_s=corner))
        expected = residual_vibration(command, CRANE.mode, drive)
        assert found[row, column] == pytest.approx(expected, abs=1e-12)
    assert residuals(held, CORNER, PULSES) == pytest.approx(found.T, abs=1e-12, nan_ok=True)


def test_a_move_designed_for_superposed_steps_swings_a_switched_drive() -> None:
    # By integration of both, step by step: no closed form of the package.
    judged = case(
        "numzv", SWITCHED, designed_for="superposed", move=Move(pulse_s=3.0)
    )  # fmt: skip
    pulses = Axis(path=PULSES.path, values=np.array([0.9, 2.0]))
    found = residuals(judged, pulses)[0]
    for left, pulse in zip(found.tolist(), pulses.values.tolist(), strict=True):
        move = maneuver(CRANE, THESIS, SHAPERS["numzv"], speed_m_s=0.2, pulse_s=pulse)
        assert left > 1e-4
        assert left == pytest.approx(
            residual_by_integration(move.command, CRANE.mode, SWITCHED), abs=1e-7
        )


def test_a_shaper_for_superposed_steps_leaves_what_is_known_of_a_switched_drive() -> None:
    found = residuals(
        case("numzvd", SWITCHED, designed_for="superposed"), Axis(
            path=LENGTH.path, values=np.array([0.8])
        )
    )  # fmt: skip
    assert found[0, 0] == pytest.approx(0.0074, abs=5e-5)


@pytest.mark.parametrize(
    ("actuator", "mirrored"), [(THESIS, 0.0056), (SWITCHED, 0.0015)], ids=["superposed", "switched"]
)
def test_a_solved_stop_leaves_nothing_and_a_mirrored_one_what_it_must(
    actuator: SecondOrder, mirrored: float
) -> None:
    at = Axis(path=PULSES.path, values=np.array([2.5]))
    for stop, left in (("solved", 0.0), ("mirrored", mirrored)):
        for each in (True, False):
            move = Move(pulse_s=2.5, stop=stop)  # type: ignore[arg-type]
            found = residuals(case("numzvd", actuator, each=each, move=move), at)
            assert found[0, 0] == pytest.approx(left, abs=5e-5)


def test_a_pulse_too_short_for_a_mirrored_stop_is_no_cell() -> None:
    found = residuals(case("numzvd", move=Move(pulse_s=2.5, stop="mirrored")), PULSES)[0]
    short = PULSES.values < 1.32  # the start, docs/theory.md
    assert np.isnan(found[short]).all()
    assert np.isfinite(found[~short]).all()


def test_a_deflection_is_that_of_the_move_played() -> None:
    moved = case(
        "umzv", move=Move(pulse_s=3.0), quantity="deflection_m", speed_m_s=0.2
    )  # fmt: skip
    lengths = Axis(path=LENGTH.path, values=np.array([0.6, 0.8]))
    found = field_map(moved, lengths).values[0, :, 0]
    once = case("umzv", each=False, move=Move(pulse_s=3.0), quantity="deflection_m", speed_m_s=0.2)
    held = field_map(once, lengths).values[0, :, 0]
    for told, length in zip(found.tolist(), lengths.values.tolist(), strict=True):
        plant = replace(CRANE, cable_length_m=length)
        move = maneuver(plant, THESIS, SHAPERS["umzv"], speed_m_s=0.2, pulse_s=3.0)
        after = move.command.times_s[-1] + np.linspace(2, 6, 8001)  # the drive has come to rest
        played = motion(plant, THESIS, move.command, 0.2, after)
        assert told == pytest.approx(float(np.abs(played.deflection_m).max()), rel=1e-5)
    # The held one is that of 0.8 m.
    assert held[1] == pytest.approx(found[1], rel=1e-12)
    assert abs(held[0] - found[0]) > 1e-4


def test_gains_are_those_of_the_transfer_functions() -> None:
    corners = np.array([10.0, 20.0, 50.0])
    x = Axis(path=("actuator", "decel", "natural_frequency_rad_s"), values=corners)
    y = Axis(path=("actuator", "accel", "natural_frequency_rad_s"), values=corners)
    gains = {}
    for quantity in ("alpha", "beta_rad"):
        of = MapCase(plant=CRANE, actuator=THESIS, quantity=quantity)
        gains[quantity] = field_map(of, x, y).values[:, :, 0]
    for (row, accel), (column, decel) in product(enumerate(corners), enumerate(corners)):
        s = 1j * FREQUENCY
        ratio = (
            decel**2 / (s**2 + 2 * 1.5 * decel * s + decel**2)
            * (s**2 + 2 * 0.8 * accel * s + accel**2) / accel**2
        )  # fmt: skip
        assert gains["alpha"][row, column] == pytest.approx(abs(ratio), rel=1e-12)
        assert gains["beta_rad"][row, column] == pytest.approx(-np.angle(ratio), abs=1e-12)
    # At the crane of Kim 2011.
    assert gains["alpha"][1, 2] == pytest.approx(0.9921129437, abs=1e-10)
    assert gains["beta_rad"][1, 2] == pytest.approx(-0.0732506641, abs=1e-10)


def test_equal_sets_have_a_gain_of_one() -> None:
    # Kim 2011, at fig. 3-13: the smaller the difference of the sets, the nearer to 1.
    even = replace(THESIS, decel=THESIS.accel)
    x = Axis(
        path=("actuator", "decel", "natural_frequency_rad_s"), values=np.array([20.0, 25.0, 40.0])
    )
    alpha = field_map(MapCase(plant=CRANE, actuator=even, quantity="alpha"), x).values[0, :, 0]
    assert alpha[0] == 1
    assert np.all(np.diff(np.abs(alpha - 1)) > 0)


def test_times_are_those_of_each_design_and_fall_with_the_frequency() -> None:
    over = Axis(path=LENGTH.path, values=np.array([0.8, 0.6, 0.4]))
    found = field_map(case("numzvd", quantity="times_s"), over).values[0]
    assert found.shape == (3, 5)
    thesis = [0, 0.18211712, 0.66033323, 1.18087995, 1.32079496]
    assert found[0] == pytest.approx(thesis, abs=1e-8)
    assert np.all(np.diff(found[:, 1:], axis=0) < 0)
    for times, length in zip(found, over.values.tolist(), strict=True):
        left = claims_by_formula(
            Impulses(times_s=times, amplitudes=np.array([1.0, -1, 1, -1, 1])),
            replace(CRANE, cable_length_m=length).mode,
            THESIS,
        )
        assert max(left.values()) < 1e-7
    lasting = field_map(case("numzvd", quantity="duration_s"), over).values[0, :, 0]
    assert lasting == pytest.approx(found[:, -1], abs=1e-12)


def test_times_of_a_move_include_those_of_its_stop() -> None:
    # Kim 2011, fig. 3-16: t5 and t6 follow from the pulse, 3 s.
    over = Axis(path=LENGTH.path, values=np.array([0.8]))
    times = field_map(
        case("numzv", quantity="times_s", move=Move(pulse_s=3.0)), over
    ).values[0, 0]  # fmt: skip
    turn = math.pi / 3  # of equal sets; of the crane's, nearly
    assert times[:4] == pytest.approx([0, 0.32126352, 0.60069086, 3.0], abs=1e-8)
    assert times[4:] == pytest.approx([3 + turn / FREQUENCY, 3 + 2 * turn / FREQUENCY], abs=0.05)


@pytest.mark.parametrize(
    ("of", "x", "code", "field"),
    [
        (case("numzv"), PULSES, "not_a_number_of_map", "x.field"),
        (
            case("numzv", move=Move(pulse_s=2.0)),
            Axis(path=PULSES.path, values=np.array([0.0, 1.0])),
            "not_positive",
            "x.values",
        ),
        (
            case("numzvd", move=Move(pulse_s=1.0), each=False),
            PULSES,
            "start_and_stop_overlap",
            "move.pulse_s",
        ),
        (case("numzv", quantity="alpha"), LENGTH, "quantity_of_plant_alone", "shaper"),
        (MapCase(plant=CRANE, actuator=THESIS), LENGTH, "shaper_missing", "shaper"),
        (case("numzv", quantity="times_s", each=False), LENGTH, "design_per_cell_only", "design"),
        (case("numzvd", quantity="branch"), LENGTH, "branch_of_other_kind", "quantity"),
        (case("numzv", SWITCHED, quantity="branch"), LENGTH, "branch_not_served", "quantity"),
        (case("numzv", quantity="deflection_m"), LENGTH, "speed_without_deflection", "speed_m_s"),
        (case("numzv", speed_m_s=0.2), LENGTH, "speed_without_deflection", "speed_m_s"),
        (
            case("umzv", Ideal(), designed_for="switched"),
            LENGTH,
            "no_model_to_design_for",
            "designed_for",
        ),
        (
            MapCase(
                plant=CRANE,
                actuator=THESIS,
                shaper=Impulses(times_s=np.zeros(1), amplitudes=np.ones(1)),
                move=Move(pulse_s=2.0),
            ),
            LENGTH,
            "move_of_impulses",
            "move",
        ),
    ],
)
def test_what_does_not_go_together_is_refused(of: MapCase, x: Axis, code: str, field: str) -> None:
    with refused(code, field):
        field_map(of, x)


def test_two_axes_over_one_field_and_a_map_too_large_are_refused() -> None:
    shaper = design(CRANE, THESIS, SHAPERS["numzv"]).impulses
    held = MapCase(plant=CRANE, actuator=THESIS, shaper=shaper)
    with refused("axes_alike", "y.field"):
        field_map(held, LENGTH, LENGTH)
    wide = Axis(path=LENGTH.path, values=np.linspace(0.5, 1.0, 501))
    high = Axis(path=CORNER.path, values=np.linspace(10, 20, 4))
    deep = Axis(path=CORNER.path, values=np.linspace(10, 20, 2000))
    with refused("too_many_cells", "x.points", says=r"of a map of at most 20000 cells"):
        field_map(held, wide, deep)
    with refused("too_many_cells", "x.points", says=r"of a map of at most 2000 cells"):
        field_map(case("numzv"), wide, high)
    with refused("too_many_cells", "x.points", says=r"of a map of at most 500 cells"):
        field_map(case("numzv", move=Move(pulse_s=3.0)), wide)


def test_a_pulse_shorter_than_a_mirrored_start_has_no_command() -> None:
    numzv = SHAPERS["numzv"]
    start_s = design(CRANE, THESIS, numzv).impulses.duration_s
    recipe = Recipe(kind=numzv, options=numzv.options(), each=True, designed_for=None)
    cell = {"plant": CRANE, "actuator": THESIS}
    moves = [Move(pulse_s=ratio * start_s, stop="mirrored") for ratio in (1.01, 0.99)]
    command = design_command(recipe, {**cell, "move": moves[0]})
    assert command.times_s.size == 6
    with refused("pulse_shorter_than_start", says=rf"^the pulse of {0.99 * start_s:g} s"):
        design_command(recipe, {**cell, "move": moves[1]})
