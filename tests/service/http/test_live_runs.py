"""Runs in live mode over HTTP: what each event led to, and what is refused."""

import math
from typing import Any

import httpx
import pytest

from tests.service.http.test_runs import BASE, COURSE, MODE, PRESS, ask

LIVE = {"mode": "live", "shaper": {"kind": "numzv"}}
EVENTS = [
    PRESS,
    {"at_s": 0.83, "direction": {"x": 0}},
    {"at_s": 1.2, "direction": {"x": -1, "y": 1}, "for_s": 0.7},
]
LIMITED = {
    "kind": "rate_limited",
    "accel_limit_m_s2": 1.0,
    "decel_limit_m_s2": 1.0,
    "speed_m_s": 0.2,
}
STOP = {"at_s": 3.0, "stop": "emergency"}
LOADED = {"mass_kg": 0.6, "length_m": 0.25}


def test_a_live_run_comes_to_rest_with_a_certificate_for_each_event(client: httpx.Client) -> None:
    run = ask(client, events=EVENTS, shaping=LIVE)
    assert [event["at_s"] for event in run["events"]] == [0.0, 0.83, 1.2]
    for event in run["events"]:
        assert event["certificate"]["verified"] is True
        assert event["certificate"]["actuator"] == "given"
        assert event["fallback"] is None
    assert run["events"][0]["last_switch_s"] == pytest.approx(0.6006, abs=1e-4)
    assert run["events"][1]["last_switch_s"] == pytest.approx(0.83 + 0.5945, abs=1e-3)
    last = max(run["command"][axis]["times_s"][-1] for axis in ("x", "y"))
    assert run["events"][2]["last_switch_s"] == last
    assert run["residual"] < 1e-9
    levels = [one for axis in ("x", "y") for one in run["command"][axis]["levels"]]
    assert set(levels) <= {-1.0, 0.0, 1.0}


def test_the_linear_command_is_played_on_the_nonlinear_crane(client: httpx.Client) -> None:
    linear, large = (
        ask(client, events=EVENTS, shaping=LIVE, model=model) for model in ("linear", "nonlinear")
    )
    assert large["command"] == linear["command"]
    assert 1e-6 < large["residual"] < 0.01


def test_a_load_under_the_hook_is_shaped_in_both_modes(client: httpx.Client) -> None:
    shaping = {"mode": "live", "shaper": {"kind": "num_multi"}}
    run = ask(client, events=EVENTS[:2], shaping=shaping, load=LOADED)
    claims = run["events"][1]["certificate"]["claims"]
    assert [claim.get("mode", 0) for claim in claims] == [0, 1]
    assert run["residual"] < 1e-9


def test_another_kind_serves_the_events_from_then_on(client: httpx.Client) -> None:
    events = [
        PRESS,
        {"at_s": 0.3, "shaper": {"kind": "numzvd"}},
        {"at_s": 2.0, "direction": {"x": 0}},
        {"at_s": 5.0, "shaper": {"kind": "umzv"}},
        {"at_s": 5.0, "direction": {"x": 1}},
    ]
    run = ask(client, events=events, shaping=LIVE)
    assert [event["certificate"]["actuator"] for event in run["events"]] == [
        *["given"] * 3,
        *["ideal"] * 2,
    ]
    claimed = [
        {one["quantity"] for one in event["certificate"]["claims"]} for event in run["events"]
    ]
    assert claimed[:3] == [{"residual"}, {"residual", "slope"}, {"residual", "slope"}]
    sent = run["command"]["x"]["times_s"]
    assert sum(2.0 <= at_s < 5.0 for at_s in sent) == 5
    assert sum(at_s >= 5.0 for at_s in sent) == 3
    alone = ask(client, events=[PRESS], shaping=LIVE)["events"][0]
    assert run["events"][0]["last_switch_s"] == alone["last_switch_s"]


def test_a_shaper_for_an_ideal_drive_says_so(client: httpx.Client) -> None:
    run = ask(client, events=EVENTS[:2], shaping={"mode": "live", "shaper": {"kind": "umzv"}})
    assert {event["certificate"]["actuator"] for event in run["events"]} == {"ideal"}
    assert run["residual"] > 0.01


