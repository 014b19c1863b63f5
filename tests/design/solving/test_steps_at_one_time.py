"""Steps at one time are one change of the command, and a step of no height is none."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.analysis.residual import residual_vibration
from design.analysis.residuals_of_many import residuals_of_many
from design.claims import zeros
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.merging import merged
from design.model.plants.mode import Mode
from design.moves.playback import motion
from design.response.closed_form import travel
from service.dispatch import respond
from tests.integration_route import residual_by_integration
from tests.refusals import refused

MODE = Mode(natural_frequency_rad_s=3.0, damping_ratio=0.02)
FIRST = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.05)
SECOND = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=9.0, damping_ratio=0.7),
    decel=SecondOrderSet(natural_frequency_rad_s=25.0, damping_ratio=1.2),
)
DRIVES: list[Actuator] = [
    Ideal(),
    FIRST,
    replace(FIRST, model="switched"),
    SECOND,
    replace(SECOND, model="switched"),
    RateLimited(accel_limit_m_s2=2.0, decel_limit_m_s2=3.0, speed_m_s=0.5),
    RateLimited(accel_limit_m_s2=2.0, decel_limit_m_s2=3.0, speed_m_s=0.5, then=FIRST),
    RateLimited(
        accel_limit_m_s2=2.0,
        decel_limit_m_s2=3.0,
        speed_m_s=0.5,
        then=replace(SECOND, model="switched"),
    ),
]


def steps(times: list[float], amplitudes: list[float]) -> Impulses:
    return Impulses(times_s=np.array(times), amplitudes=np.array(amplitudes))


# As given, and the same command with one step for each of its changes.
CASES = {
    "up and down at once": (
        steps([0.0, 2.0, 2.0, 2.4], [0.5, 0.5, -0.5, 0.5]),
        steps([0.0, 2.4], [0.5, 0.5]),
    ),
    "down and up at once": (
        steps([0.0, 1.0, 1.0, 1.7], [1.0, -0.8, 0.4, -0.6]),
        steps([0.0, 1.0, 1.7], [1.0, -0.4, -0.6]),
    ),
    "in three at the start": (
        steps([0.0, 0.0, 0.0, 0.9], [1.0, -0.7, 0.2, -0.5]),
        steps([0.0, 0.9], [0.5, -0.5]),
    ),
    "off by rounding": (
        steps([0.0, 0.3, 0.1 + 0.2, 0.8], [0.5, 0.25, -0.5, -0.25]),
        steps([0.0, 0.3, 0.8], [0.5, -0.25, -0.25]),
    ),
    "no height": (
        steps([0.0, 0.1, 0.5, 0.6, 1.3], [1.0, 0.0, -0.5, 0.0, -0.5]),
        steps([0.0, 0.5, 1.3], [1.0, -0.5, -0.5]),
    ),
    "no height but rounding": (
        steps([0.0, 0.1, 0.5, 1.3], [0.3, 1e-17, 0.2, 0.5]),
        steps([0.0, 0.5, 1.3], [0.3, 0.2, 0.5]),
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_command_is_merged_to_one_step_for_each_change(case: str) -> None:
    given, plain = CASES[case]
    found = merged(given)
    assert found.times_s == pytest.approx(plain.times_s, abs=1e-15)
    assert found.amplitudes == pytest.approx(plain.amplitudes, abs=1e-15)
    assert merged(plain) is plain


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: f"{drive.kind} {drive.model}")
@pytest.mark.parametrize("case", CASES)
def test_merged_or_not_a_command_does_the_same(case: str, drive: Actuator) -> None:
    given, plain = CASES[case]
    assert residual_vibration(given, MODE, drive) == pytest.approx(
        residual_vibration(plain, MODE, drive), abs=1e-13
    )
    assert residuals_of_many(
        given.times_s[None], given.amplitudes, np.array([MODE.pole_rad_s]), drive
    ) == pytest.approx(residual_vibration(plain, MODE, drive), abs=1e-13)
    claims = zeros(["residual", "slope"])
    values = [
        [claim.value for claim in certify(command, MODE, drive, claims).claims]
        for command in (given, plain)
    ]
    assert values[0][0] == pytest.approx(values[1][0], abs=1e-12)
    assert values[0][1] == pytest.approx(values[1][1], abs=1e-9)  # by a difference of 1e-5
    times = np.linspace(-0.1, 4.0, 400)
    moved, expected = (motion(MODE, drive, command, 0.5, times) for command in (given, plain))
    assert moved.velocity_m_s == pytest.approx(expected.velocity_m_s, abs=1e-12)
    assert moved.deflection_m == pytest.approx(expected.deflection_m, abs=1e-12)
    if abs(float(plain.amplitudes.sum())) < 1e-9:
        assert travel(given, drive) == pytest.approx(travel(plain, drive), abs=1e-12)


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: f"{drive.kind} {drive.model}")
def test_the_residual_is_the_one_of_an_integration(drive: Actuator) -> None:
    given, plain = CASES["down and up at once"]
    expected = residual_by_integration(plain, MODE, drive)
    # The integration waits 4.7 s: of a set of 0.3 s it has e^-15.6 left then.
    assert residual_vibration(given, MODE, drive) == pytest.approx(expected, abs=1e-6)


def test_steps_that_all_cancel_are_no_command() -> None:
    with refused("amplitudes_cancel", "amplitudes"):
        merged(steps([1.0, 1.0], [0.5, -0.5]))


LISTED: dict[str, Any] = {"kind": "list", "times_s": [0, 2, 2], "velocity_m_s": [0.5, 1, 0.5]}


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize(
    "command",
    [
        LISTED,
        {"kind": "sampled", "sample_time_s": 0.2, "velocity_m_s": [0.5] * 9},
        {
            "kind": "impulses",
            "impulses": {"times_s": [0, 2, 2], "amplitudes": [0.5, 0.5, -0.5]},
        },
    ],
    ids=lambda command: command["kind"],
)
def test_a_velocity_that_holds_is_one_step_over_the_wire(
    command: dict[str, Any], model: str
) -> None:
    def played(command: dict[str, Any]) -> dict[str, Any]:
        request = {
            "plant": {"kind": "mode", "natural_frequency_rad_s": 3.0, "damping_ratio": 0.02},
            "actuator": {
                "kind": "first_order",
                "accel_time_constant_s": 0.3,
                "decel_time_constant_s": 0.05,
                "model": model,
            },
            "command": command,
            "points": 11,
            "until_s": 6.0,
        }
        told: dict[str, Any] = json.loads(
            respond("simulation", json.dumps(request).encode()).model_dump_json()  # type: ignore[union-attr]
        )
        return told

    plain = played({"kind": "list", "times_s": [0], "velocity_m_s": [0.5]})
    assert plain["residual"] == 0.5
    found = played(command)
    assert {**found, "warnings": []} == {**plain, "warnings": []}
