"""Every kind of shaper over all damping ratios: what is designed holds, what is not is refused."""

import math
import re
from typing import Any

import numpy as np
import pytest

from design.analysis.damping_curve import DampingRange
from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.errors import InfeasibleDesignError, InvalidInputError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.scheduled import Scheduled
from design.pipeline import design
from design.shapers.ei import ToleranceOptions
from design.shapers.positive import MzvOptions
from design.shapers.registry import SHAPERS
from design.shapers.several_modes import ConvolvedOptions
from tests.refusals import refused
from tests.second_route import claims_by_formula
from tests.shaper_table import FIRST_ORDER, IDEAL, SHAPER_TABLE

HEAVY = (0.5, 0.6, 0.707, 0.8, 0.88, 0.9, 0.95, 0.99)

NOTHING = 1e-9
"""Residual that counts as none [-]."""

TO_BOUND = {
    "zv": 0.99,
    "zvd": 0.97,
    "zvdd": 0.94,
    "zvddd": 0.91,
    "umzv": 0.97,
    "umzvd": 0.9,
    "ps_zv": 0.97,
    "ps_zvd": 0.88,
    "sna_zv": 0.97,
    "sna_zvd": 0.9,
}
"""Kinds that exist up to a damping ratio, and no further as numbers."""

SURE = {
    **TO_BOUND,
    "mzv": 0.95,
    "ei": 0.6,
    "um_ei": 0.707,
    "um_2ei": 0.6,
    "numzv": 0.9,
    "numzvd": 0.9,
    "num_ei": 0.707,
    "num_2ei": 0.6,
    "si": 0.9,
    "multi_zv": 0.95,
    "multi_umzv": 0.95,
    "num_multi": 0.9,
    "multi_si": 0.9,
    "convolved": 0.99,
}
"""Up to where each is designed for an ideal actuator with its usual parameters."""


def _mode(damping_ratio: float) -> Mode:
    return Mode(natural_frequency_rad_s=4.0, damping_ratio=damping_ratio)


@pytest.mark.parametrize("z", [0.6, 0.99])
@pytest.mark.parametrize("name", SHAPER_TABLE)
def test_a_heavily_damped_plant_gets_what_is_claimed_or_a_reason(name: str, z: float) -> None:
    require_what_is_claimed_or_a_reason(name, z)


def require_what_is_claimed_or_a_reason(name: str, z: float) -> None:
    """Residuals by the sum of steps at the pole; refusals with the damping or what was searched."""
    row = SHAPER_TABLE[name]
    for actuator in (one for one in (IDEAL, FIRST_ORDER) if one in row.actuators):
        refusal = ""
        try:
            made = design(_mode(z), actuator, SHAPERS[name], row.options[0])
        except (InfeasibleDesignError, InvalidInputError) as error:
            refusal = str(error)
        if refusal:
            assert re.search(rf"{name}|duration <=|within|takes|faster|shorter", refusal)
            assert re.search(r"\d", refusal)
            continue
        assert made.certificate.verified
        kept = [one for one in made.certificate.claims if one.quantity == "residual"]
        left = _residual(made.impulses, z, IDEAL if made.for_ideal else actuator)
        assert all(left <= claim.limit * (1 + 2e-9) for claim in kept)


def _residual(impulses: Any, z: float, actuator: Actuator) -> float:
    return claims_by_formula(impulses, _mode(z), actuator)["residual"]


@pytest.mark.parametrize("name", SURE)
def test_kinds_are_designed_up_to_the_damping_that_they_are_known_to_bear(name: str) -> None:
    options = SHAPER_TABLE[name].options[0]
    for z in (*(z for z in HEAVY if z < SURE[name]), SURE[name]):
        assert design(_mode(z), Ideal(), SHAPERS[name], options).certificate.verified


@pytest.mark.parametrize("name", TO_BOUND)
def test_beyond_its_bound_a_kind_is_refused_by_name(name: str) -> None:
    kind, bound = SHAPERS[name], TO_BOUND[name]
    assert kind.damping.most == bound
    if bound == MAX_DAMPING_RATIO:
        return
    rule = rf"^plant.damping_ratio must be at most {bound:g} for {name}: beyond it its last .*, got"
    with refused("too_damped_for_kind", "plant.damping_ratio", says=rule):
        design(_mode(bound + 0.001), Ideal(), kind)