def test_an_emergency_stop_brings_both_axes_to_rest_within_a_period(client: httpx.Client) -> None:
    events = [{"at_s": 0.0, "direction": {"x": 1, "y": -1}}, {**STOP, "swing_left": 0.05}]
    run = ask(client, events=events, shaping=LIVE)
    told = run["events"][1]
    assert told["certificate"]["verified"] is True
    assert told["fallback"] is None
    assert told["certificate"]["claims"][0]["value"] == pytest.approx(0.05, abs=1e-9)
    assert told["certificate"]["claims"][0]["limit"] == 0.05
    # The root of the energies of two axes, alike.
    assert run["residual"] == pytest.approx(0.05 * 2**0.5, rel=1e-6)
    assert 3.0 < told["last_switch_s"] <= 3.0 + 2 * math.pi / 3.5
    assert min(run["command"]["x"]["levels"]) == 0.0
    assert max(run["command"]["y"]["levels"]) == 0.0


def test_a_start_keeps_a_limit_to_the_deflection_on_the_rig(client: httpx.Client) -> None:
    events = [PRESS, {"at_s": 3.0, "direction": {"x": 0}}]
    run = ask(client, events=events, shaping=LIVE, deflection_limit=0.4)
    unshaped = ask(client, events=events[:1], shaping={"mode": "none"})
    for event in run["events"]:
        assert event["certificate"]["verified"] is True
        assert [one["quantity"] for one in event["certificate"]["claims"]][-1] == "deflection"
        assert event["certificate"]["claims"][-1]["value"] <= 0.4
    largest, swing = (max(map(abs, one["history"]["deflection_m"])) for one in (run, unshaped))
    # A step swings by the drive's gain, and a little above it while the drive comes to speed.
    assert largest <= 0.4 * swing * 1.01
    assert run["residual"] < 1e-8


def test_events_without_live_mode_are_told_as_before(client: httpx.Client) -> None:
    run = ask(client, events=EVENTS[:2])
    assert run["events"][0] == {"at_s": 0.0, "last_switch_s": 0.0}


HOIST = {"at_s": 0.4, "cable_length_m": 0.5, "over_s": 2.0}


def test_presses_while_the_cable_is_hoisted_leave_nothing(client: httpx.Client) -> None:
    events = [PRESS, HOIST, *EVENTS[1:], {"at_s": 2.1, "direction": {"x": 1}, "for_s": 0.5}]
    run = ask(client, events=events, shaping=LIVE)
    assert all(event["certificate"]["verified"] for event in run["events"])
    assert [event["fallback"] for event in run["events"]] == [None] * 5
    assert run["events"][1]["last_switch_s"] == pytest.approx(2.4)
    assert run["residual"] < 1e-9
    delayed = ask(client, events=events, shaping={**LIVE, "mode": "delay_line"})
    assert delayed["residual"] > 0.01


