"""Programs of random moves of all kinds and drives, played by a route that shares no code."""

import numpy as np
import pytest

from design.analysis.claims_found import zeros_of
from design.errors import InfeasibleDesignError, SolverFailedError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.initial_state import DeflectionSwing
from design.model.plants.mode import Mode
from design.moves.maneuvers import maneuver
from design.moves.programs import program
from design.shapers.registry import SHAPERS
from tests import expm_route

SPEED_M_S = 0.4
NOTHING = 1e-9


def drive_of(rng: np.random.Generator, name: str, mode: Mode) -> Actuator:
    """Return a random drive of one sort, in proportion to the plant."""
    w, period_s = mode.natural_frequency_rad_s, mode.period_s
    model: Model = "switched" if rng.random() < 0.5 else "superposed"
    slow_s = 10 ** rng.uniform(-2, 0) / w
    lag = FirstOrder(
        accel_time_constant_s=slow_s,
        decel_time_constant_s=slow_s * rng.uniform(0.5, 2),
        model=model,
    )
    sets = [
        SecondOrderSet(
            natural_frequency_rad_s=w * rng.uniform(2, 9), damping_ratio=rng.uniform(0.4, 1.2)
        )
        for _ in range(2)
    ]
    accel_m_s2, ratio = SPEED_M_S / period_s / rng.uniform(0.03, 0.5), rng.uniform(0.6, 1.6)
    drives: dict[str, Actuator] = {
        "ideal": Ideal(),
        "first": lag,
        "second": SecondOrder(accel=sets[0], decel=sets[1], model=model),
        "limits": RateLimited(
            accel_limit_m_s2=accel_m_s2,
            decel_limit_m_s2=accel_m_s2 * ratio,
            speed_m_s=SPEED_M_S,
            then=lag if rng.random() < 0.5 else Ideal(),
        ),
    }
    return drives[name]


@pytest.mark.parametrize("name", ["ideal", "first", "second", "limits"])
@pytest.mark.parametrize("seed", range(12))
def test_what_a_program_is_told_to_do_it_does(name: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    hertz = 10 ** rng.uniform(-1, 2)
    mode = Mode(natural_frequency_rad_s=2 * np.pi * hertz, damping_ratio=rng.uniform(0, 0.15))
    drive = drive_of(rng, name, mode)
    kinds = ["umzv", "umzvd", "numzv", "numzvd", *(["umzvc"] if name == "first" else [])]
    kind = str(rng.choice(kinds))
    asked_m = SPEED_M_S * rng.uniform(0.3, 6) / hertz * rng.choice([-1, 1])
    swing = None
    if rng.random() < 0.25:
        swing = DeflectionSwing(
            deflection_m=rng.normal() * 0.1 * SPEED_M_S / mode.natural_frequency_rad_s,
            deflection_rate_m_s=rng.normal() * 0.1 * SPEED_M_S,
        )
    try:
        move = maneuver(
            mode, drive, SHAPERS[kind], speed_m_s=SPEED_M_S, distance_m=asked_m, initial=swing
        )
    except (InfeasibleDesignError, SolverFailedError):
        return  # what is no move has no program
    speed_m_s = move.direction * SPEED_M_S
    sample_time_s = mode.period_s / 10 ** rng.uniform(0.6, 2.3)
    found = program(
        move.command, mode, drive, speed_m_s, sample_time_s, move.swing, zeros_of(move.certificate)
    )
    levels = found.velocity_m_s / speed_m_s
    assert levels.min() >= 0
    assert levels.max() <= 1 + 1e-12
    steps = np.diff(levels, prepend=0.0)
    used = np.abs(steps) > 1e-13
    begun = (0.0, 0.0)
    if swing is not None:
        begun = (swing.deflection_m / speed_m_s, swing.deflection_rate_m_s / speed_m_s)
    command = Impulses(times_s=found.times_s[used], amplitudes=steps[used])
    played = expm_route.outcome(command, mode, drive, begun)
    assert found.residual == pytest.approx(played.residual, abs=NOTHING)
    assert found.distance_m == pytest.approx(speed_m_s * played.travel, rel=NOTHING)
    assert found.distance_m == pytest.approx(move.distance_m, rel=NOTHING)
    codes = [warning.code for warning in found.warnings]
    assert ("program_residual" in codes) == (played.residual > NOTHING)
    assert "program_distance" not in codes
