"""Steps for large swings, against theory, small swings, and the rig, which shares no code."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.analysis.large_swing_certificate import certify_large_swing, large_swing_residuals
from design.analysis.large_swing_sensitivity import RATIO_LIMITS, large_swing_sensitivity
from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.claims import zeros
from design.errors import InfeasibleDesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import Unlimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.large_swing import LargeSwing
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.model.plants.spring_mass import SpringMass
from design.pipeline import Design, design
from design.rig.crane import Crane
from design.rig.machine import Machine
from design.shapers.num_large import NUM_LARGE, LargeSwingOptions
from design.shapers.registry import SHAPERS
from design.solving import large_swing
from tests.refusals import refused
from tests.shaper_table import CRANE, FIRST_ORDER, IDEAL, LIMITED, THESIS

SWITCHED = replace(THESIS, model="switched")


def shaper(
    speed_m_s: float | None,
    actuator: Unlimited = SWITCHED,
    plant: Plant = CRANE,
    *,
    slope: bool = False,
) -> Design:
    options = LargeSwingOptions(speed_m_s=speed_m_s, slope=slope)
    return design(plant, actuator, NUM_LARGE, options)


def swing_on_rig(
    command: Impulses, plant: Pendulum, actuator: Unlimited, speed_m_s: float
) -> tuple[float, float]:
    """Root of the energy of the swing after the drive has come to rest, and the largest angle."""
    crane = Crane(
        cable_length_m=plant.cable_length_m,
        damping_ratio=plant.damping_ratio,
        gravity_m_s2=plant.gravity_m_s2,
        max_speed_m_s=1e3,
    )
    machine = Machine(crane, (actuator, actuator), speed_m_s)
    machine.open_bounds()
    for at, level in zip(command.times_s, np.cumsum(command.amplitudes), strict=True):
        machine.command("x", float(level), float(at))
    last = float(command.times_s[-1])
    end = last + LargeSwing(crane=plant, speed_m_s=speed_m_s).settled_s(actuator)
    track = machine.advance(end, np.append(np.linspace(0.0, last + 0.1, 2001), end)[:-1])
    angles = np.arctan2(track.hook_m[:, 0], -track.hook_m[:, 2])
    energy = float(machine.advance(end).swing_energy_j[0])
    return math.sqrt(max(energy, 0.0)), float(np.abs(angles).max())


def left_on_rig(command: Impulses, plant: Pendulum, actuator: Unlimited, speed_m_s: float) -> float:
    """Share of the root of the energy of an unshaped step's, of an undamped load."""
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    left, unshaped = (swing_on_rig(one, plant, actuator, speed_m_s)[0] for one in (command, step))
    return left / unshaped


def longer(plant: Pendulum, ratio: float) -> Pendulum:
    return replace(plant, cable_length_m=plant.cable_length_m / ratio**2)


@pytest.mark.parametrize(
    ("speed_m_s", "times"), [(1.0, (0.32841049, 0.61548383)), (1.5, (0.33822728, 0.63569303))]
)
def test_the_times_of_the_theory(speed_m_s: float, times: tuple[float, float]) -> None:
    made = shaper(speed_m_s)
    assert made.impulses.times_s == pytest.approx([0.0, *times], abs=6e-9)
    assert made.impulses.amplitudes.tolist() == [1.0, -1.0, 1.0]
    assert made.certificate.verified
    assert made.residual < 1e-12
    assert left_on_rig(made.impulses, CRANE, SWITCHED, speed_m_s) < 1e-9


@pytest.mark.parametrize("slope", [False, True])
@pytest.mark.parametrize("actuator", [IDEAL, FIRST_ORDER, THESIS, SWITCHED])
def test_small_swings_are_those_of_the_linear_shaper(actuator: Unlimited, *, slope: bool) -> None:
    linear = design(CRANE, actuator, SHAPERS["numzvd" if slope else "numzv"]).impulses.times_s
    apart = [
        np.abs(shaper(speed, actuator, slope=slope).impulses.times_s - linear).max()
        for speed in (0.02, 0.04)
    ]
    # The next term goes with the square of the swing.
    assert apart[1] / apart[0] == pytest.approx(4.0, rel=1e-3)
    assert apart[0] < 2e-5


