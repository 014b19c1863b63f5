"""Runs of every plant, and of whole moves, over HTTP: beside other routes, and what is refused."""

import math
from typing import Any

import httpx
import pytest

from tests.service.http.test_runs import BASE, HOIST, MODE, PRESS, ask

COURSE = {"times_s": [0.5, 2.0, 3.0, 6.0], "values": [1.0, 0.7, 0.7, 0.9]}
HOISTING = {"kind": "hoisting", "cable_length_m": COURSE, "gravity_m_s2": 9.81}
DOUBLE = {
    "kind": "double_pendulum",
    "hook_mass_kg": 0.385,
    "load_mass_kg": 0.6,
    "cable_length_m": 0.8,
    "load_length_m": 0.25,
    "gravity_m_s2": 9.81,
}
LINE = {"mode": "delay_line", "shaper": {"kind": "numzv"}}


def whole(at_s: float, kind: str = "numzv", *, x_m: float = 0, y_m: float = 0) -> dict[str, Any]:
    return {"at_s": at_s, "move": {"x_m": x_m, "y_m": y_m}, "shaper": {"kind": kind}}


def test_a_whole_move_is_that_of_a_maneuver(client: httpx.Client) -> None:
    run = ask(client, events=[whole(0.7, "numzvd", x_m=-0.42)])
    body = {**BASE, "shaper": {"kind": "numzvd"}, "distance_m": -0.42}
    del body["points"]
    move = client.post("/v1/maneuvers", json=body).json()
    times = [0.7 + time for time in move["command"]["times_s"]]
    assert run["command"]["x"]["times_s"] == pytest.approx(times, abs=1e-12)
    assert min(run["command"]["x"]["levels"]) == -1
    assert run["history"]["position_m"][-1] == pytest.approx(-0.42, abs=1e-9)
    assert run["residual"] < 1e-8
    assert run["events"][0]["last_switch_s"] == pytest.approx(times[-1])


def test_the_square_by_whole_moves_closes_without_vibration(client: httpx.Client) -> None:
    sides = [
        whole(0.0, x_m=0.42),
        whole(4.0, y_m=0.42),
        whole(8.0, x_m=-0.42),
        whole(12.0, y_m=-0.42),
    ]
    run = ask(client, events=sides)
    assert run["residual"] < 1e-8
    for history in (run["history"], run["history"]["y"]):
        assert history["position_m"][-1] == pytest.approx(0.0, abs=1e-9)
        assert max(history["position_m"]) == pytest.approx(0.42, abs=1e-3)
    large = ask(client, model="nonlinear", events=sides)
    assert large["residual"] < 0.01


@pytest.mark.parametrize("at_s", [0.0, 1.0, 2.5, 7.0])
def test_a_move_on_a_hoisted_cable_is_timed_for_it(client: httpx.Client, at_s: float) -> None:
    run = ask(client, plant=HOISTING, events=[whole(at_s, x_m=0.8)], until_s=20.0)
    assert run["residual"] < 1e-7
    assert run["history"]["position_m"][-1] == pytest.approx(0.8, abs=1e-8)
    assert run["history"]["cable_length_m"][0] == 1.0
    assert run["history"]["cable_length_m"][-1] == 0.9
    # By events the same lengths are hoisted, and the same move is found.
    events = [
        whole(at_s, x_m=0.8),
        {"at_s": 0.5, "cable_length_m": 0.7, "over_s": 1.5},
        {"at_s": 3.0, "cable_length_m": 0.9, "over_s": 3.0},
    ]
    pendulum = {"kind": "pendulum", "cable_length_m": 1.0, "gravity_m_s2": 9.81}
    again = ask(client, plant=pendulum, events=events, until_s=20.0)
    assert again["command"]["x"]["times_s"] == pytest.approx(
        run["command"]["x"]["times_s"], abs=1e-7
    )
    assert again["residual"] < 1e-7


def test_a_command_on_a_hoisted_cable_leaves_what_its_simulation_says(
    client: httpx.Client,
) -> None:
    course = {"times_s": [0, 5], "values": [0.8, 0.5]}
    hoisting = {**HOISTING, "cable_length_m": course, "damping_ratio": 0.02}
    presses = [(0.0, 0.3), (0.6, 3.4), (4.0, 0.25)]
    events = [{"at_s": at_s, "direction": {"x": 1}, "for_s": for_s} for at_s, for_s in presses]
    run = ask(client, plant=hoisting, events=events, until_s=12.0)
    course = run["command"]["x"]
    command = {
        "kind": "list",
        "times_s": course["times_s"],
        "velocity_m_s": [0.2 * level for level in course["levels"]],
    }
    body = {**BASE, "plant": hoisting, "command": command, "until_s": 12.0}
    told = client.post("/v1/simulations", json=body).json()
    for name in ("velocity_m_s", "deflection_m", "angle_rad"):
        assert run["history"][name] == pytest.approx(told[name], abs=1e-9)
    # The run's share is of an unshaped step of the drive on the last length, the simulation's of a
    # sudden one: they differ by the gain of the drive at the pole.
    w, z = math.sqrt(9.81 / 0.5), 0.02
    pole = w * complex(-z, math.sqrt(1 - z**2))
    gain = abs(20**2 / (pole**2 + 2 * 0.8 * 20 * pole + 20**2))
    assert run["residual"] * gain == pytest.approx(told["residual"], rel=1e-8)


