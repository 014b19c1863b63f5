"""The compiled certificate against that of single designs, and against integration."""

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.claims import zeros
from design.formulations.lag_parameters import lag_parameters
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.tables.proofs import proven
from tests.integration_route import residual_by_integration

MODELS: tuple[Model, ...] = ("superposed", "switched")


def left_by(mode: Mode, actuator: Actuator, times: list[float]) -> tuple[float, float]:
    found = proven(
        lag_parameters(mode, actuator)[None],
        np.array([mode.natural_frequency_rad_s]),
        np.array([times]),
        switched=actuator.model == "switched",
        slopes=True,
    )
    return float(found[0, 0]), float(found[0, 1])


def drives(model: Model, rng: np.random.Generator) -> list[Actuator]:
    def one(damping: float) -> SecondOrderSet:
        return SecondOrderSet(
            natural_frequency_rad_s=float(rng.uniform(6, 60)), damping_ratio=damping
        )

    fast, slow = rng.uniform(0.01, 0.3, 2).tolist()
    return [
        Ideal(),
        FirstOrder(accel_time_constant_s=fast, decel_time_constant_s=slow, model=model),
        FirstOrder(accel_time_constant_s=0.0, decel_time_constant_s=slow, model=model),
        FirstOrder(accel_time_constant_s=fast, decel_time_constant_s=0.0, model=model),
        SecondOrder(accel=one(0.3), decel=one(1.7), model=model),
        SecondOrder(accel=one(1.0), decel=one(4.9), model=model),
        SecondOrder(accel=one(1 + 1e-9), decel=one(1 - 1e-5), model=model),
    ]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("steps", [3, 5])
def test_any_command_leaves_what_the_matrix_exponential_says(model: Model, steps: int) -> None:
    rng = np.random.default_rng(steps)
    for _ in range(20):
        mode = Mode(
            natural_frequency_rad_s=float(rng.uniform(1, 5)),
            damping_ratio=float(rng.uniform(0, 0.5)),
        )
        times = [0.0, *np.cumsum(rng.uniform(0.001, 1.0, steps - 1)).tolist()]
        impulses = Impulses(
            times_s=np.array(times), amplitudes=np.resize([1.0, -1.0], steps).astype(float)
        )
        for actuator in drives(model, rng):
            residual, slope = left_by(mode, actuator, times)
            claims = certify(impulses, mode, actuator, zeros(["residual", "slope"])).claims
            # Two lags a hair apart from critical damping cost half of the digits at most.
            assert residual == pytest.approx(claims[0].value, rel=1e-9, abs=1e-11)
            # Differences over a step of 2e-5 lose five digits on either side.
            assert slope == pytest.approx(claims[1].value, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("model", MODELS)
def test_it_agrees_with_plain_integration(model: Model) -> None:
    mode = Mode(natural_frequency_rad_s=2.0, damping_ratio=0.1)
    times = [0.0, 0.3, 0.8, 1.1, 1.9]
    accel = SecondOrderSet(natural_frequency_rad_s=12.0, damping_ratio=0.7)
    decel = SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=1.4)
    actuator = SecondOrder(accel=accel, decel=decel, model=model)
    impulses = Impulses(times_s=np.array(times), amplitudes=np.array([1.0, -1, 1, -1, 1]))
    expected = residual_by_integration(impulses, mode, actuator)
    assert left_by(mode, actuator, times)[0] == pytest.approx(expected, rel=1e-7)