def test_with_slope_nothing_changes_with_the_cable_on_the_rig() -> None:
    made = shaper(1.5, slope=True)
    assert [claim.quantity for claim in made.certificate.claims] == ["residual", "slope"]
    assert left_on_rig(made.impulses, CRANE, SWITCHED, 1.5) < 1e-9
    beside = [
        left_on_rig(made.impulses, longer(CRANE, ratio), SWITCHED, 1.5)
        for ratio in (0.998, 0.999, 1.001, 1.002)
    ]
    # What remains is of second order: four times as much at twice the distance.
    assert beside[0] / beside[1] == pytest.approx(4.0, rel=0.02)
    assert beside[3] / beside[2] == pytest.approx(4.0, rel=0.02)
    without = shaper(1.5).impulses
    assert max(beside) < 1e-2 * left_on_rig(without, longer(CRANE, 0.998), SWITCHED, 1.5)


def test_the_residual_of_other_steps_is_that_of_the_rig() -> None:
    command = Impulses(
        times_s=np.array([0.0, 0.32126352, 0.60069086]), amplitudes=np.array([1.0, -1.0, 1.0])
    )
    for speed in (0.2, 1.0, 1.5, 2.5):
        swing = LargeSwing(crane=CRANE, speed_m_s=speed)
        for ratio in (0.7, 1.0, 1.3):
            found = large_swing_residuals(command, swing, SWITCHED, np.array([ratio]))[0]
            told = left_on_rig(command, longer(CRANE, ratio), SWITCHED, speed)
            assert found == pytest.approx(told, rel=1e-8)


def test_the_certificate_finds_what_the_rig_finds() -> None:
    linear = design(CRANE, SWITCHED, SHAPERS["numzv"]).impulses
    swing = LargeSwing(crane=CRANE, speed_m_s=1.5)
    found = certify_large_swing(linear, swing, SWITCHED, zeros(["residual", "slope"]))
    assert not found.verified
    assert found.claims[0].value == pytest.approx(
        left_on_rig(linear, CRANE, SWITCHED, 1.5), rel=1e-8
    )
    assert "nonlinear crane at 1.5 m/s" in found.method


def test_the_largest_angle_is_that_of_the_rig() -> None:
    made = shaper(1.5)
    assert made.large_swing is not None
    assert made.large_swing.swing.speed_m_s == 1.5
    told = swing_on_rig(made.impulses, CRANE, SWITCHED, 1.5)[1]
    # Seen at nodes in between: off by the square of a part of a panel.
    assert made.large_swing.largest_rad == pytest.approx(told, rel=2e-3)


def test_the_sensitivity_is_of_the_nonlinear_crane() -> None:
    made = shaper(1.5)
    assert made.large_swing is not None
    wanted = SensitivityRange(from_ratio=0.8, to_ratio=1.2, points=5)
    curve = large_swing_sensitivity(made.impulses, made.large_swing.swing, SWITCHED, wanted)
    told = [
        left_on_rig(made.impulses, longer(CRANE, ratio), SWITCHED, 1.5)
        for ratio in curve.frequency_ratios.tolist()
    ]
    assert curve.residuals == pytest.approx(told, rel=1e-8, abs=1e-9)
    band = curve.insensitivity
    assert band is not None
    for edge in (band.lower_ratio, band.upper_ratio):
        assert edge is not None
        there = left_on_rig(made.impulses, longer(CRANE, edge), SWITCHED, 1.5)
        assert there == pytest.approx(0.05, rel=1e-7)


def test_the_sensitivity_of_small_swings_is_the_linear_one() -> None:
    plant = replace(CRANE, damping_ratio=0.04)
    made = shaper(0.02, THESIS, plant)
    assert made.large_swing is not None
    wanted = SensitivityRange(points=21)
    curve = large_swing_sensitivity(made.impulses, made.large_swing.swing, THESIS, wanted)
    linear = sensitivity(made.impulses, plant.mode, THESIS, wanted)
    assert curve.residuals == pytest.approx(linear.residuals, abs=2e-4)
    assert curve.insensitivity is not None
    assert linear.insensitivity is not None
    assert curve.insensitivity.width == pytest.approx(linear.insensitivity.width, rel=1e-4)