def test_the_delay_line_of_a_hoisted_cable_says_its_length(client: httpx.Client) -> None:
    press = [{**PRESS, "for_s": 3.0}]
    first = ask(client, plant=HOISTING, events=press, shaping=LINE)
    (warning,) = first["warnings"]
    assert warning["code"] == "shaper_of_one_length"
    assert "that of 1 m" in warning["detail"]
    assert "within 0.7 and 1 m" in warning["detail"]
    given = ask(client, plant=HOISTING, events=press, shaping={**LINE, "cable_length_m": 1.0})
    assert given["command"] == first["command"]
    other = ask(client, plant=HOISTING, events=press, shaping={**LINE, "cable_length_mm": 850})
    assert "that of 0.85 m" in other["warnings"][0]["detail"]
    assert other["command"] != first["command"]
    # A cable that stays may be shaped for another length too, without a word.
    wrong = ask(client, events=[PRESS], shaping={**LINE, "cable_length_m": 0.5})
    right = ask(client, events=[PRESS], shaping=LINE)
    assert wrong["warnings"] == []
    assert wrong["residual"] > 0.1 > 1e-7 > right["residual"]


@pytest.mark.parametrize("damping_ratio", [0.0, 0.05])
def test_a_double_pendulum_is_a_pendulum_with_a_load(
    client: httpx.Client, damping_ratio: float
) -> None:
    line = {"mode": "delay_line", "shaper": {"kind": "num_multi"}}
    changes = {"events": [PRESS], "shaping": line, "until_s": 6.0}
    run = ask(client, plant={**DOUBLE, "damping_ratio": damping_ratio}, **changes)
    pendulum = {
        "kind": "pendulum",
        "cable_length_m": 0.8,
        "gravity_m_s2": 9.81,
        "damping_ratio": damping_ratio,
    }
    again = ask(client, plant=pendulum, load={"mass_kg": 0.6, "length_m": 0.25}, **changes)
    assert run == again
    assert run["residual"] < 1e-7
    assert run["history"]["angle_rad"] is not None
    if damping_ratio == 0:
        steps = [0, 0.2421622, 0.37058803, 0.54579808, 0.74026527]  # THEORY 11, switched
        assert run["command"]["x"]["times_s"] == pytest.approx(steps, abs=1e-7)
    large = ask(client, plant=DOUBLE, model="nonlinear", **changes)
    assert large["residual"] < 0.05


def test_a_double_pendulum_is_hoisted(client: httpx.Client) -> None:
    run = ask(client, plant=DOUBLE, events=[PRESS, HOIST], shaping=LINE | {
        "shaper": {"kind": "num_multi"}
    })  # fmt: skip
    assert run["history"]["cable_length_m"][-1] == 0.5
    assert [one["code"] for one in run["warnings"]] == ["shaper_of_one_length"]


MODES = {
    "kind": "modes",
    "modes": [{"natural_frequency_rad_s": 3}, {"natural_frequency_rad_s": 7}],
}
SCHEDULED = {
    "kind": "scheduled",
    "plant": {"kind": "pendulum", "cable_length_m": 1},
    "over": "cable_length_m",
    "from": 0.5,
    "to": 1,
}
BODY = {"kind": "free_body", "mass_kg": 1, "modes": [{"natural_frequency_rad_s": 3}]}
MOVE = whole(0.0, x_m=0.42)


