"""Steps that settle: as many as it takes, none shorter than it settles, none found faster."""

import cmath
import math

import numpy as np
import pytest
from scipy.optimize import minimize

from design.formulations.gaps import settling_gaps_rad
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.shapers.kind import ShaperKind
from design.shapers.numzv import NUMZV
from design.shapers.numzvd import NUMZVD
from design.shapers.peak_options import PeakOptions
from design.shapers.settle_options import SettleOptions
from design.types import FloatArray
from tests import expm_route
from tests.refusals import refused

DAMPED = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.2)
SLOW = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=4.7, damping_ratio=1.4),
    decel=SecondOrderSet(natural_frequency_rad_s=6.2, damping_ratio=0.8),
)
SWITCHED = SecondOrder(accel=SLOW.accel, decel=SLOW.decel, model="switched")
RAMPS = RateLimited(accel_limit_m_s2=0.5, decel_limit_m_s2=0.2, speed_m_s=0.3, then=Ideal())
POLE = cmath.rect(1.0, math.acos(-0.2))
"""Of `DAMPED`."""


def gain(actuator: Actuator, *, rises: bool) -> complex:
    """Return what a drive makes of a step at the pole, from its differential equation."""
    if isinstance(actuator, RateLimited):
        ramp = 0.3 / (0.5 if rises else 0.2)
        return (1 - cmath.exp(-POLE * ramp)) / (POLE * ramp)
    omega, z = (4.7, 1.4) if rises else (6.2, 0.8)
    return omega**2 / (POLE**2 + 2 * z * omega * POLE + omega**2)


@pytest.mark.parametrize("actuator", [SLOW, RAMPS], ids=["lag", "ramps"])
def test_five_steps_settle_where_three_cannot_and_no_five_found_are_faster(
    actuator: Actuator,
) -> None:
    found = design(DAMPED, actuator, NUMZV, PeakOptions(settle=True)).impulses
    shortest = settling_gaps_rad(DAMPED, actuator, 5, settle=True)
    assert found.times_s.size == 5
    assert (np.diff(found.times_s) >= shortest - 1e-9).all()
    assert expm_route.outcome(found, DAMPED, actuator).residual < 1e-9

    gains = np.array([gain(actuator, rises=k % 2 == 0) for k in range(5)]) * [1, -1, 1, -1, 1]

    def left(gaps: FloatArray) -> FloatArray:
        until_end = np.cumsum(gaps[::-1])[::-1]
        swing = gains @ np.exp(POLE * np.append(until_end, 0.0))
        return np.array([swing.real, swing.imag])

    assert np.abs(left(np.diff(found.times_s))).max() < 1e-9
    rng = np.random.default_rng(5)
    ends = [
        minimize(
            np.sum,
            shortest + rng.exponential(1.0, 4),
            jac=np.ones_like,
            bounds=[(one, 20.0) for one in shortest],
            constraints={"type": "eq", "fun": left},
            method="SLSQP",
        )
        for _ in range(60)
    ]
    durations = [end.fun for end in ends if end.success and np.abs(left(end.x)).max() < 1e-6]
    assert len(durations) > 5
    assert found.duration_s < min(durations) * (1 + 1e-6)


@pytest.mark.parametrize(
    ("kind", "damping", "actuator"),
    [(NUMZV, 0.2, SLOW), (NUMZV, 0.28, SWITCHED), (NUMZV, 0.12, RAMPS), (NUMZVD, 0.12, SLOW)],
)
@pytest.mark.parametrize("distance_m", [30.0, -60.0])
def test_a_move_whose_start_needs_more_steps_arrives_at_rest(
    kind: ShaperKind, damping: float, actuator: Actuator, distance_m: float
) -> None:
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=damping)
    options = (PeakOptions if kind is NUMZV else SettleOptions)(settle=True)
    move = maneuver(mode, actuator, kind, options=options, speed_m_s=0.3, distance_m=distance_m)
    assert move.certificate.verified
    assert not move.for_ideal
    assert move.command.times_s.size > (6 if kind is NUMZV else 10)
    shortest = settling_gaps_rad(mode, actuator, move.command.times_s.size, settle=True)
    assert (np.diff(move.command.times_s) >= shortest - 1e-9).all()
    played = expm_route.outcome(move.command, mode, actuator)
    assert played.residual < 1e-9
    assert math.copysign(0.3 * played.travel, distance_m) == pytest.approx(distance_m, rel=1e-9)


def test_what_no_number_of_steps_does_is_refused_with_what_was_tried() -> None:
    heavy = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.3)
    with refused("no_solution_found", says="nor was one of 5, 7, 9 steps found"):
        design(heavy, RAMPS, NUMZV, PeakOptions(settle=True))