def test_a_tolerance_that_is_never_passed_has_no_edges() -> None:
    swing = LargeSwing(crane=CRANE, speed_m_s=1.0)
    step = Impulses(times_s=np.array([0.0, 0.01]), amplitudes=np.array([0.5, 0.5]))
    wanted = SensitivityRange(points=2, tolerance=0.999)
    some = large_swing_sensitivity(step, swing, IDEAL, wanted).insensitivity
    assert some is None  # the nominal is above it
    made = shaper(1.0, IDEAL)
    wide = large_swing_sensitivity(made.impulses, swing, IDEAL, wanted).insensitivity
    assert wide is not None
    assert (wide.lower_ratio, wide.searched_from_ratio) == (None, RATIO_LIMITS[0])


def random_case(number: int) -> tuple[Pendulum, Unlimited, float, bool]:
    rng = np.random.default_rng([2026, number])
    length, gravity = float(np.exp(rng.uniform(np.log(0.05), np.log(30)))), 9.81
    w = math.sqrt(gravity / length)
    plant = Pendulum(cable_length_m=length, gravity_m_s2=gravity)
    speed = float(rng.uniform(0.05, 0.75)) * math.sqrt(gravity * length)
    model: Any = rng.choice(["superposed", "switched"])
    fast = [float(w * np.exp(rng.uniform(np.log(5), np.log(25)))) for _ in range(2)]
    actuator: Unlimited = Ideal()
    form = number % 5
    if form in {1, 2}:
        actuator = FirstOrder(
            accel_time_constant_s=1 / fast[0], decel_time_constant_s=1 / fast[1], model=model
        )
    elif form > 2:
        sets = [
            SecondOrderSet(natural_frequency_rad_s=one, damping_ratio=float(rng.uniform(0.5, 1.6)))
            for one in fast
        ]
        actuator = SecondOrder(accel=sets[0], decel=sets[1], model=model)
    return plant, actuator, speed, bool(rng.random() < 0.3)


@pytest.mark.parametrize("number", range(30))
def test_random_cranes_are_left_at_rest_on_the_rig(number: int) -> None:
    plant, actuator, speed, slope = random_case(number)
    try:
        made = shaper(speed, actuator, plant, slope=slope)
    except InfeasibleDesignError as error:
        linear = "numzvd" if slope else "numzv"
        with pytest.raises(InfeasibleDesignError):  # noqa: PT012 - there is none of small swings
            design(plant, actuator, SHAPERS[linear])
            pytest.fail(str(error))
        return
    assert made.certificate.verified
    assert (np.diff(made.impulses.times_s) > 0).all()
    assert left_on_rig(made.impulses, plant, actuator, speed) < 1e-7


def test_a_damped_load_is_left_at_rest() -> None:
    plant = replace(CRANE, damping_ratio=0.08)
    made = shaper(1.5, SWITCHED, plant)
    assert made.certificate.verified
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    left, unshaped = (swing_on_rig(one, plant, SWITCHED, 1.5)[0] for one in (made.impulses, step))
    # The step has had as long to die away since its last switch.
    assert left < 1e-8 * unshaped


def test_a_swing_over_60_degrees_says_which_speed_is_not() -> None:
    with refused("large_swing_over_60_degrees", says=r"at 4 m/s .* up to (\d\.\d+) m/s") as caught:
        shaper(4.0)
    assert isinstance(caught.value, InfeasibleDesignError)
    field, most = caught.value.faults[0]
    assert field == "shaper.speed_m_s"
    speed = float(most.split()[2])
    made = shaper(speed)
    assert made.large_swing is not None
    assert 59.5 < math.degrees(made.large_swing.largest_rad) < 60.0
    angle = swing_on_rig(made.impulses, CRANE, SWITCHED, speed)[1]
    assert math.degrees(angle) == pytest.approx(60.0, abs=0.3)


