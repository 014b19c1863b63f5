"""Cables that would have to push, and hoists faster than free fall."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipk

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.hoisting import LengthCourse
from design.rig.crane import CableName, Crane, Load
from design.rig.hoists import hoists_of, require_taut
from design.rig.machine import Machine
from design.rig.runs import Scenario, run
from design.rig.scenario import Drive, HoistTo
from design.types import FloatArray
from tests.design.rig.cranes import CRANE, THESIS
from tests.refusals import refused

G, LENGTH = 9.81, 0.8
ACCEL, DECEL = 3.0, 30.0


def test_a_brake_at_the_turn_of_the_swing_makes_the_cable_slack_as_theory_says() -> None:
    # Pulled by ACCEL from rest the load swings about atan(a / g) to twice that behind: half a
    # period of a pendulum under sqrt(g^2 + a^2), by the complete elliptic integral.
    tilt = math.atan(ACCEL / G)
    turn_s = 2 * ellipk(math.sin(tilt / 2) ** 2) * math.sqrt(LENGTH / math.hypot(G, ACCEL))
    behind = -2 * tilt

    # Braked by DECEL from there, T / m = g cos x + b sin x + l x'^2, with x'^2 by the energy.
    def weight(angle: float) -> float:
        return G * math.cos(angle) + DECEL * math.sin(angle)

    pulled = weight(behind)
    assert pulled < 0
    # T is zero where the weight is two thirds of that at the turn.
    whole, phase = math.hypot(G, DECEL), math.atan2(G, DECEL)
    taut = math.asin(2 / 3 * pulled / whole) - phase
    # x = behind + s^2 takes the root out of the time.
    lasts = quad(
        lambda s: 2 * s / math.sqrt(2 / LENGTH * (weight(behind + s * s) - pulled)),
        0.0,
        math.sqrt(taut - behind),
        epsabs=1e-13,
    )[0]
    speed = ACCEL * turn_s
    drive = RateLimited(accel_limit_m_s2=ACCEL, decel_limit_m_s2=DECEL, speed_m_s=speed)
    crane = replace(CRANE, max_speed_m_s=10.0)
    machine = Machine(crane, (drive, drive), speed)
    machine.command("x", 1.0, 0.0)
    machine.advance(turn_s)
    assert not machine.slack
    machine.command("x", 0.0)
    machine.advance(turn_s + speed / DECEL)
    assert len(machine.slack) == 1
    slack = machine.slack[0]
    assert slack.cable == "upper"
    assert slack.at_s == pytest.approx(turn_s, abs=1e-12)
    assert slack.duration_s == pytest.approx(lasts, abs=1e-9)
    assert slack.push_n == pytest.approx(-pulled * crane.hook_mass_kg, rel=1e-9)


@pytest.mark.parametrize("load", [None, Load(mass_kg=0.6, length_m=0.25)], ids=["one", "two"])
@pytest.mark.parametrize("seed", range(3))
def test_slack_is_where_the_motion_needs_a_push(seed: int, load: Load | None) -> None:
    rng = np.random.default_rng(seed)
    drive = FirstOrder(accel_time_constant_s=0.03, decel_time_constant_s=0.02, model="switched")
    crane = replace(CRANE, load=load)
    times = np.cumsum(rng.uniform(0.2, 0.6, 8))
    machine = Machine(crane, (drive, drive), 1.0)
    for number, time in enumerate(times.tolist()):
        machine.command("x", float(number % 2 == 0), time)
    step = 5e-5
    seen = np.arange(0.0, float(times[-1]) + 0.4, step)
    track = machine.advance(float(seen[-1]), seen)
    # Newton's law by differences of what is seen, without the equations of the swing.
    support = np.pad(track.position_m, ((0, 0), (0, 1)))
    weight = np.array([0.0, 0.0, G])

    def force(places: FloatArray) -> FloatArray:
        needed: FloatArray = np.diff(places, 2, axis=0) / step**2 + weight
        return needed

    mass_kg = crane.hook_mass_kg + (0.0 if load is None else load.mass_kg)
    hook, low = track.hook_m, track.load_m
    upper = crane.hook_mass_kg * force(support + hook)
    pulls: dict[CableName, FloatArray] = {}
    if load is not None:
        lower = load.mass_kg * force(support + low)
        along = (low - hook)[1:-1] / load.length_m
        pulls["lower"] = -(lower * along).sum(axis=1)
        upper = upper + lower
    pulls["upper"] = -(upper * hook[1:-1]).sum(axis=1) / LENGTH
    found = {one.cable: one for one in machine.slack}
    for cable, pull in pulls.items():
        slack = np.flatnonzero(pull < 0)
        assert (cable in found) == (slack.size > 0)
        if slack.size:
            assert found[cable].at_s == pytest.approx(seen[1 + slack[0]], abs=2 * step)
            edges = 2 + np.count_nonzero(np.diff(slack) > 1)
            assert found[cable].duration_s == pytest.approx(step * slack.size, abs=edges * step)
            # Differences first see a jump of the acceleration two steps after it.
            late_n = 2 * step * (1 / 0.02**2) * mass_kg
            assert found[cable].push_n == pytest.approx(-pull.min(), abs=late_n)


def test_slack_is_a_warning_of_a_run_and_none_of_the_linear_model() -> None:
    drive = FirstOrder(accel_time_constant_s=0.01, decel_time_constant_s=0.01)
    presses = [Drive(event=0, axis="x", at_s=0.0, level=1.0, for_s=0.5)]
    scenario = Scenario(crane=CRANE, drive=drive, speed_m_s=1.0, drives=presses)
    warnings = run(scenario, 3.0, 11).warnings
    assert len(warnings) == 1
    warning = warnings[0]
    assert warning.code == "slack_cable"
    assert "from 0.5 s on" in warning.detail
    linear = replace(CRANE, model="linear")
    assert run(replace(scenario, crane=linear), 3.0, 11).warnings == ()
    # A velocity that jumps has no tension; at the thesis's speed its drive keeps the cable taut.
    assert run(replace(scenario, drive=Ideal()), 3.0, 11).warnings == ()
    assert run(replace(scenario, drive=THESIS, speed_m_s=0.2), 3.0, 11).warnings == ()


def hoist(at_s: float, over_s: float, length_m: float) -> HoistTo:
    return HoistTo(event=0, at_s=at_s, over_s=over_s, cable_length_m=length_m)


@pytest.mark.parametrize("change", [0.5, -0.5], ids=["lowered", "hoisted"])
def test_no_hoist_is_faster_than_free_fall(change: float) -> None:
    # From rest to rest by d: a fall for all of the time makes g t^2 / 2.
    fastest = math.sqrt(2 * abs(change) / G)
    require_taut(1.0, [hoist(2.0, fastest * 1.001, 1.0 + change)], G, "events")
    with refused("faster_than_free_fall", "events", says=r"0 m/s|0\.5"):
        require_taut(1.0, [hoist(2.0, fastest * 0.999, 1.0 + change)], G, "events")


def test_a_free_fall_on_samples_is_the_limit() -> None:
    times = np.arange(0.0, 0.4005, 0.001)
    for share, slack in ((0.999, False), (1.001, True)):
        # Falls by a share of g, and is stopped at once: a cable may pull as hard as it likes.
        lengths = 0.5 + share * G * times**2 / 2
        course = LengthCourse(times_s=tuple(times), values=tuple(lengths))
        hoists = hoists_of(course)
        if slack:
            with refused("faster_than_free_fall", "plant"):
                require_taut(0.5, hoists, G, "plant")
        else:
            require_taut(0.5, hoists, G, "plant")


def test_a_hoist_that_ends_another_counts_with_it() -> None:
    up_then_down = [hoist(0.0, 1.0, 0.5), hoist(0.5, 0.2, 1.0)]
    with refused("faster_than_free_fall", "events", says=r"-0\.5 m/s before and 3\.5 m/s after"):
        require_taut(1.0, [hoist(0.0, 1.0, 0.5), hoist(0.5, 0.1, 1.1)], G, "events")
    require_taut(1.0, up_then_down, G, "events")
    require_taut(1.0, [], G, "events")
    assert Crane(cable_length_m=1.0).gravity_m_s2 < G