@pytest.mark.parametrize(
    ("changes", "code", "pointer", "says"),
    [
        ({"plant": MODES}, "plant_not_run", "/plant/kind", "double_pendulum, hoisting"),
        ({"plant": SCHEDULED}, "plant_not_run", "/plant/kind", "got 'scheduled'"),
        ({"plant": BODY}, "plant_not_run", "/plant/kind", "got 'free_body'"),
        (
            {"plant": DOUBLE, "load": {"mass_kg": 1, "length_m": 1}},
            "load_said_twice",
            "/load",
            "has a hook and a load",
        ),
        (
            {"plant": DOUBLE, "hook_mass_kg": 0.4},
            "load_said_twice",
            "/hook_mass_kg",
            "got 0.4",
        ),
        (
            {"plant": HOISTING, "events": [HOIST]},
            "hoist_said_twice",
            "/events/0/cable_length_m",
            "has the lengths over time",
        ),
        (
            {"plant": MODE, "shaping": {**LINE, "cable_length_m": 1.0}},
            "hoist_needs_cable",
            "/shaping/cable_length_m",
            "no cable",
        ),
        ({"plant": DOUBLE, "events": [MOVE]}, "whole_move_of_two_swings", "/plant/kind", "two"),
        (
            {"events": [MOVE], "load": {"mass_kg": 1, "length_m": 1}},
            "whole_move_of_two_swings",
            "/plant/kind",
            "delay line",
        ),
        (
            {"events": [{**PRESS, "shaper": {"kind": "numzv"}}]},
            "unknown_event",
            "/events/0",
            "got 'direction and shaper'",
        ),
        (
            {"events": [{"at_s": 0, "shaper": {"kind": "numzv"}}]},
            "only_shaped_live",
            "/events/0/shaper",
            "got 'numzv'",
        ),
        (
            {"events": [{**HOIST, "over_s": 0.2}]},
            "faster_than_free_fall",
            "/events",
            "stays taut",
        ),
        (
            {"plant": {**HOISTING, "cable_length_m": {"times_s": [0, 0.1], "values": [1, 1.2]}}},
            "faster_than_free_fall",
            "/plant/cable_length_m",
            "2 m/s after 0 s",
        ),
        ({"events": [{**MOVE, "move": {}}]}, "event_of_no_axis", "/events/0/move", "x or y"),
        ({"events": [{"at_s": 0, "move": {"y_m": 0}}]}, "event_of_no_axis", "/events/0/move", "x"),
        ({"events": [{**PRESS, "direction": {}}]}, "event_of_no_axis", "/events/0/direction", "y"),
        ({"events": [{**MOVE, "for_s": 1}]}, "part_of_other_event", "/events/0/for_s", "direction"),
        (
            {"events": [{**MOVE, **HOIST}]},
            "unknown_event",
            "/events/0",
            "got 'move and cable_length_m'",
        ),
        (
            {"events": [PRESS, {**MOVE, "at_s": 3.0}]},
            "moves_overlap",
            "/events/1/move/x_m",
            "from 0 s for good",
        ),
        (
            {"events": [{**PRESS, "for_s": 2.0}, {**MOVE, "at_s": 2.1}], "shaping": LINE},
            "moves_overlap",
            "/events/1/move/x_m",
            "the tail of its shaper",
        ),
        (
            {"events": [MOVE, {**MOVE, "at_s": 1.0}]},
            "moves_overlap",
            "/events/1/move/x_m",
            "one does from 0 s until 2.7",
        ),
        (
            {"events": [whole(0.0, "zv", x_m=0.42)]},
            "move_not_served",
            "/events/0/shaper/kind",
            "got 'zv'",
        ),
        (
            {"events": [{**MOVE, "shaper": {"kind": "numzv", "sample_time_s": 0.01}}]},
            "kind_not_sampled",
            "/events/0/shaper/sample_time_s",
            "between the samples",
        ),
        (
            {"events": [whole(0.0, y_m=1e9)]},
            "move_too_long",
            "/events/0/move/y_m",
            "500 periods",
        ),
        (
            {"events": [{**MOVE, "shaper": {"kind": "numzvx"}}]},
            "unknown_kind",
            "/events/0/shaper",
            "numzvx",
        ),
    ],
)
def test_what_no_run_does_is_refused(
    client: httpx.Client, changes: dict[str, Any], code: str, pointer: str, says: str
) -> None:
    answer = client.post("/v1/runs", json={**BASE, **changes})
    assert answer.status_code == 422, answer.text
    problem = answer.json()
    assert [(one["code"], one["pointer"]) for one in problem["errors"]] == [(code, pointer)]
    assert says in problem["errors"][0]["detail"]


def test_both_axes_move_whole_beside_presses_of_the_delay_line(client: httpx.Client) -> None:
    events = [
        {**PRESS, "for_s": 2.0},
        whole(4.0, x_m=-0.42, y_m=0.3),
    ]
    run = ask(client, events=events, shaping={"mode": "delay_line", "shaper": {"kind": "zv"}})
    assert run["history"]["y"]["position_m"][-1] == pytest.approx(0.3, abs=1e-9)
    alone = ask(client, events=[whole(4.0, y_m=0.3)])
    assert run["command"]["y"] == alone["command"]["y"]


def test_a_cable_that_would_have_to_push_is_a_warning(client: httpx.Client) -> None:
    quick = {"kind": "first_order", "accel_time_constant_s": 0.01, "decel_time_constant_s": 0.01}
    press = [{**PRESS, "for_s": 0.5}]
    run = ask(client, actuator=quick, speed_m_s=1.0, model="nonlinear", events=press)
    assert [one["code"] for one in run["warnings"]] == ["slack_cable"]
    assert "from 0.5 s on" in run["warnings"][0]["detail"]
    assert ask(client, actuator=quick, speed_m_s=1.0, events=press)["warnings"] == []
