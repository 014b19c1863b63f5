"""A cable that is hoisted, over HTTP: moves, simulations, pictures, and refusals elsewhere."""

from typing import Any

import numpy as np
import pytest

from schemas.maneuvers import ManeuverRequest
from schemas.simulations import SimulationRequest
from service.operations.maneuver import move_picture
from service.operations.move_file import move_file
from service.operations.simulation import simulation_picture
from tests.conftest import CRANE
from tests.design.pictures.drawn import lines, panel, points
from tests.refusals import refused
from tests.service.http.in_process import InProcess

HOISTING: dict[str, Any] = {
    "kind": "hoisting",
    "cable_length_m": {"times_s": [0, 5], "values": [0.8, 0.5]},
    "gravity_m_s2": 9.81,
}
DRIVE = {**CRANE["actuator"], "model": "switched"}
MOVE: dict[str, Any] = {
    "plant": HOISTING,
    "actuator": DRIVE,
    "shaper": {"kind": "numzv"},
    "speed_m_s": 0.2,
    "pulse_s": 4.0,
}
PULSE: dict[str, Any] = {
    "plant": HOISTING,
    "actuator": DRIVE,
    "command": {"kind": "pulse", "pulse_s": 4.0},
    "speed_m_s": 0.2,
    "points": 101,
}


def asked(path: str, body: dict[str, Any]) -> dict[str, Any]:
    answer = InProcess().ask("POST", f"/v1/{path}", body)
    document: dict[str, Any] = answer.json()
    return document


def fault(path: str, body: dict[str, Any]) -> tuple[str, str]:
    (first, *_) = asked(path, body)["errors"]
    return first["pointer"], first["code"]


def test_a_stop_is_re_timed_to_the_figures_of_the_theory() -> None:
    move = asked("maneuvers", {**MOVE, "retime": "stop"})
    assert move["command"]["times_s"][3:] == pytest.approx([4.0, 4.21401809, 4.48326774], abs=6e-9)
    assert move["residual"] <= 1e-10
    assert move["certificate"]["verified"] is True
    assert "Radau" in move["certificate"]["method"]


def test_the_simulated_move_swings_no_more_and_the_unshaped_one_does() -> None:
    move = asked("maneuvers", MOVE)
    shaped = asked(
        "simulations", {**PULSE, "command": {"kind": "impulses", "impulses": move["command"]}}
    )
    unshaped = asked("simulations", PULSE)
    assert shaped["residual"] <= 1e-9 < unshaped["residual"]
    assert abs(shaped["deflection_m"][-1]) < 1e-9
    last = np.array(unshaped["deflection_m"][-5:]) / 0.5
    assert unshaped["angle_rad"][-5:] == pytest.approx(last.tolist(), rel=1e-12)
    # The residual is over v / w on the last length.
    w = np.sqrt(9.81 / 0.5)
    assert unshaped["remaining"]["deflection_m"] == pytest.approx(
        unshaped["residual"] * 0.2 / w, rel=1e-12
    )


def test_a_cable_that_stays_is_simulated_as_a_pendulum() -> None:
    still = {**HOISTING, "cable_length_m": {"times_s": [0, 1], "values": [0.8, 0.8]}}
    pendulum = {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81}
    found, expected = (
        asked("simulations", {**PULSE, "plant": plant, "until_s": 9.0})
        for plant in (still, pendulum)
    )
    for name in ("times_s", "command_m_s", "velocity_m_s", "deflection_m", "angle_rad"):
        assert found[name] == pytest.approx(expected[name], abs=1e-12)
    for name in ("deflection_m", "angle_rad"):
        assert found["remaining"][name] == pytest.approx(expected["remaining"][name], rel=1e-11)


