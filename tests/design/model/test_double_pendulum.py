"""A load below a hook: two swings, from the linearised equations of motion."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh

from design.model.plants.double_pendulum import DoublePendulum
from design.model.plants.pendulum import Pendulum
from tests.refusals import refused

CRANE = DoublePendulum(
    hook_mass_kg=0.385,
    load_mass_kg=0.6,
    cable_length_m=0.8,
    load_length_m=0.25,
    gravity_m_s2=9.81,
)


def frequencies(crane: DoublePendulum) -> list[float]:
    return [mode.natural_frequency_rad_s for mode in crane.modes]


def by_eigenvalues(crane: DoublePendulum) -> list[float]:
    """Return the frequencies of ``M q'' + K q = 0``, q the two angles from the vertical."""
    hook, load = crane.hook_mass_kg, crane.load_mass_kg
    cable, sling, g = crane.cable_length_m, crane.load_length_m, crane.gravity_m_s2
    masses = np.array([
        [(hook + load) * cable**2, load * cable * sling],
        [load * cable * sling, load * sling**2],
    ])
    stiffness = np.diag([(hook + load) * g * cable, load * g * sling])
    found: list[float] = np.sqrt(eigh(stiffness, masses, eigvals_only=True)).tolist()
    return found


def test_the_crane_of_the_test_bed_has_its_known_frequencies() -> None:
    assert frequencies(CRANE) == pytest.approx([3.18121, 11.02933], abs=5e-6)


@given(
    masses=st.tuples(st.floats(0.1, 10.0), st.floats(0.1, 10.0)),
    lengths=st.tuples(st.floats(0.1, 10.0), st.floats(0.1, 10.0)),
)
def test_frequencies_are_those_of_the_equations_of_motion(
    masses: tuple[float, float], lengths: tuple[float, float]
) -> None:
    crane = DoublePendulum(
        hook_mass_kg=masses[0],
        load_mass_kg=masses[1],
        cable_length_m=lengths[0],
        load_length_m=lengths[1],
    )
    # The eigenvalues are good to roundings of the larger; the ratio of the two is below 1e4 here.
    assert frequencies(crane) == pytest.approx(by_eigenvalues(crane), rel=1e-9)


def test_a_light_load_leaves_both_pendulums_as_they_are() -> None:
    light = replace(CRANE, load_mass_kg=1e-9)
    alone = [
        Pendulum(cable_length_m=length, gravity_m_s2=9.81).mode.natural_frequency_rad_s
        for length in (0.8, 0.25)
    ]
    assert frequencies(light) == pytest.approx(alone, rel=1e-8)


def test_a_light_hook_leaves_one_pendulum_of_both_lengths() -> None:
    light = replace(CRANE, hook_mass_kg=1e-4)
    alone = Pendulum(cable_length_m=1.05, gravity_m_s2=9.81).mode
    # What the hook still moves is of the order of the ratio of masses.
    assert frequencies(light)[0] == pytest.approx(alone.natural_frequency_rad_s, rel=1e-4)


def test_frequencies_go_with_the_root_of_gravity_over_length() -> None:
    longer = replace(CRANE, cable_length_m=3.2, load_length_m=1.0)
    heavier = replace(CRANE, hook_mass_kg=385.0, load_mass_kg=600.0)
    assert frequencies(longer) == pytest.approx([one / 2 for one in frequencies(CRANE)], rel=1e-14)
    assert frequencies(heavier) == pytest.approx(frequencies(CRANE), rel=1e-14)


def test_both_swings_are_damped_alike() -> None:
    damped = replace(CRANE, damping_ratio=0.03)
    assert [mode.damping_ratio for mode in damped.modes] == [0.03, 0.03]
    assert frequencies(damped) == frequencies(CRANE)


@pytest.mark.parametrize(
    ("changes", "code", "field"),
    [
        ({"load_mass_kg": 0.0}, "not_positive", "load_mass_kg"),
        ({"hook_mass_kg": -1.0}, "not_positive", "hook_mass_kg"),
        ({"cable_length_m": 0.0}, "not_positive", "cable_length_m"),
        ({"load_length_m": float("nan")}, "not_positive", "load_length_m"),
        ({"gravity_m_s2": 0.0}, "not_positive", "gravity_m_s2"),
        ({"damping_ratio": 1.0}, "out_of_range", "damping_ratio"),
        ({"load_mass_kg": 1e6}, "modes_too_far", "load_mass_kg"),
        ({"load_mass_kg": 1e-9, "load_length_m": 0.8}, "modes_too_near", "load_mass_kg"),
    ],
)
def test_what_is_no_such_crane_is_refused(changes: dict[str, Any], code: str, field: str) -> None:
    with refused(code, field):
        replace(CRANE, **changes)


def test_it_has_no_single_mode() -> None:
    with refused("single_mode_only", "plant.kind"):
        _ = CRANE.mode