@pytest.mark.parametrize(
    ("plant", "code"),
    [
        (CRANE.mode, "large_swing_needs_pendulum"),
        (SpringMass(mass_kg=1.0, stiffness_n_m=12.0), "large_swing_needs_pendulum"),
        (Scheduled(first=CRANE, last=longer(CRANE, 1.1)), "large_swing_needs_pendulum"),
        (
            Modes(modes=(CRANE.mode, Mode(natural_frequency_rad_s=9.0))),
            "kind_of_one_mode",
        ),
    ],
)
def test_what_is_no_pendulum_is_refused(plant: Plant, code: str) -> None:
    with refused(code):
        shaper(1.0, SWITCHED, plant)


def test_a_speed_must_be_given_and_be_one() -> None:
    with refused("large_swing_needs_speed", "shaper.speed_m_s"):
        shaper(None)
    for speed in (0.0, -1.0, math.nan, math.inf):
        with refused("out_of_range", "speed_m_s"):
            shaper(speed)


def test_limits_to_the_acceleration_are_not_served() -> None:
    with refused("actuator_not_served", "actuator.kind"):
        design(CRANE, LIMITED, NUM_LARGE, LargeSwingOptions(speed_m_s=0.2))


def test_a_load_that_forgets_its_swing_before_the_drive_rests_is_refused() -> None:
    slow = FirstOrder(accel_time_constant_s=0.6, decel_time_constant_s=0.5)
    with refused("swing_dies_before_drive", "plant.damping_ratio", says=r"at most 0\.1119 "):
        shaper(1.0, slow, replace(CRANE, damping_ratio=0.3))
    # Where the design can be followed back, a cable a quarter as long may not be.
    plant = replace(CRANE, damping_ratio=0.11)
    made = shaper(1.0, slow, plant)
    assert made.large_swing is not None
    wanted = SensitivityRange(to_ratio=1.01, points=3, tolerance=0.9)
    curve = large_swing_sensitivity(made.impulses, made.large_swing.swing, slow, wanted)
    assert curve.insensitivity is not None
    assert curve.insensitivity.upper_ratio is None
    assert curve.insensitivity.searched_to_ratio == pytest.approx(0.11199 / 0.11, rel=1e-3)


def test_a_swing_too_small_for_doubles_is_told_to_be_linear() -> None:
    least = 1e-3 * math.sqrt(9.81 * 0.8)
    assert shaper(1.001 * least).certificate.verified
    with refused("swing_is_small", "shaper.speed_m_s", says="at least 0.0028"):
        shaper(0.999 * least)
    linear = design(CRANE, SWITCHED, SHAPERS["numzv"]).impulses
    swing = LargeSwing(crane=CRANE, speed_m_s=least)
    assert large_swing_residuals(linear, swing, SWITCHED, np.ones(1))[0] < 1e-6


def test_where_a_branch_ends_the_refusal_says_up_to_which_speed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    follow = large_swing._Branch._solve

    def ends_at_1_m_s(branch: Any, speed_m_s: float, gaps_s: Any) -> Any:
        return follow(branch, speed_m_s, gaps_s) if speed_m_s < 1.0 else None

    monkeypatch.setattr(large_swing._Branch, "_solve", ends_at_1_m_s)
    with refused("large_swing_branch_ends", says=r"at 1\.5 m/s: .* up to 0\.9\d* m/s"):
        shaper(1.5)


@pytest.mark.parametrize("scale", [0.01, 30.0])
def test_times_scale_with_the_root_of_the_length(scale: float) -> None:
    slower = math.sqrt(scale)
    drive = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=20 / slower, damping_ratio=0.8),
        decel=SecondOrderSet(natural_frequency_rad_s=50 / slower, damping_ratio=1.5),
        model="switched",
    )
    plant = replace(CRANE, cable_length_m=0.8 * scale)
    times = shaper(1.5 * slower, drive, plant).impulses.times_s / slower
    assert times == pytest.approx(shaper(1.5).impulses.times_s, abs=1e-11)
