"""A live session moves the crane as a run does that knows its events beforehand."""

import json
from typing import Any

import numpy as np
import pytest

from schemas.runs import RunRequest
from service.live.session import AHEAD_S, STATES_HZ, Seen, begin, happen, look
from service.operations.run import drive_crane
from service.problems import Problem

CRANE: dict[str, Any] = {
    "plant": {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81},
    "actuator": {
        "kind": "second_order",
        "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
        "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
        "model": "switched",
    },
    "speed_m_s": 0.2,
}

HOISTING = {"kind": "hoisting", "cable_length_m": {"times_s": [0, 5], "values": [0.8, 0.5]}}

SHAPINGS = {
    "none": {"mode": "none"},
    "delay line": {"mode": "delay_line", "shaper": {"kind": "zvd"}},
    "live": {"mode": "live", "shaper": {"kind": "numzv"}},
}

EVENTS: list[dict[str, Any]] = [
    {"at_s": 0.105, "direction": {"x": 1}},
    {"at_s": 0.905, "direction": {"x": 0, "y": -0.5}},
    {"at_s": 1.255, "direction": {"x": 0.5}},
    {"at_s": 2.605, "direction": {"x": 0, "y": 0}},
]

HOIST = {"at_s": 5.005, "cable_length_m": 0.6, "over_s": 1.5}
OTHER_KIND = {"at_s": 1.005, "shaper": {"kind": "numzvd"}}

SAME_M = 1e-9
"""Integrated in other steps: each is exact to some 1e-12 of what it moves [m]."""


def seen(outcome: Seen | Problem) -> Seen:
    assert isinstance(outcome, Seen), outcome
    return outcome


def as_json(value: object) -> bytes:
    return json.dumps(value).encode()


def driven(
    request: dict[str, Any], events: list[dict[str, Any]], until_s: float
) -> dict[float, Any]:
    """Return the states by time of a session that hears of each event as it happens."""
    held = seen(begin(as_json(request)))
    states = dict(held.states)
    for one in events:
        while held.until_s < one["at_s"] + AHEAD_S / 2:  # as a server does that looks ahead
            held = seen(look(held.session, held.until_s + AHEAD_S))
            states |= dict(held.states)
        now = {name: value for name, value in one.items() if name != "at_s"}
        held = seen(happen(held.session, one["at_s"], as_json(now)))
        states = {at_s: state for at_s, state in states.items() if at_s <= one["at_s"]}
        states |= dict(held.states)
    while held.until_s < until_s:
        held = seen(look(held.session, held.until_s + AHEAD_S))
        states |= dict(held.states)
    return {at_s: json.loads(state)["state"] for at_s, state in states.items()}


@pytest.mark.parametrize(
    ("shaping", "more"),
    [
        ("none", [HOIST]),
        ("delay line", []),
        ("delay line", [HOIST]),
        ("live", []),
        ("live", [HOIST]),
        ("live", [OTHER_KIND]),
    ],
)
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
def test_a_session_moves_the_crane_as_a_run_does(
    shaping: str, model: str, more: list[dict[str, Any]]
) -> None:
    request = {**CRANE, "shaping": SHAPINGS[shaping], "model": model}
    events = sorted([*EVENTS, *more], key=lambda one: one["at_s"])
    states = driven(request, events, 8.0)
    count = 8 * STATES_HZ
    whole = RunRequest.model_validate({
        **request,
        "events": events,
        "until_s": 8.0,
        "points": count + 1,
    })
    history = drive_crane(whole).history
    assert sorted(states) == sorted({*np.arange(1, len(states) + 1) / STATES_HZ})
    for number in range(1, count + 1):
        state = states[number / STATES_HZ]
        assert state["at_s"] == pytest.approx(history.times_s[number], abs=1e-12)
        for axis, known in (("x", history), ("y", history.y)):
            for name in ("command_m_s", "velocity_m_s", "position_m", "deflection_m", "angle_rad"):
                assert state[axis][name] == pytest.approx(
                    getattr(known, name)[number], abs=SAME_M
                ), (number, axis, name)


def test_nothing_moves_before_the_first_event() -> None:
    held = seen(begin(as_json(CRANE)))
    (hello,) = held.messages
    assert set(json.loads(hello)) == {"version"}
    assert len(held.states) == STATES_HZ
    assert not held.moving
    for at_s, state in held.states:
        told = json.loads(state)["state"]
        assert (told["at_s"], told["swing"], told["cable_length_m"]) == (at_s, 0.0, 0.8)


def test_the_swing_is_a_share_of_an_unshaped_step() -> None:
    held = seen(happen(seen(begin(as_json(CRANE))).session, 0.0, b'{"direction": {"x": 1}}'))
    for _ in range(3):
        held = seen(look(held.session, held.until_s + AHEAD_S))
    assert json.loads(held.states[-1][1])["state"]["swing"] == pytest.approx(
        1.0, abs=0.006
    )  # to a hundredth of the length


