"""Cases of practice: requests as engineers made them, with values computed by scripts of their own.

Each stands for a kind whose tests are elsewhere; here it goes the whole way, through the wire.
"""

import json
import math
from typing import Any

import numpy as np
import pytest

from service.dispatch import respond
from service.problems import Problem

JSON = dict[str, Any]

CRANE: JSON = {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81}
SECOND_ORDER: JSON = {
    "kind": "second_order",
    "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
    "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
}
FIRST_ORDER: JSON = {
    "kind": "first_order",
    "accel_time_constant_s": 0.1,
    "decel_time_constant_s": 0.3,
}
IDEAL: JSON = {"kind": "ideal"}


def mode(hertz: float, damping: float = 0.0) -> JSON:
    return {
        "kind": "mode",
        "natural_frequency_rad_s": 2 * math.pi * hertz,
        "damping_ratio": damping,
    }


def ask(operation: str, **request: Any) -> JSON:
    """Return an answer, as over HTTP."""
    answer = respond(operation, json.dumps(request).encode())
    assert not isinstance(answer, Problem), answer
    read: JSON = json.loads(answer.model_dump_json(by_alias=True))
    return read


def codes(answer: JSON) -> list[str]:
    return [one["code"] for one in answer["warnings"]]


@pytest.mark.parametrize(
    ("kind", "actuator", "residual"),
    [
        ("umzv", FIRST_ORDER, 0.14437),
        ("umzvd", SECOND_ORDER, 0.04315),
    ],
)
def test_a_move_by_a_shaper_that_ignores_the_drive_says_what_it_costs(
    kind: str, actuator: JSON, residual: float
) -> None:
    answer = ask(
        "maneuver",
        plant=CRANE,
        actuator=actuator,
        shaper={"kind": kind},
        speed_m_s=0.4,
        distance_m=2.0,
    )
    assert answer["residual"] == pytest.approx(residual, abs=5e-4)
    assert answer["certificate"]["actuator"] == "ideal"
    assert codes(answer)[0] == "actuator_ignored"
    assert f"{100 * answer['residual']:.4g} %" in answer["warnings"][0]["detail"]


def test_a_move_behind_limits_by_a_shaper_for_an_ideal_drive_knows_the_limits() -> None:
    answer = ask(
        "maneuver",
        plant=CRANE,
        actuator={
            "kind": "rate_limited",
            "accel_limit_m_s2": 0.5,
            "decel_limit_m_s2": 0.5,
            "speed_m_s": 0.4,
        },
        shaper={"kind": "umzv"},
        speed_m_s=0.4,
        distance_m=2.0,
    )
    assert answer["residual"] < 1e-9
    assert answer["certificate"]["actuator"] == "given"
    assert answer["warnings"] == []


@pytest.mark.parametrize(
    ("kind", "hertz", "damping", "sample_time_s"),
    [
        ("sna_zv", 60, 0.0, 0.002),
        ("sna_zv", 1, 0.0, 0.01),
        ("ps_zv", 5, 0.02, 0.01),
        ("ps_zv", 0.3, 0.02, 0.1),
        ("sna_zvd", 5, 0.0, 0.01),
        ("umzv", 60, 0.08, 0.002),
    ],
)
def test_what_samples_cost_is_not_silent(
    kind: str, hertz: float, damping: float, sample_time_s: float
) -> None:
    answer = ask(
        "design",
        plant=mode(hertz, damping),
        actuator=IDEAL,
        shaper={"kind": kind, "sample_time_s": sample_time_s},
    )
    # Amplitudes that are solved for on samples will leave nothing, and then warn of nothing.
    assert ("tolerance_not_kept" in codes(answer)) == (answer["residual"] > 0.01)


@pytest.mark.parametrize("hertz", [11, 15, 23])
def test_a_program_is_designed_on_its_samples(hertz: float) -> None:
    answer = ask(
        "maneuver",
        plant=mode(hertz),
        actuator=IDEAL,
        shaper={"kind": "umzvd"},
        speed_m_s=0.4,
        distance_m=0.42,
        sample_time_s=0.008,
    )
    assert answer["residual"] < 1e-12
    assert answer["program"]["residual"] < 1e-9
    assert answer["program"]["distance_m"] == pytest.approx(0.42, abs=1e-12)
    assert codes(answer) == []


