"""Runs over HTTP: what events do, and what is refused."""

from typing import Any

import httpx
import numpy as np
import pytest

THESIS = {
    "kind": "second_order",
    "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
    "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
    "model": "switched",
}
PENDULUM = {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81}
MODE = {"kind": "mode", "natural_frequency_rad_s": 3.5, "damping_ratio": 0.01}
BASE: dict[str, Any] = {"plant": PENDULUM, "actuator": THESIS, "speed_m_s": 0.2, "points": 201}
PRESS = {"at_s": 0.0, "direction": {"x": 1}}
COURSE = {"times_s": [0.0, 0.1, 0.2], "velocity_m_s": [0.1, 0.2, 0.0]}


def ask(client: httpx.Client, **changes: Any) -> dict[str, Any]:
    answer = client.post("/v1/runs", json={**BASE, **changes})
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def test_a_linear_run_is_the_simulation_of_its_command(client: httpx.Client) -> None:
    shaping = {"mode": "delay_line", "shaper": {"kind": "numzv"}}
    run = ask(client, events=[{**PRESS, "for_s": 2.0}], shaping=shaping, until_s=6.0)
    course = run["command"]["x"]
    command = {
        "kind": "list",
        "times_s": course["times_s"],
        "velocity_m_s": [0.2 * level for level in course["levels"]],
    }
    told = client.post("/v1/simulations", json={**BASE, "command": command, "until_s": 6.0}).json()
    for name in ("times_s", "command_m_s", "velocity_m_s", "deflection_m", "angle_rad"):
        assert run["history"][name] == pytest.approx(told[name], abs=1e-11)
    assert run["residual"] == pytest.approx(told["residual"], abs=1e-9)
    assert run["events"] == [{"at_s": 0.0, "last_switch_s": pytest.approx(course["times_s"][-1])}]
    assert "y" not in run["command"]
    assert "y" not in run["history"]


def test_a_mode_runs_too(client: httpx.Client) -> None:
    run = ask(client, plant=MODE, events=[PRESS], until_s=3.0)
    simulated = {**BASE, "plant": MODE, "command": {"kind": "step"}, "until_s": 3.0}
    told = client.post("/v1/simulations", json=simulated).json()
    assert run["history"]["deflection_m"] == pytest.approx(told["deflection_m"], abs=1e-11)
    assert run["history"]["angle_rad"] is None


def test_the_square_through_strokes_with_sensors(client: httpx.Client) -> None:
    sides = [{"x_m": 0.42}, {"y_m": 0.42}, {"x_m": -0.42}, {"y_m": -0.42}]
    run = ask(
        client,
        model="nonlinear",
        events=[{"at_s": 4.0 * k, "move": side} for k, side in enumerate(sides)],
        strokes={
            "x": {"length_m": 1.3, "start_m": 0.4, "switch_m": 0.05},
            "y": {"length_m": 0.755, "start_mm": 150},
        },
        load={"mass_kg": 0.6, "length_mm": 250},
        max_speed_m_s=1.5,
        camera={"lens": "4mm", "seed": 3},
        encoder={},
    )
    history = run["history"]
    assert history["position_m"][-1] == pytest.approx(0.4, abs=1e-9)
    assert history["y"]["position_m"][-1] == pytest.approx(0.15, abs=1e-9)
    assert max(history["position_m"]) == pytest.approx(0.82, abs=1e-3)
    sensors = run["sensors"]
    pulse_m = 0.1 / 512
    counted = (np.array(sensors["pulses_x"]) + 0.5) * pulse_m
    assert np.abs(counted - history["position_m"]).max() <= pulse_m / 2 * (1 + 1e-9)
    assert len(sensors["pixels_y"]) == 201
    assert run["limit_switches"] == []


def test_a_limit_switch_is_answered_with_a_warning(client: httpx.Client) -> None:
    strokes = {"x": {"length_m": 1.3, "start_m": 0.65, "switch_m": 0.2}}
    run = ask(client, events=[PRESS], strokes=strokes, until_s=5.0)
    (switch,) = run["limit_switches"]
    assert switch["axis"] == "x"
    assert switch["position_m"] == pytest.approx(1.1, abs=1e-9)
    assert [one["code"] for one in run["warnings"]] == ["limit_switch"]


HOIST = {"at_s": 0.0, "cable_length_m": 0.5, "over_s": 1.0}
GAP = {"times_s": [0, 0.1, 0.2, 0.9, 1.0], "velocity_m_s": [0.1] * 5}


