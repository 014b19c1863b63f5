"""The sheet of a run: what it shows is what the operation answers."""

import pytest
from matplotlib.figure import Figure

from schemas.runs import AxisHistory, RunRequest, RunResponse
from service.operations.run import OPERATION
from tests.conftest import CRANE
from tests.design.pictures.drawn import collisions, line, panel, words

BASE = {"plant": CRANE["plant"], "actuator": CRANE["actuator"], "speed_m_s": 0.2, "points": 101}
PRESS = {"at_s": 0.0, "direction": {"x": 1}, "for_s": 1.5}

REQUESTS = {
    "one axis": {**BASE, "events": [PRESS]},
    "both axes": {**BASE, "events": [PRESS, {"at_s": 2.0, "move": {"y_m": -0.3}}]},
    "hoisted": {
        **BASE,
        "model": "nonlinear",
        "events": [PRESS, {"at_s": 0.5, "cable_length_m": 0.5, "over_s": 1.5}],
    },
    "whole moves": {
        **BASE,
        "plant": {"kind": "hoisting", "cable_length_m": {"times_s": [0, 5], "values": [0.8, 0.5]}},
        "events": [{"at_s": 0.0, "move": {"x_m": 0.8, "y_m": -0.4}, "shaper": {"kind": "numzv"}}],
    },
    "a double pendulum": {
        **BASE,
        "plant": {
            "kind": "double_pendulum",
            "hook_mass_kg": 0.385,
            "load_mass_kg": 0.6,
            "cable_length_m": 0.8,
            "load_length_m": 0.25,
        },
        "shaping": {"mode": "delay_line", "shaper": {"kind": "multi_zv"}},
        "events": [PRESS],
    },
    "a switch": {
        **BASE,
        "events": [PRESS, {"at_s": 0.1, "direction": {"y": 1}, "for_s": 0.4}],
        "strokes": {"x": {"length_m": 1.0, "start_m": 0.5, "switch_m": 0.4}},
    },
    "nothing": BASE | {"until_s": 2.0},
}


def drawn(name: str) -> tuple[RunResponse, Figure]:
    request = RunRequest.model_validate(REQUESTS[name])
    answer = OPERATION.run(request)
    assert isinstance(answer, RunResponse)
    return answer, OPERATION.draw(request)


@pytest.mark.parametrize("name", REQUESTS)
def test_the_curves_are_those_of_the_answer(name: str) -> None:
    answer, figure = drawn(name)
    axes: list[tuple[str, AxisHistory]] = [("x", answer.history)]
    if answer.history.y is not None:
        axes.append(("y", answer.history.y))
    for axis, history in axes:
        for where, gid, values in (
            ("velocity", f"command_{axis}", history.command_m_s),
            ("velocity", f"velocity_{axis}", history.velocity_m_s),
            ("payload", f"deflection_{axis}", history.deflection_m),
        ):
            times, up = line(figure, where, gid)
            assert times.tolist() == answer.history.times_s
            assert up.tolist() == values
    if answer.history.y is not None:
        across, up = line(figure, "way", "trolley_way")
        assert across.tolist() == answer.history.position_m
        assert up.tolist() == answer.history.y.position_m
    if answer.history.cable_length_m is not None:
        _, length = line(figure, "cable", "cable_length")
        assert length.tolist() == answer.history.cable_length_m


@pytest.mark.parametrize("name", REQUESTS)
def test_no_words_collide(name: str) -> None:
    _, figure = drawn(name)
    assert collisions(figure) == []


def test_the_head_says_what_was_run() -> None:
    answer, figure = drawn("hoisted")
    assert answer.residual is not None
    told = words(figure)
    assert "nonlinear model" in told
    assert f"{100 * answer.residual:.3g} %" in told
    assert panel(figure, "payload").get_ylabel() == "deflection [m]"


def test_a_limit_switch_is_said_below_the_head() -> None:
    _, figure = drawn("a switch")
    assert "limit switch" in words(figure)