@pytest.mark.parametrize(
    ("changes", "pointer", "code"),
    [
        ({"joint": True}, "/joint", "not_while_hoisting"),
        ({"sample_time_s": 0.01}, "/sample_time_s", "not_while_hoisting"),
        (
            {"initial": {"angle_rad": 0.1, "angle_rate_rad_s": 0.0}},
            "/initial",
            "not_while_hoisting",
        ),
        ({"plant": CRANE["plant"], "retime": "stop"}, "/retime", "retime_without_hoisting"),
        (
            {"plant": {**HOISTING, "cable_length_m": {"times_s": [0], "values": [0.8]}}},
            "/plant/cable_length_m/values",
            "course_without_change",
        ),
        (
            {"plant": {**HOISTING, "cable_length_m": {"times_s": [0, 5], "values": [0.8, -0.1]}}},
            "/plant/cable_length_m/values/1",
            "hoisted_through_zero",
        ),
    ],
)
def test_what_a_move_does_not_take_is_refused_by_field(
    changes: dict[str, Any], pointer: str, code: str
) -> None:
    assert fault("maneuvers", {**MOVE, **changes}) == (pointer, code)


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("designs", {"shaper": {"kind": "numzv"}}),
        ("sensitivity", {"impulses": {"times_s": [0, 0.9], "amplitudes": [0.5, 0.5]}}),
        ("recommendations", {}),
        ("recommendations", {"firmware": "klipper"}),
        ("maps", {"shaper": {"kind": "zv"},
                  "x": {"field": "/plant/damping_ratio", "from": 0, "to": 0.1, "points": 3}}),
        ("simulations", {"shaper": {"kind": "numzv"}, "command": {"kind": "step"}}),
    ],
)  # fmt: skip
def test_where_a_plant_must_stay_the_refusal_names_what_to_give(
    path: str, body: dict[str, Any]
) -> None:
    refusal = asked(path, {"plant": HOISTING, "actuator": DRIVE, **body})
    (first, *_) = refusal["errors"]
    assert (first["pointer"], first["code"]) == ("/plant/kind", "plant_that_changes")
    assert "Give a maneuver" in first["detail"]


def test_a_simulation_ends_within_a_thousand_swings() -> None:
    late = {**PULSE, "until_s": 3000.0}
    assert fault("simulations", late) == ("/until_s", "too_long_after_hoisting")


def test_lengths_in_millimetres_are_lengths() -> None:
    given = {**HOISTING}
    given["cable_length_mm"] = {"times_s": [0, 5], "values": [800, 500]}
    del given["cable_length_m"]
    found, expected = asked("maneuvers", {**MOVE, "plant": given}), asked("maneuvers", MOVE)
    assert found["command"] == expected["command"]
    in_metres = {**HOISTING, "cable_length_m": {"times_s": [0, 5], "values": [800, 500]}}
    warned = asked("maneuvers", {**MOVE, "plant": in_metres})
    assert [one["code"] for one in warned["warnings"]].count("implausible_value") == 2


def test_blocks_for_controllers_are_refused() -> None:
    request = ManeuverRequest.model_validate(MOVE)
    with refused("not_while_hoisting", "format"):
        move_file(request, "st")


def test_the_sheet_of_a_move_draws_the_payload_until_all_is_over() -> None:
    figure = move_picture(ManeuverRequest.model_validate(MOVE))
    (shaped,) = lines(panel(figure, "payload"), "shaped")
    times_s, deflection_m = points(shaped)
    assert times_s[-1] >= 5.0
    assert np.abs(deflection_m[times_s > 5.0]).max() <= 1e-4  # the drive is still settling
    assert np.abs(deflection_m).max() > 0.01


def test_the_sheet_of_a_simulation_bounds_what_remains_after_the_hoisting() -> None:
    figure = simulation_picture(SimulationRequest.model_validate(PULSE))
    axes = panel(figure, "payload")
    (deflection,) = lines(axes, "deflection")
    times_s, deflection_m = points(deflection)
    band = next(one for one in axes.collections if one.get_gid() == "remains")
    corners = np.asarray(band.get_paths()[0].vertices)
    assert corners[:, 0].min() == pytest.approx(5.0)
    ringing = np.abs(deflection_m[times_s > 5.5]).max()
    assert corners[:, 1].max() == pytest.approx(ringing, rel=1e-3)