def test_a_shaped_pulse_points_to_a_maneuver() -> None:
    answer = ask(
        "simulation",
        plant=CRANE,
        actuator=SECOND_ORDER,
        shaper={"kind": "numzv"},
        command={"kind": "pulse", "pulse_s": 1.5},
    )
    assert answer["residual"] > 0.1
    assert codes(answer) == ["stop_not_designed"]


def test_a_printer_of_31_hertz_gets_the_textbooks_zvd() -> None:
    found = ask("design", plant=mode(31, 0.15), actuator=IDEAL, shaper={"kind": "zvd"})
    impulses = found["shaper"]["impulses"]
    assert np.cumsum(impulses["amplitudes"])[:2] == pytest.approx([0.380630, 0.853274], abs=5e-7)
    assert impulses["times_s"][1] == pytest.approx(16.3136e-3, abs=5e-8)


def test_an_elevator_keeps_its_tolerance_over_its_stiffness() -> None:
    spring = {"kind": "spring_mass", "mass_kg": 1000, "stiffness_n_m": 4e5}
    over = {"over": "stiffness_n_m", "from": 4e5, "to": 1.2e6}
    found = ask(
        "design",
        plant={"kind": "scheduled", "plant": spring, **over},
        actuator=IDEAL,
        shaper={"kind": "si"},
    )
    assert found["scheduled"]["worst_residual"] <= 0.05 * (1 + 1e-9)
    assert not found["warnings"]


@pytest.mark.parametrize(("shortest_m", "longest_m"), [(2, 6), (1, 10), (0.5, 12)])
def test_a_crane_keeps_its_tolerance_over_its_cable(shortest_m: float, longest_m: float) -> None:
    over = {"over": "cable_length_m", "from": shortest_m, "to": longest_m}
    found = ask(
        "design",
        plant={"kind": "scheduled", "plant": CRANE, **over},
        actuator=SECOND_ORDER,
        shaper={"kind": "si"},
    )
    assert found["scheduled"]["worst_residual"] <= 0.05 * (1 + 1e-9)
    assert found["certificate"]["actuator"] == "given"


def test_a_move_cancels_a_swing_that_the_load_makes_already() -> None:
    answer = ask(
        "maneuver",
        plant=CRANE,
        actuator=SECOND_ORDER,
        shaper={"kind": "numzv"},
        speed_m_s=0.35,
        distance_m=2.0,
        initial={"angle_rad": 0.02, "angle_rate_rad_s": 0.03},
    )
    assert answer["residual"] < 1e-12
    assert answer["distance_m"] == pytest.approx(2.0, abs=1e-12)
    assert answer["certificate"]["actuator"] == "given"


@pytest.mark.parametrize("sample_time_s", [0.004, 0.002])
def test_a_positive_shaper_on_samples_leaves_nothing(sample_time_s: float) -> None:
    found = ask(
        "design",
        plant=mode(1 / 1.5),
        actuator=IDEAL,
        shaper={"kind": "zv", "sample_time_s": sample_time_s},
    )
    samples = np.array(found["shaper"]["impulses"]["times_s"]) / sample_time_s
    assert samples == pytest.approx(np.rint(samples), abs=1e-9)
    assert found["residual"] < 1e-14
    assert not found["warnings"]


@pytest.mark.parametrize("damping", [0.6, 0.707, 0.9])
def test_a_heavily_damped_mode_gets_the_closed_form(damping: float) -> None:
    found = ask("design", plant=mode(1, damping), actuator=IDEAL, shaper={"kind": "zv"})
    k = math.exp(-math.pi * damping / math.sqrt(1 - damping**2))
    assert found["shaper"]["impulses"]["amplitudes"] == pytest.approx([1 / (1 + k), k / (1 + k)])
    assert found["certificate"]["verified"]


def test_a_beam_of_six_modes_gets_sixty_four_impulses() -> None:
    beam = [
        {"natural_frequency_rad_s": float(number**2), "damping_ratio": 0.05}
        for number in range(1, 7)
    ]
    found = ask(
        "design",
        plant={"kind": "modes", "modes": beam},
        actuator=IDEAL,
        shaper={"kind": "convolved"},
        sensitivity=None,
    )
    assert len(found["shaper"]["impulses"]["times_s"]) == 64
    assert found["residual"] < 1e-9
    assert found["certificate"]["verified"]