@pytest.mark.parametrize(
    ("changes", "code", "pointer", "says"),
    [
        ({"actuator": LIMITED}, "drive_not_live", "/actuator/kind", "delay line"),
        (
            {"shaping": {"mode": "live", "shaper": {"kind": "zv"}}},
            "kind_not_live",
            "/shaping/shaper/kind",
            "numzv, numzvd, num_multi, umzv",
        ),
        (
            {"shaping": {"mode": "live", "shaper": {"kind": "numzv", "settle": True}}},
            "option_not_live",
            "/shaping/shaper/settle",
            "live mode",
        ),
        (
            {"shaping": {"mode": "live", "shaper": {"kind": "numzv", "sample_time_s": 0.01}}},
            "option_not_live",
            "/shaping/shaper/sample_time_s",
            "live mode",
        ),
        (
            {"shaping": {**LIVE, "sample_time_s": 0.9}},
            "event_within_sample",
            "/events/1/at_s",
            "0.9 s",
        ),
        ({"played": {"y": COURSE}}, "not_shaped_live", "/played", "delay line"),
        (
            {"events": [{"at_s": 0.0, "move": {"x_m": 0.4}}]},
            "not_shaped_live",
            "/events/0/move",
            "delay line",
        ),
        (
            {"events": [PRESS, {"at_s": 0.0, "direction": {"x": -1}}]},
            "contradictory_buttons",
            "/events/1/direction/x",
            "only command",
        ),
        ({"speed_m_s": 6.0}, "swing_beyond_model", "/events/2/at_s", "does not hold"),
        ({"deflection_limit": -0.5}, "out_of_range", "/deflection_limit", "0.05 and 10"),
        (
            {"deflection_limit": 0.5, "shaping": {"mode": "live", "shaper": {"kind": "numzvd"}}},
            "kind_not_with_deflection_limit",
            "/shaping/shaper/kind",
            "num_multi without slope",
        ),
        (
            {"deflection_limit": 0.5, "shaping": {"mode": "none"}},
            "only_shaped_live",
            "/deflection_limit",
            "mode live",
        ),
        (
            {"events": [PRESS, STOP], "shaping": {"mode": "none"}},
            "only_shaped_live",
            "/events/1/stop",
            "mode live",
        ),
        (
            {"events": [PRESS, {**STOP, "swing_left": 1.0}]},
            "out_of_range",
            "/events/1/swing_left",
            "between 0 and 1",
        ),
        (
            {"events": [PRESS, {**STOP, "within_periods": 0.0}]},
            "out_of_range",
            "/events/1/within_periods",
            "between 0.05 and 8",
        ),
        (
            {"events": [{**PRESS, "swing_left": 0.1}]},
            "part_of_other_event",
            "/events/0/swing_left",
            "without stop",
        ),
        (
            {"events": [{**PRESS, "stop": "emergency"}]},
            "unknown_event",
            "/events/0",
            "direction and stop",
        ),
        (
            {"events": [{**HOIST, "over_s": None}]},
            "hoist_without_time",
            "/events/0/over_s",
            "cable_length_m",
        ),
        (
            {"events": [{**HOIST, "over_s": 0.01}]},
            "faster_than_free_fall",
            "/events",
            "stays taut",
        ),
        (
            {"events": [{**HOIST, "cable_length_m": -0.1}]},
            "cable_through_zero",
            "/events/0/cable_length_m",
            "through zero",
        ),
        (
            {"events": [HOIST], "shaping": {"mode": "live", "shaper": {"kind": "numzvd"}}},
            "kind_not_hoisted_live",
            "/events/0/cable_length_m",
            "numzv alone",
        ),
        ({"events": [HOIST], "load": LOADED}, "hoist_not_live", "/events/0/cable_length_m", "line"),
        ({"plant": MODE, "events": [{"at_s": 0.0}]}, "unknown_event", "/events/0", "direction"),
        (
            {"events": [PRESS, {"at_s": 1.0, "shaper": {"kind": "zvd"}}]},
            "kind_not_live",
            "/events/1/shaper/kind",
            "numzv",
        ),
        (
            {"events": [PRESS, {"at_s": 1.0, "shaper": {"kind": "numzv", "settle": True}}]},
            "option_not_live",
            "/events/1/shaper/settle",
            "left out in live mode",
        ),
        (
            {"events": [HOIST, {"at_s": 1.0, "shaper": {"kind": "numzvd"}}]},
            "kind_not_hoisted_live",
            "/events/1/shaper/kind",
            "numzv alone",
        ),
        (
            {"events": [{"at_s": 1.0, "shaper": {"kind": "numzvd"}}], "deflection_limit": 0.5},
            "kind_not_with_deflection_limit",
            "/events/0/shaper/kind",
            "with deflection_limit",
        ),
        (
            {"events": [{"at_s": 1, "shaper": {"kind": "zv"}}], "shaping": {"mode": "none"}},
            "only_shaped_live",
            "/events/0/shaper",
            "got 'zv'",
        ),
    ],
)
def test_what_is_not_served_live_is_refused(
    client: httpx.Client, changes: dict[str, Any], code: str, pointer: str, says: str
) -> None:
    body = {**BASE, "events": EVENTS, "shaping": LIVE, **changes}
    answer = client.post("/v1/runs", json=body)
    assert answer.status_code == 422, answer.text
    problem = answer.json()
    assert [(one["code"], one["pointer"]) for one in problem["errors"]] == [(code, pointer)]
    assert says in problem["errors"][0]["detail"]
