"""The judge: a claim said of the actuator given holds there, and every other has its figure."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.certificate import TOLERANCE_MARGIN
from design.analysis.judge import judge
from design.analysis.warnings import sum_warnings
from design.claims import zeros
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.sampling.sampled_design import sampled_design
from design.shapers.registry import SHAPERS
from tests.integration_route import residual_by_integration

CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
TWO_MODES = Modes(
    modes=(Mode(natural_frequency_rad_s=3.5), Mode(natural_frequency_rad_s=9.4, damping_ratio=0.02))
)
FIRST = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.2)
SECOND = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50, damping_ratio=1.5),
)
DRIVES: dict[str, Actuator] = {
    "ideal": Ideal(),
    "first": FIRST,
    "first_switched": replace(FIRST, model="switched"),
    "symmetric": FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1),
    "second": SECOND,
    "second_switched": replace(SECOND, model="switched"),
    "limited": RateLimited(accel_limit_m_s2=2.0, decel_limit_m_s2=3.0, speed_m_s=0.2),
}
MOVING = ("umzv", "umzvd", "umzvc", "numzv", "numzvd")


def served(kinds: Iterable[str]) -> list[tuple[str, str]]:
    """Return every kind of a linear plant with each of the drives that it serves."""
    return [
        (kind, name)
        for kind in kinds
        for name, drive in DRIVES.items()
        if drive.kind in SHAPERS[kind].actuators and not SHAPERS[kind].large_swings
    ]


@pytest.mark.parametrize(("kind", "drive"), served(SHAPERS))
def test_the_claims_of_a_design_are_of_the_actuator_given_or_a_warning_has_the_figure(
    kind: str, drive: str
) -> None:
    actuator = DRIVES[drive]
    plant = TWO_MODES if SHAPERS[kind].serves_several else CRANE
    found = design(plant, actuator, SHAPERS[kind])
    ignored = [one for one in found.warnings if one.code == "actuator_ignored"]
    assert len(ignored) == found.for_ideal
    for claim in found.certificate.claims:
        assert claim.holds
        if claim.quantity == "residual" and not found.for_ideal:
            assert claim.value == pytest.approx(found.residuals[claim.mode], abs=2e-10)
    claimed = max(claim.limit for claim in found.certificate.claims)
    if not found.for_ideal:
        assert found.residual <= claimed * (1 + TOLERANCE_MARGIN)


def test_a_shaper_made_for_an_ideal_drive_is_claimed_for_a_symmetric_one_where_it_holds() -> None:
    found = design(CRANE, DRIVES["symmetric"], SHAPERS["umzv"])
    assert not found.for_ideal
    assert found.residual < 1e-12
    assert design(CRANE, FIRST, SHAPERS["umzv"]).for_ideal


def test_a_band_that_is_lost_behind_the_drive_is_warned_of_though_the_nominal_is_kept() -> None:
    # At the nominal frequency a touch of asymmetry stays within the tolerance, in the band not.
    slight = FirstOrder(accel_time_constant_s=0.02, decel_time_constant_s=0.0201)
    found = design(CRANE, slight, SHAPERS["um_ei"])
    assert found.residual <= 0.05 * (1 + 1e-2)
    assert found.for_ideal
    (warning,) = [one for one in found.warnings if one.code == "actuator_ignored"]
    assert "of the frequency, above 5 %" in warning.detail


@pytest.mark.parametrize(("kind", "drive"), served(MOVING))
@pytest.mark.parametrize("distance_m", [0.42, -0.12])
def test_the_claims_of_a_move_are_of_the_actuator_given_or_a_warning_has_the_figure(
    kind: str, drive: str, distance_m: float
) -> None:
    actuator = DRIVES[drive]
    move = maneuver(CRANE, actuator, SHAPERS[kind], speed_m_s=0.2, distance_m=distance_m)
    assert move.residual == pytest.approx(
        residual_by_integration(move.command, CRANE.mode, actuator), abs=1e-6
    )
    (residual,) = (claim.value for claim in move.certificate.claims if claim.quantity == "residual")
    told = [one.detail for one in move.warnings if one.code == "actuator_ignored"]
    if move.for_ideal:
        assert residual <= 1e-9
        assert len(told) == 1
        assert move.residual <= 1e-9 or f"the residual is {100 * move.residual:.4g} %" in told[0]
    else:
        assert residual == pytest.approx(move.residual, abs=2e-10)
        assert move.residual <= 1e-9
        assert not told


def test_a_textbook_move_behind_an_asymmetric_drive_says_what_it_costs() -> None:
    slow = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.3)
    move = maneuver(CRANE, slow, SHAPERS["umzv"], speed_m_s=0.4, distance_m=2.0)
    assert move.for_ideal
    assert move.residual == pytest.approx(0.14437, abs=5e-6)
    second = maneuver(CRANE, SECOND, SHAPERS["umzvd"], speed_m_s=0.4, distance_m=2.0)
    assert second.for_ideal
    assert second.residual == pytest.approx(0.04315, abs=5e-6)


@pytest.mark.parametrize(
    ("kind", "hertz", "damping", "sample_time_s"),
    [("umzv", 60, 0.08, 0.002), ("umzv", 7.3, 0.05, 0.01)],
)
def test_what_is_lost_on_samples_has_a_warning_with_the_figure(
    kind: str, hertz: float, damping: float, sample_time_s: float
) -> None:
    mode = Mode(natural_frequency_rad_s=2 * np.pi * hertz, damping_ratio=damping)
    found, sampled = sampled_design(
        design(mode, Ideal(), SHAPERS[kind]), mode, Ideal(), sample_time_s
    )
    assert sampled.residual > 0.01
    (warning,) = [one for one in found.warnings if one.code == "tolerance_not_kept"]
    assert f"{100 * found.residual:.4g} %" in warning.detail


def test_what_is_kept_on_samples_has_no_warning() -> None:
    mode = Mode(natural_frequency_rad_s=2 * np.pi * 7.3, damping_ratio=0.05)
    for kind, sample_time_s in (("zv", 0.01), ("umzv", 0.0001), ("ei", 0.0001)):
        found, sampled = sampled_design(
            design(mode, Ideal(), SHAPERS[kind]), mode, Ideal(), sample_time_s, tolerance=0.01
        )
        assert sampled.residual <= 0.051
        assert not [one for one in found.warnings if one.code == "tolerance_not_kept"]


def test_a_joint_move_that_costs_robustness_says_so() -> None:
    move = maneuver(CRANE, Ideal(), SHAPERS["umzv"], speed_m_s=0.2, distance_m=0.42)
    joint = maneuver(CRANE, Ideal(), SHAPERS["umzv"], speed_m_s=0.2, distance_m=0.42, joint=True)
    slopes = [_slope(one.command) for one in (move, joint)]
    assert not move.warnings
    assert bool([one for one in joint.warnings if one.code == "less_robust"]) == (
        joint.joint and slopes[1] > 10 * slopes[0]
    )


def _slope(command: Impulses) -> float:
    verdict = judge(command, (CRANE.mode,), Ideal(), zeros(["slope"]), name="it")
    return verdict.certificate.claims[0].value


@pytest.mark.parametrize(
    ("amplitudes", "warned"),
    [
        ([0.5, 0.5], False),
        ([1.0, -1.0, 1.0], False),
        ([1.0, -1.0], False),
        ([-0.5, -0.5], False),
        ([0.3333333333] * 3, False),  # printed digits
        ([0.3, 0.3], True),
        ([1.0, 1.0], True),
    ],
)
def test_amplitudes_that_are_neither_a_shaper_nor_a_move_have_a_warning(
    amplitudes: list[float], *, warned: bool
) -> None:
    command = Impulses(
        times_s=np.arange(len(amplitudes), dtype=float), amplitudes=np.array(amplitudes)
    )
    told = list(sum_warnings(command))
    assert [one.code for one in told] == (["sum_not_one"] if warned else [])
    if warned:
        assert f"{sum(amplitudes):.9g}" in told[0].detail


@pytest.mark.parametrize("sample_time_s", [0.05, 0.001])
@pytest.mark.parametrize("kind", ["zvd", "ei", "mzv"])
def test_what_is_proven_for_an_ideal_drive_stays_so_on_samples(
    kind: str, sample_time_s: float
) -> None:
    drive = RateLimited(accel_limit_m_s2=0.5, decel_limit_m_s2=0.8, speed_m_s=0.4)
    between = design(CRANE, drive, SHAPERS[kind])
    assert between.for_ideal
    found, _ = sampled_design(between, CRANE.mode, drive, sample_time_s)
    assert found.for_ideal
    assert found.residual == pytest.approx(
        residual_by_integration(found.impulses, CRANE.mode, drive), abs=1e-6
    )
    warning = found.warnings[0]
    assert warning.code == "actuator_ignored"
    assert f"{100 * found.residual:.4g} % on samples" in warning.detail
    assert f"{100 * between.residual:.4g} % between them" in warning.detail