@pytest.mark.parametrize(
    ("changes", "code", "pointer", "says"),
    [
        ({"events": [{"at_s": 1.0}]}, "unknown_event", "/events/0", "got 'none'"),
        ({"events": [{**PRESS, "move": {"x_m": 1}}]}, "unknown_event", "/events/0", "and move"),
        ({"events": [{**PRESS, "jump": 1}]}, "extra_forbidden", "/events/0/jump", "no field"),
        (
            {"events": [PRESS, {**PRESS, "direction": {"x": -1}}]},
            "contradictory_buttons",
            "/events/1/direction/x",
            "at 0 s",
        ),
        (
            {
                "events": [PRESS],
                "strokes": {"x": {"length_m": 1.3, "start_m": 1.2}},
                "until_s": 9.0,
            },
            "stroke_exceeded",
            "/events",
            "x = 1.3 m at 0.5",
        ),
        (
            {"events": [{**HOIST, "cable_length_m": -0.1}]},
            "cable_through_zero",
            "/events/0/cable_length_m",
            "through zero",
        ),
        (
            {"events": [HOIST], "max_speed_m_s": 0.25, "until_s": 2.0},
            "hoist_too_fast",
            "/events",
            "0.3 m/s at 0 s",
        ),
        (
            {"events": [PRESS], "speed_m_s": 3.5, "model": "nonlinear"},
            "swing_over_60_degrees",
            "/events",
            "60 degrees",
        ),
        (
            {"load": {"mass_kg": 0.0, "length_m": 0.2}},
            "load_without_mass",
            "/load/mass_kg",
            "without load",
        ),
        ({"played": {"x": GAP}}, "gap_in_times", "/played/x/times_s", "from 0.2 to 0.9 s"),
        (
            {"played": {"x": {**COURSE, "velocity_m_s": [0.1, 0.3, 0.0]}}},
            "played_too_fast",
            "/played/x/velocity_m_s",
            "0.3 m/s at 0.1 s",
        ),
        (
            {"played": {"y": {**COURSE, "velocity_m_s": [0.1, 0.1]}}},
            "times_unlike_values",
            "/played/y/times_s",
            "2 values",
        ),
        (
            {"played": {"y": {"times_s": [0, 1]}}},
            "velocity_or_position",
            "/played/y/velocity_m_s",
            "neither",
        ),
        ({"played": {"x": COURSE}, "events": [PRESS]}, "played_beside_events", "/played/x", "x"),
        ({"events": [{**HOIST, "over_s": None}]}, "hoist_without_time", "/events/0/over_s", "with"),
        ({"events": [{**HOIST, "for_s": 1.0}]}, "part_of_other_event", "/events/0/for_s", "with"),
        (
            {"plant": MODE, "events": [HOIST]},
            "hoist_needs_cable",
            "/events/0/cable_length_m",
            "no cable",
        ),
        ({"plant": MODE, "model": "nonlinear"}, "run_needs_pendulum", "/plant/kind", "pendulum"),
        ({"until_s": 1e6}, "run_too_long", "/until_s", "at most"),
        (
            {"events": [PRESS], "speed_m_s": 2.0, "max_speed_m_s": 1.5},
            "faster_than_axis",
            "/speed_m_s",
            "1.5",
        ),
        (
            {"events": [PRESS], "camera": {"below_m": 0.9}},
            "marker_not_below_camera",
            "/camera/hook_m",
            "below the camera",
        ),
    ],
)
def test_what_no_machine_does_is_refused(
    client: httpx.Client, changes: dict[str, Any], code: str, pointer: str, says: str
) -> None:
    answer = client.post("/v1/runs", json={**BASE, **changes})
    assert answer.status_code == 422, answer.text
    problem = answer.json()
    assert [(one["code"], one["pointer"]) for one in problem["errors"]] == [(code, pointer)]
    assert says in problem["errors"][0]["detail"]


def test_a_course_of_too_many_steps_is_refused(client: httpx.Client) -> None:
    course = {"times_s": (0.001 * np.arange(20_001)).tolist(), "velocity_m_s": [0.1] * 20_001}
    shaping = {"mode": "delay_line", "shaper": {"kind": "zvddd"}}
    body = {**BASE, "actuator": {"kind": "ideal"}, "played": {"x": course, "y": course}}
    answer = client.post("/v1/runs", json={**body, "shaping": shaping})
    assert answer.status_code == 422
    assert answer.json()["code"] == "too_many_shaped_steps"
    assert "200010 steps" in answer.json()["detail"]
