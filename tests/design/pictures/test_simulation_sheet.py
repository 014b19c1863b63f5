"""The sheet of a simulation: what it shows is what the operation answers."""

import math

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from schemas.simulations import SimulationRequest, SimulationResponse
from service.operations.simulation import OPERATION
from tests.conftest import CRANE
from tests.design.pictures.drawn import collisions, line, lines, panel, words

MODE = {"kind": "mode", "natural_frequency_rad_s": 5.0, "damping_ratio": 0.05}
LONG = {"kind": "pendulum", "cable_length_m": 9.0}
LIMITS = {
    "kind": "rate_limited",
    "accel_limit_m_s2": 0.3,
    "decel_limit_m_s2": 0.4,
    "speed_m_s": 1.0,
}
ALONG = {
    "kind": "first_order",
    "accel_time_constant_s": 0.1,
    "decel_time_constant_s": 0.1,
    "dead_time_s": 0.4,
}
RINGING = {
    "kind": "second_order",
    "accel": {"natural_frequency_rad_s": 5.0, "damping_ratio": 0.1},
    "decel": {"natural_frequency_rad_s": 50.0, "damping_ratio": 1.5},
}
WAVE = [0.1 * math.sin(0.016 * place) for place in range(400)]

REQUESTS = {
    "move": {**CRANE, "command": {"kind": "pulse", "pulse_s": 3.0}, "speed_m_s": 0.2},
    "few points": {
        "plant": CRANE["plant"],
        "actuator": CRANE["actuator"],
        "command": {"kind": "step"},
        "points": 11,
    },
    "dead time": {"plant": MODE, "actuator": ALONG, "command": {"kind": "step"}},
    "limits": {
        "plant": LONG,
        "actuator": {**LIMITS, "dead_time_s": 0.5},
        "shaper": {"kind": "numzvd"},
        "command": {"kind": "pulse", "pulse_s": 8.0},
    },
    "many steps": {
        "plant": CRANE["plant"],
        "actuator": CRANE["actuator"],
        "command": {"kind": "sampled", "sample_time_s": 0.01, "velocity_m_s": WAVE},
    },
    "cut short": {
        "plant": MODE,
        "actuator": {"kind": "ideal"},
        "command": {"kind": "pulse", "pulse_s": 5.0},
        "until_s": 2.0,
    },
    "no motion": {
        "plant": MODE,
        "actuator": {"kind": "ideal"},
        "command": {"kind": "sampled", "sample_time_s": 0.1, "velocity_m_s": [0.1, 0.1]},
        "until_s": 1e-9,
    },
    "rings along": {
        "plant": {**MODE, "damping_ratio": 0.1},
        "actuator": RINGING,
        "command": {"kind": "step"},
    },
}


def drawn(name: str) -> tuple[SimulationResponse, Figure]:
    request = SimulationRequest.model_validate(REQUESTS[name])
    answer = OPERATION.run(request)
    assert isinstance(answer, SimulationResponse)
    return answer, OPERATION.draw(request)


@pytest.mark.parametrize("name", REQUESTS)
def test_the_curves_go_through_every_point_of_the_answer(name: str) -> None:
    answer, figure = drawn(name)
    curves = {
        ("velocity", "command"): answer.command_m_s,
        ("velocity", "velocity"): answer.velocity_m_s,
        ("payload", "deflection"): answer.deflection_m,
    }
    for (where, gid), values in curves.items():
        times, drawn_values = line(figure, where, gid)
        places = np.searchsorted(times, answer.times_s)
        assert times[places].tolist() == answer.times_s
        largest = max(np.abs(values).max(), 1e-300)
        np.testing.assert_allclose(drawn_values[places], values, atol=1e-12 * largest)


@pytest.mark.parametrize("name", ["move", "few points", "dead time", "many steps"])
def test_what_remains_is_the_amplitude_of_the_answer_and_holds_the_payload(name: str) -> None:
    answer, figure = drawn(name)
    assert answer.remaining is not None
    (shade,) = panel(figure, "payload").collections
    assert isinstance(shade, PolyCollection)
    outline = shade.get_paths()[0].vertices
    assert np.asarray(outline)[:, 1].max() == pytest.approx(answer.remaining.deflection_m)
    assert f"{answer.remaining.deflection_m:.3g} m" in words(figure)
    times, deflection = line(figure, "payload", "deflection")
    late = times > times[-1] - 1.0
    assert np.abs(deflection[late]).max() <= answer.remaining.deflection_m * (1 + 1e-3)


@pytest.mark.parametrize("name", REQUESTS)
def test_every_curve_is_within_its_panel(name: str) -> None:
    _, figure = drawn(name)
    for axes in figure.axes:
        low, high = axes.get_ylim()
        for one in (
            one for gid in ("command", "velocity", "deflection") for one in lines(axes, gid)
        ):
            assert low <= np.min(one.get_ydata()) <= np.max(one.get_ydata()) <= high


def test_the_end_of_the_command_is_marked_with_its_dead_time() -> None:
    _, figure = drawn("dead time")
    assert "last switch and dead time, 0.4 s" in words(figure)
    _, cut = drawn("cut short")
    assert "last switch" not in words(cut)


def test_a_pendulum_has_an_axis_of_its_angle() -> None:
    answer, figure = drawn("few points")
    axes = panel(figure, "payload")
    (angle,) = axes.child_axes
    figure.draw_without_rendering()
    assert answer.angle_rad is not None
    per_m = math.degrees(answer.angle_rad[-1] / answer.deflection_m[-1])
    assert angle.get_ylim() == pytest.approx(np.array(axes.get_ylim()) * per_m)
    assert panel(drawn("dead time")[1], "payload").child_axes == []


@pytest.mark.parametrize("name", REQUESTS)
def test_no_text_meets_another_or_leaves_the_page(name: str) -> None:
    _, figure = drawn(name)
    assert collisions(figure) == []