def test_harmonics_get_two_impulses_and_no_third_of_rounding() -> None:
    harmonics = [{"natural_frequency_rad_s": w, "damping_ratio": 0.0} for w in (15.0, 45.0)]
    found = ask(
        "design",
        plant={"kind": "modes", "modes": harmonics},
        actuator=IDEAL,
        shaper={"kind": "multi_zv"},
    )
    assert found["shaper"]["impulses"]["amplitudes"] == pytest.approx([0.5, 0.5], abs=1e-9)


def test_what_remains_swings_by_the_damped_frequency() -> None:
    answer = ask(
        "simulation",
        plant={"kind": "mode", "natural_frequency_rad_s": 2.0, "damping_ratio": 0.5},
        actuator=IDEAL,
        command={"kind": "step"},
    )
    assert answer["remaining"]["deflection_m"] == pytest.approx(0.57735, abs=5e-6)


def test_an_edge_that_is_none_is_null() -> None:
    answer = ask(
        "sensitivity",
        plant={"kind": "mode", "natural_frequency_rad_s": 3.0},
        actuator=IDEAL,
        impulses={"times_s": [0, 20.943951], "amplitudes": [0.3, 0.3]},
        tolerance=0.7,
    )
    band = answer["sensitivity"]["insensitivity"]
    assert (band["lower_ratio"], band["upper_ratio"], band["width"]) == (None, None, None)
    assert codes(answer) == ["sum_not_one"]


@pytest.mark.parametrize("kind", ["zvdd", "zvddd"])
def test_a_drive_with_a_pole_beside_the_plants_is_certified(kind: str) -> None:
    found = ask(
        "design",
        plant={"kind": "mode", "natural_frequency_rad_s": 1.0, "damping_ratio": 0.08},
        actuator={
            "kind": "second_order",
            "accel": {"natural_frequency_rad_s": 1.0, "damping_ratio": 0.1},
            "decel": {"natural_frequency_rad_s": 1.1, "damping_ratio": 3.0},
        },
        shaper={"kind": kind},
    )
    assert found["certificate"]["verified"]
    assert found["certificate"]["actuator"] == "given"


def test_of_two_values_at_one_time_the_last_counts() -> None:
    about: JSON = {
        "plant": {"kind": "mode", "natural_frequency_rad_s": 3.0, "damping_ratio": 0.02},
        "actuator": {
            "kind": "first_order",
            "accel_time_constant_s": 0.3,
            "decel_time_constant_s": 0.05,
        },
    }
    twice = {"kind": "list", "times_s": [0, 2, 2], "velocity_m_s": [0.5, 1, 0.5]}
    once = {"kind": "list", "times_s": [0], "velocity_m_s": [0.5]}
    answers = [ask("simulation", **about, command=one, until_s=20.0) for one in (twice, once)]
    assert answers[0]["residual"] == pytest.approx(answers[1]["residual"], abs=1e-12)
    assert answers[0]["deflection_m"] == pytest.approx(answers[1]["deflection_m"], abs=1e-12)


def test_polynomials_of_a_shaper_that_ignores_the_drive_say_so() -> None:
    about: JSON = {
        "plant": mode(1, 0.02),
        "shaper": {"kind": "umzv"},
        "fit": {"over": "/plant/natural_frequency_rad_s", "from": 3, "to": 8, "degree": 2},
    }
    assert codes(ask("fit", **about, actuator=FIRST_ORDER)) == ["actuator_ignored"]
    assert codes(ask("fit", **about, actuator=IDEAL)) == []


def test_a_recommendation_on_samples_warns_of_no_tolerance_that_nobody_asked_for() -> None:
    answer = ask(
        "recommendation",
        plant={"kind": "mode", "natural_frequency_rad_s": 6, "damping_ratio": 0.02},
        actuator=IDEAL,
        half_width=0.1,
        tolerance=0.05,
        sample_time_s=0.05,
        sign="positive",
    )
    assert answer["recommended"]["worst_residual"] <= 0.05
    assert "tolerance_not_kept" not in codes(answer["recommended"])


def test_a_refused_speed_ratio_is_the_one_that_was_given() -> None:
    request = {
        "plant": mode(0.6, 0.02),
        "actuator": {
            "kind": "rate_limited",
            "accel_limit_m_s2": 0.5,
            "decel_limit_m_s2": 0.8,
            "speed_m_s": 0.4,
        },
        "shaper": {"kind": "numzv", "max_velocity_ratio": 0.7},
    }
    problem = respond("design", json.dumps(request).encode())
    assert isinstance(problem, Problem)
    assert "got 0.7" in problem.detail
