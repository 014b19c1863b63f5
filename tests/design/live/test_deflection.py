"""Commands whose deflection keeps a limit: least time, nothing left, from any state."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.analysis.unshaped import unshaped_gain
from design.errors import InvalidInputError
from design.live.deflection import LimitedPlan, limited_plan
from design.live.deflection_peak import peak_deflection
from design.live.machine import LiveKind, LiveMachine
from design.live.propagation import carry
from design.live.state import AxisState, Plan, at_rest
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import Unlimited
from design.model.impulses import Impulses
from design.response.simulated_history import simulated_history
from tests.design.live.machines import CRANE, DRIVES, KIM, rows_of

MODES = CRANE.modes
PERIOD_S = math.tau / CRANE.mode.natural_frequency_rad_s
REST = at_rest(1, LiveKind())

FIGURES = [(0.5, 0.400), (0.4, 0.463), (0.3, 0.580), (0.2, 0.829)]
"""THEORY, section 11: limit, and the least time [periods]."""

by_drive = pytest.mark.parametrize("drive", DRIVES)


def found(drive: Unlimited, axis: AxisState, target: float, limit: float) -> LimitedPlan:
    plan = limited_plan(drive, MODES, axis, target, limit)
    assert plan is not None
    return plan


def driven(drive: Unlimited, times_s: list[float], levels: list[float], now_s: float) -> AxisState:
    rows = rows_of(LiveMachine(plant=CRANE, actuator=drive))
    plan = Plan(times_s=tuple(times_s), levels=tuple(levels))
    return carry(rows, replace(REST, plan=plan), now_s + drive.dead_time_s)


def whole_command(times_s: list[float], levels: list[float], plan: Plan) -> Impulses:
    return Impulses(
        times_s=np.array([*times_s, *plan.times_s]),
        amplitudes=np.diff(np.array([*levels, *plan.levels]), prepend=0.0),
    )


def simulated_peak(command: Impulses, drive: Unlimited, from_s: float) -> float:
    """Return the largest deflection by matrix exponential, over that of an unshaped step."""
    end_s = float(command.times_s[-1]) + PERIOD_S
    times = np.linspace(from_s, end_s, 20_000)
    deflection = simulated_history(command, CRANE.mode, drive, times).deflection
    return float(np.abs(deflection).max()) / unshaped_gain(CRANE.mode, drive)


@pytest.mark.parametrize(("limit", "periods"), FIGURES)
def test_a_start_behind_an_ideal_drive_takes_the_time_of_theory(
    limit: float, periods: float
) -> None:
    plan = found(Ideal(), REST, 1.0, limit)
    assert plan.plan.fallback is None
    assert plan.peak <= limit
    taken = plan.plan.times_s[-1] / PERIOD_S
    assert taken == pytest.approx(periods, rel=0.01)
    # Full speed, the even rise at the limit, and nothing: no staircase is faster.
    ride = (2 * math.sqrt(1 - limit**2) - 1) / limit
    assert taken >= (2 * math.asin(limit) + ride) / math.tau - 1e-4


def test_the_least_limit_is_kept_too() -> None:
    plan = found(Ideal(), REST, 1.0, 0.05)
    assert plan.plan.fallback is None
    assert plan.peak <= 0.05
    assert plan.plan.times_s[-1] / PERIOD_S < 3.4


def test_the_command_rises_evenly_while_the_payload_hangs_at_the_limit() -> None:
    limit = 0.3
    plan = found(Ideal(), REST, 1.0, limit).plan
    times, levels = np.array(plan.times_s), np.array(plan.levels)
    reached_s = math.asin(limit) / CRANE.mode.natural_frequency_rad_s
    riding = (times > 1.5 * reached_s) & (times < times[-1] - 1.5 * reached_s)
    slope = np.polyfit(times[riding], levels[riding], 1)[0]
    assert slope == pytest.approx(limit * CRANE.mode.natural_frequency_rad_s, rel=0.01)


@by_drive
@pytest.mark.parametrize("limit", [0.5, 0.3])
def test_start_and_stop_keep_the_limit_by_matrix_exponential(
    drive: Unlimited, limit: float
) -> None:
    start = found(drive, REST, 1.0, limit).plan
    begin_s = start.times_s[-1] + 2.5
    times, levels = list(start.times_s), list(start.levels)
    stop = found(drive, driven(drive, times, levels, begin_s), 0.0, limit).plan
    command = whole_command(times, levels, stop)
    assert start.fallback is stop.fallback is None
    assert residual_vibration(command, CRANE.mode, drive) <= 1e-9
    assert simulated_peak(command, drive, 0.0) <= limit * (1 + 1e-7)
    assert min(levels + list(stop.levels)) >= 0.0
    assert max(levels + list(stop.levels)) <= 1.0
    assert len(stop.levels) <= 41


@pytest.mark.parametrize("drive", [KIM, replace(KIM, model="superposed"), Ideal()])
def test_random_states_come_to_the_level_and_the_peak_is_as_told(drive: Unlimited) -> None:
    rng = np.random.default_rng(23)
    for _ in range(6):
        times = np.cumsum(rng.uniform(0.05, 0.9, 3)).tolist()
        levels = [1.0, 0.0, 1.0][: int(rng.integers(1, 4))]
        times = times[: len(levels)]
        now_s = times[-1] + float(rng.uniform(0, 0.8))
        target = float(rng.integers(2))
        plan = found(drive, driven(drive, times, levels, now_s), target, 0.6)
        command = whole_command(times, levels, plan.plan)
        final = plan.plan.levels[-1] if plan.plan.levels else levels[-1]
        assert final == target
        left = residual_vibration(command, CRANE.mode, drive)
        assert left <= 1e-9
        # 20,000 samples see the peak to (w h)^2 / 8 of itself.
        assert simulated_peak(command, drive, now_s) == pytest.approx(plan.peak, rel=1e-5)
        assert (plan.plan.fallback is None) == (plan.peak <= 0.6)


def test_a_swing_beyond_the_limit_is_told_with_about_the_least_peak() -> None:
    # An unshaped step whose deflection has just gone beyond the limit, at its steepest.
    axis = driven(Ideal(), [0.0], [1.0], 0.2 * PERIOD_S)
    plan = found(Ideal(), axis, 1.0, 0.3)
    assert plan.plan.fallback is not None
    now = math.sin(0.4 * math.pi)
    assert "above the limit of 0.3" in plan.plan.fallback
    assert f"reaches {plan.peak:.4g} of an unshaped step's" in plan.plan.fallback
    # It hangs back at sin(w t) and falls further at first: off at once is the least peak.
    assert now <= plan.peak <= 1.003 * now


@by_drive
def test_a_move_backward_is_the_mirror_image(drive: Unlimited) -> None:
    forward, back = (found(drive, REST, level, 0.4).plan for level in (1.0, -1.0))
    assert back.times_s == forward.times_s
    assert [-level for level in back.levels] == list(forward.levels)


def test_a_reversal_stops_first_and_keeps_the_limit() -> None:
    start = found(KIM, REST, 1.0, 0.5).plan
    times, levels = list(start.times_s), list(start.levels)
    turn = found(KIM, driven(KIM, times, levels, 3.0), -1.0, 0.5)
    command = whole_command(times, levels, turn.plan)
    assert turn.plan.levels[-1] == -1.0
    assert residual_vibration(command, CRANE.mode, KIM) <= 1e-9
    # The drive still comes to rest when it starts the other way: no limit is lost by that.
    assert simulated_peak(command, KIM, 0.0) == pytest.approx(turn.peak, rel=2e-3)


def test_a_dead_time_delays_nothing_but_the_answer() -> None:
    plan = found(KIM, REST, 1.0, 0.5).plan
    late = replace(KIM, dead_time_s=0.05)
    same = found(late, replace(REST, time_s=0.05), 1.0, 0.5).plan
    assert same.times_s == pytest.approx(plan.times_s, abs=1e-12)


def test_the_peak_of_an_unshaped_step_is_one() -> None:
    step = replace(REST, plan=Plan(times_s=(0.0,), levels=(1.0,)))
    assert peak_deflection(Ideal(), MODES, step) == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize("limit", [0.0, -0.5, 0.04, 11.0, math.nan, math.inf])
def test_a_limit_out_of_range_is_refused(limit: float) -> None:
    with pytest.raises(InvalidInputError, match="deflection_limit must be between"):
        limited_plan(KIM, MODES, REST, 1.0, limit)