def test_a_crane_moves_until_its_last_switch_and_while_a_button_is_held() -> None:
    shaped = {**CRANE, "shaping": SHAPINGS["delay line"]}
    held = seen(begin(as_json(shaped)))
    held = seen(happen(held.session, 0.5, b'{"direction": {"x": 1}}'))
    assert held.moving
    held = seen(happen(held.session, 3.0, b'{"direction": {"x": 0}}'))
    assert held.moving
    (plan,) = (json.loads(message)["plan"] for message in held.messages)
    assert plan["command"]["x"]["levels"][-1] == 0.0
    assert plan["last_switch_s"] == plan["command"]["x"]["times_s"][-1] == held.last_switch_s
    while held.until_s < held.last_switch_s + 3 * AHEAD_S:
        held = seen(look(held.session, held.until_s + AHEAD_S))
    assert not held.moving


def test_an_event_in_no_more_than_the_past_that_is_kept_happens_then() -> None:
    held = seen(begin(as_json(CRANE)))
    for _ in range(6):
        held = seen(look(held.session, held.until_s + AHEAD_S))
    held = seen(happen(held.session, 0.0, b'{"direction": {"x": 1}}'))
    (plan,) = (json.loads(message)["plan"] for message in held.messages)
    assert plan["at_s"] == pytest.approx(7.0 - 2 * AHEAD_S)


@pytest.mark.parametrize(
    ("first", "code", "told"),
    [
        (b"", None, "the text is empty"),
        (b"[]", "wrong_type", "must be an object"),
        (as_json(CRANE | {"speed_m_s": -1}), "out_of_range", "/speed_m_s"),
        (as_json(CRANE | {"events": EVENTS}), "not_in_live_session", "/events"),
        (as_json(CRANE | {"until_s": 3}), "not_in_live_session", "/until_s"),
        (
            as_json(CRANE | {"plant": HOISTING}),
            "course_in_live_session",
            "/plant/kind",
        ),
        (b'{"plant": 1, "plant": 2}', None, "/plant"),
    ],
)  # fmt: skip
def test_a_first_message_that_is_no_run_is_refused(
    first: bytes, code: str | None, told: str
) -> None:
    refused = begin(first)
    assert isinstance(refused, Problem)
    assert told in refused.detail
    assert code is None or refused.code == code


@pytest.mark.parametrize(
    ("event", "told"),
    [
        (b"", "the text is empty"),
        (b"{}", "must be an event of"),
        (b'{"press": 1}', "/press: is no field here"),
        (b'{"at_s": 1, "direction": {"x": 1}}', "/at_s: is no field here"),
        (b'{"direction": {"x": 1}, "direction": {"x": 0}}', "/direction: must be given once"),
        (b'{"direction": {"x": 1}, "for_s": 1}', "/for_s: must be left out in a live session"),
        (b'{"move": {"x_m": 1}}', "/move: must be left out in a live session"),
        (b'{"direction": {"x": NaN}}', "/direction/x"),
        (b'{"direction": {}}', "/direction"),
        (b'{"cable_length_m": -1, "over_s": 2}', "/cable_length_m"),
        (b'{"stop": "emergency"}', "/stop: must be left out without shaping of mode live"),
        (b'{"stop": "emergency", "swing_left": 2}', "/swing_left: must be between 0 and 1"),
    ],
)
def test_an_event_that_is_none_is_refused_and_changes_nothing(event: bytes, told: str) -> None:
    held = seen(begin(as_json(CRANE)))
    refused = happen(held.session, 0.5, event)
    assert isinstance(refused, Problem)
    assert told in refused.detail


def test_an_emergency_stop_sends_what_a_run_sends() -> None:
    crane = {**CRANE, "shaping": SHAPINGS["live"], "deflection_limit": 0.5}
    events = [EVENTS[0], {"at_s": 2.105, "stop": "emergency", "swing_left": 0.05}]
    states = driven(crane, events, 4.0)
    assert states
    held = seen(begin(as_json(crane)))
    held = seen(happen(held.session, 0.0, b'{"direction": {"x": 1}}'))
    held = seen(happen(held.session, 2.0, b'{"stop": "emergency", "swing_left": 0.05}'))
    (plan,) = (json.loads(message)["plan"] for message in held.messages)
    assert plan["certificate"]["verified"] is True
    assert plan["certificate"]["claims"][0]["limit"] == 0.05
    later = [{"at_s": 0.0, "direction": {"x": 1}}, {**events[1], "at_s": plan["at_s"]}]
    run = drive_crane(RunRequest.model_validate({**crane, "events": later}))
    assert plan["last_switch_s"] == pytest.approx(run.events[1].last_switch_s, abs=1e-9)


def test_a_limit_to_the_deflection_needs_live_mode() -> None:
    refused = begin(as_json(CRANE | {"deflection_limit": 0.5}))
    assert isinstance(refused, Problem)
    assert refused.code == "only_shaped_live"


def test_a_stroke_that_would_be_exceeded_ends_the_session() -> None:
    short = {**CRANE, "strokes": {"x": {"length_m": 0.5, "start_m": 0.4}}}
    held: Seen | Problem = seen(begin(as_json(short)))
    held = happen(seen(held).session, 0.0, b'{"direction": {"x": 1}}')
    assert isinstance(held, Problem)
    assert held.code == "stroke_exceeded"
