"""The switched actuator: one state, moved by the set of the latest change of |command|."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from design.analysis.certificate import certify
from design.analysis.residual import residual_vectors, residual_vibration
from design.analysis.residuals_of_many import residual_curve
from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.claims import zeros
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.lag_motions import free_motions
from design.model.lags import Lag
from design.model.plants.mode import Mode
from design.pipeline import design
from design.response.closed_form import history
from design.response.simulated_history import simulated_history
from design.response.simulation import ringing_after
from design.shapers.registry import SHAPERS
from tests.integration_route import integrate, residual_by_integration
from tests.shaper_table import CRANE, DAMPED, THESIS

SWITCHED = replace(THESIS, model="switched")


def random_case(seed: int) -> tuple[Impulses, Mode, Actuator]:
    """Any command through any switched actuator: damping 1 and sets that follow at once too."""
    rng = np.random.default_rng(seed)
    w = float(rng.uniform(0.5, 5.0))
    mode = Mode(natural_frequency_rad_s=w, damping_ratio=float(rng.uniform(0, 0.3)))
    corners = (w * rng.uniform(1.5, 20.0, 2)).tolist()
    actuator: Actuator
    if seed % 3:
        dampings = rng.choice([0.4, 0.8, 1.0, 1 + 1e-7, 1.5, 3.0], 2).tolist()
        accel, decel = (
            SecondOrderSet(natural_frequency_rad_s=corner, damping_ratio=damping)
            for corner, damping in zip(corners, dampings, strict=True)
        )
        actuator = SecondOrder(accel=accel, decel=decel, model="switched")
    else:
        constants = [float(rng.choice([0.0, 1 / corner])) for corner in corners]
        actuator = FirstOrder(
            accel_time_constant_s=constants[0],
            decel_time_constant_s=constants[1],
            model="switched",
        )
    size = int(rng.integers(1, 7))
    impulses = Impulses(
        times_s=np.sort(rng.uniform(0, 3, size)), amplitudes=rng.uniform(-1, 1, size)
    )
    return impulses, mode, actuator


@pytest.mark.parametrize("seed", range(200))
def test_the_formula_agrees_with_the_simulation(seed: int) -> None:
    impulses, mode, actuator = random_case(seed)
    ringing, unit, _ = ringing_after(
        impulses, actuator, np.array([mode.natural_frequency_rad_s]), mode.damping_ratio
    )
    vectors = residual_vectors(impulses, np.array([mode.pole_rad_s]), actuator)
    assert abs(ringing[0] / unit[0] - vectors[0]) < 1e-12  # rounding of a few steps


@pytest.mark.parametrize("seed", range(1, 20))
def test_the_formula_agrees_with_an_integrator(seed: int) -> None:
    impulses, mode, actuator = random_case(seed)
    if isinstance(actuator, SecondOrder):  # the integrator waits for transients to die
        floor = 5 * mode.natural_frequency_rad_s
        sets = [
            replace(part, natural_frequency_rad_s=max(part.natural_frequency_rad_s, floor))
            for part in (actuator.accel, actuator.decel)
        ]
        actuator = SecondOrder(
            accel=replace(sets[0], damping_ratio=0.8),
            decel=replace(sets[1], damping_ratio=1.2),
            model="switched",
        )
    assert residual_vibration(impulses, mode, actuator) == pytest.approx(
        residual_by_integration(impulses, mode, actuator), abs=2e-9
    )


@pytest.mark.parametrize("seed", range(1, 12))
def test_the_history_agrees_with_an_integrator(seed: int) -> None:
    impulses, mode, actuator = random_case(seed)
    end = float(impulses.times_s[-1]) + 0.7
    told = history(impulses, mode, actuator, np.array([end]))
    deflection, _, velocity = integrate(impulses, mode, actuator, end)
    assert told.velocity[0] == pytest.approx(velocity, abs=1e-9)
    # The integrator's deflection is in seconds, for a speed of 1.
    assert told.deflection[0] == pytest.approx(deflection * mode.natural_frequency_rad_s, abs=1e-9)


@given(
    st.floats(0.1, 5.0).flatmap(lambda z: st.sampled_from([z, 1.0, 1 + 1e-9, 1 - 1e-9])),
    st.floats(0.0, 30.0),
)
def test_free_motion_is_the_matrix_exponential(damping: float, phase: float) -> None:
    lag = Lag(first_s=2 * damping / 7.0, second_s2=1 / 49.0)
    matrix = np.array([[0.0, 1.0], [-1.0, -2 * damping]])
    coefficients = np.array(lag.first_s), np.array(lag.second_s2)
    motion = free_motions(*coefficients, np.array(phase / 7.0))
    assert motion == pytest.approx(expm(matrix * phase), abs=1e-12)


def test_equal_sets_make_both_models_one() -> None:
    one = SecondOrderSet(natural_frequency_rad_s=12.0, damping_ratio=0.7)
    both = SecondOrder(accel=one, decel=one), SecondOrder(accel=one, decel=one, model="switched")
    rng = np.random.default_rng(3)
    for _ in range(20):
        impulses = Impulses(times_s=np.sort(rng.uniform(0, 2, 5)), amplitudes=rng.uniform(-1, 1, 5))
        superposed, switched = (residual_vibration(impulses, DAMPED, a) for a in both)
        assert switched == pytest.approx(superposed, abs=1e-13)


def test_the_switched_numzvd_is_that_of_the_reference() -> None:
    # Recomputed independently for Kim 2011's crane, dV/dw exact, to 1e-8 s.
    made = design(CRANE, SWITCHED, SHAPERS["numzvd"])
    assert made.impulses.times_s == pytest.approx(
        [0, 0.18438833, 0.65977743, 1.17966024, 1.31812003], abs=1e-7
    )
    curve = sensitivity(made.impulses, CRANE.mode, SWITCHED, SensitivityRange())
    assert curve.insensitivity is not None
    assert curve.insensitivity.width == pytest.approx(0.25870, abs=1e-5)
    assert made.certificate.verified


@pytest.mark.parametrize(
    ("kind", "leaves"), [("numzvd", 0.0074), ("umzvd", 0.029)], ids=["numzvd", "umzvd"]
)
def test_the_thesis_disagrees_with_itself(kind: str, leaves: float) -> None:
    # Designed by its analysis (superposed), judged by its plant model (switched).
    made = design(CRANE, THESIS, SHAPERS[kind])
    assert residual_vibration(made.impulses, CRANE.mode, SWITCHED) == pytest.approx(
        leaves, rel=0.01
    )


def test_a_superposed_design_does_not_pass_the_switched_certificate() -> None:
    made = design(CRANE, THESIS, SHAPERS["numzvd"])
    assert not certify(made.impulses, CRANE.mode, SWITCHED, zeros(("residual", "slope"))).verified


@pytest.mark.parametrize("kind", ["umzv", "umzvd", "numzv", "numzvd"])
@pytest.mark.parametrize("plant", [CRANE, DAMPED], ids=["crane", "damped"])
@pytest.mark.parametrize("settle", [False, True])
def test_every_shaper_serves_the_switched_model(kind: str, plant: Mode, settle: bool) -> None:
    entry = SHAPERS[kind]
    options = entry.options(settle=True) if settle and "numzv" in kind else None
    made = design(plant, SWITCHED, entry, options)
    assert made.certificate.verified
    if "numzv" in kind:
        assert made.residual < 1e-9


def test_umzvc_serves_the_switched_first_order() -> None:
    actuator = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05, model="switched")
    made = design(CRANE, actuator, SHAPERS["umzvc"])
    assert residual_by_integration(made.impulses, CRANE.mode, actuator) < 1e-8


def test_the_even_curve_is_the_curve_point_by_point() -> None:
    impulses, mode, actuator = random_case(4)
    curve = sensitivity(impulses, mode, actuator, SensitivityRange(points=301))
    assert curve.residuals == pytest.approx(
        residual_curve(impulses, mode, actuator, curve.frequency_ratios), abs=1e-12
    )


@pytest.mark.parametrize("seed", range(30))
@pytest.mark.parametrize("model", ["superposed", "switched"])
def test_the_closed_form_history_is_that_of_matrix_exponentials(seed: int, model: str) -> None:
    impulses, mode, actuator = random_case(seed)
    changed: Any = {"model": model}
    actuator = replace(actuator, **changed)
    times = np.linspace(-0.3, 6.0, 400)
    told = history(impulses, mode, actuator, times)
    again = simulated_history(impulses, mode, actuator, times)
    for name in ("command", "velocity", "deflection"):
        # Rounding, which a repeated pole an ulp apart raises.
        assert getattr(told, name) == pytest.approx(getattr(again, name), abs=1e-9), name