@pytest.mark.parametrize("z", [0.6, 0.707, 0.9, 0.99])
def test_zv_is_k_over_1_plus_k_at_any_damping(z: float) -> None:
    made = design(_mode(z), FirstOrder(accel_time_constant_s=0.01, decel_time_constant_s=0.02),
                  SHAPERS["zv"]).impulses  # fmt: skip
    k = math.exp(-math.pi * z / math.sqrt(1 - z * z))
    assert np.abs(made.amplitudes - np.array([1, k]) / (1 + k)).max() <= 1e-15
    half_period_s = math.pi / (4.0 * math.sqrt(1 - z * z))
    assert abs(made.times_s[1] - half_period_s) <= 1e-15 * half_period_s


@pytest.mark.parametrize("z", [0.6, 0.707, 0.9])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_zvd_to_zvddd_are_powers_of_zv_at_any_damping(order: int, z: float) -> None:
    made = design(_mode(z), Ideal(), SHAPERS["zv" + "d" * order]).impulses
    k = math.exp(-math.pi * z / math.sqrt(1 - z * z))
    expected = np.ones(1)
    for _ in range(order + 1):
        expected = np.convolve(expected, np.array([1, k]) / (1 + k))
    assert np.abs(made.amplitudes / expected - 1).max() <= 1e-13


def test_an_mzv_of_many_impulses_says_up_to_which_damping_it_is_more_than_rounding() -> None:
    options = MzvOptions(n=12, t=5.4)
    assert design(_mode(0.5), Ideal(), SHAPERS["mzv"], options).certificate.verified
    with refused(
        "too_damped_for_kind",
        "plant.damping_ratio",
        says=r"must be at most 0\.\d+ for mzv: beyond it its last",
    ):
        design(_mode(0.9), Ideal(), SHAPERS["mzv"], options)


def test_ei_of_a_small_tolerance_reaches_further_and_says_where_it_ends() -> None:
    made = design(_mode(0.707), Ideal(), SHAPERS["ei"], ToleranceOptions(tolerance=0.01))
    assert made.certificate.verified
    with refused("humps_meet"):
        design(_mode(0.707), Ideal(), SHAPERS["ei"], ToleranceOptions(tolerance=0.05))


def test_of_several_modes_the_one_that_is_damped_too_much_is_named() -> None:
    plant = Modes(modes=(_mode(0.1), Mode(natural_frequency_rad_s=9.0, damping_ratio=0.96)))
    with refused("too_damped_for_kind", "plant.modes.1.damping_ratio", says="for zvdd: "):
        design(plant, Ideal(), SHAPERS["convolved"], ConvolvedOptions(base="zvdd"))


@pytest.mark.parametrize("name", ["multi_zv", "multi_umzv"])
@pytest.mark.parametrize(
    "modes", [((1.0, 0.02), (30.0, 0.9)), ((1.0, 0.9), (25.0, 0.4), (3.0, 0.0))]
)
def test_modes_that_decay_at_once_are_refused_by_joint_shapers_and_convolved(
    name: str, modes: tuple[tuple[float, float], ...]
) -> None:
    plant = Modes(modes=tuple(Mode(natural_frequency_rad_s=w, damping_ratio=z) for w, z in modes))
    with refused(
        "mode_decays_too_fast", "plant.modes.1.damping_ratio", says=rf"at most 0\.\d+ for {name}"
    ):
        design(plant, Ideal(), SHAPERS[name])
    assert design(plant, Ideal(), SHAPERS["convolved"]).certificate.verified


def test_a_scheduled_plant_may_be_heavily_damped() -> None:
    plant = Scheduled(
        first=Pendulum(cable_length_m=0.7, damping_ratio=0.7),
        last=Pendulum(cable_length_m=0.9, damping_ratio=0.7),
    )
    made = design(plant, Ideal(), SHAPERS["zvd"])
    assert made.certificate.verified
    assert made.worst_in_range is not None
    ends = [
        claims_by_formula(made.impulses, end.mode, Ideal())["residual"]
        for end in (plant.first, plant.last)
    ]
    assert max(ends) <= made.worst_in_range * (1 + 1e-9)


def test_a_curve_over_damping_reaches_the_heaviest() -> None:
    made = design(_mode(0.6), Ideal(), SHAPERS["zv"]).impulses
    wanted = SensitivityRange(damping=DampingRange(start=0.0, stop=0.99))
    curve = sensitivity(made, _mode(0.6), Ideal(), wanted).damping
    assert curve is not None
    told = np.array([_residual(made, z, Ideal()) for z in curve[0].tolist()])
    assert np.abs(told - curve[1]).max() < 1e-12
