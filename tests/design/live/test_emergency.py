"""Emergency stops: least travel, nothing left, from any state."""

import math
from dataclasses import replace

import cvxpy as cp
import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.errors import InvalidInputError
from design.live.emergency import EmergencyStop, emergency_stop, stop_case
from design.live.emergency_request import EmergencyRequest
from design.live.machine import LiveKind, LiveMachine
from design.live.propagation import carry
from design.live.state import AxisState, Plan, at_rest
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import Unlimited
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.response.closed_form import travel
from design.response.simulation import ringing_after
from tests.design.live.machines import CRANE, DRIVES, KIM, rows_of
from tests.design.live.stop_cases import (
    KIM_LAGS,
    bound_of_way,
    random_case,
)

SPEED_M_S = 0.2
PERIOD_S = math.tau / CRANE.mode.natural_frequency_rad_s
FULL_SPEED = replace(at_rest(1, LiveKind()), level=1.0, target=1.0)

FIGURES = [(0.0, 1, 59.81), (0.05, 1, 56.54), (0.2, 1, 47.01), (0.5, 1, 28.86), (0.0, 2, 57.73)]
"""THEORY, section 11: swing left, periods, and the least travel [mm]."""

IDEAL = Ideal()


def stop_of(
    axis: AxisState, actuator: Unlimited = IDEAL, swing_left: float = 0.0, periods: float = 1.0
) -> EmergencyStop:
    request = EmergencyRequest(swing_left=swing_left, within_periods=periods)
    return emergency_stop(actuator, CRANE.modes, axis, request)


def driven(
    actuator: Unlimited, times_s: list[float], levels: list[float], now_s: float
) -> AxisState:
    """Return the state of an axis from rest, after some commands."""
    rows = rows_of(LiveMachine(plant=CRANE, actuator=actuator))
    plan = Plan(times_s=tuple(times_s), levels=tuple(levels))
    return carry(rows, replace(at_rest(1, LiveKind()), plan=plan), now_s + actuator.dead_time_s)


def whole_command(times_s: list[float], levels: list[float], plan: Plan) -> Impulses:
    times = np.array([*times_s, *plan.times_s])
    steps = np.diff(np.array([*levels, *plan.levels]), prepend=0.0)
    return Impulses(times_s=times, amplitudes=steps)


@pytest.mark.parametrize(("swing_left", "periods", "travel_mm"), FIGURES)
def test_the_travel_of_an_ideal_drive_is_that_of_theory(
    swing_left: float, periods: float, travel_mm: float
) -> None:
    done = stop_of(FULL_SPEED, swing_left=swing_left, periods=periods)
    assert done.plan.fallback is None
    assert done.swing_left == pytest.approx(swing_left, abs=1e-12)
    assert 1e3 * SPEED_M_S * done.way_s == pytest.approx(travel_mm, abs=0.05)


@pytest.mark.parametrize("swing_left", [0.0, 0.05, 0.2, 0.5])
def test_one_pulse_of_an_undamped_mode_has_its_closed_form(swing_left: float) -> None:
    # A pulse of half-width b about its middle adds 2 sin(w b), which takes 1 - share away.
    done = stop_of(FULL_SPEED, swing_left=swing_left)
    width = 2 / CRANE.mode.natural_frequency_rad_s * math.asin((1 - swing_left) / 2)
    assert done.way_s == pytest.approx(width, rel=1e-10)


def test_with_time_unlimited_the_travel_is_that_of_the_swing_taken_away() -> None:
    # n equal pulses of 2 asin((1 - share) / (2 n)) / w each, which tends to (1 - share) / w.
    done = stop_of(FULL_SPEED, swing_left=0.2, periods=8)
    w = CRANE.mode.natural_frequency_rad_s
    assert done.way_s == pytest.approx(16 / w * math.asin(0.05), rel=1e-9)
    assert done.way_s == pytest.approx(0.8 / w, rel=1e-3)


@pytest.mark.parametrize("actuator", DRIVES)
def test_the_way_counts_the_coasting_of_the_drive(actuator: Unlimited) -> None:
    # Two half steps half a period apart leave nothing behind any drive.
    times, levels = [0.0, PERIOD_S / 2], [0.5, 1.0]
    axis = driven(actuator, times, levels, 30.0)
    done = stop_of(axis, actuator)
    command = whole_command(times, levels, done.plan)
    until_s = 30.0 - PERIOD_S / 4 - actuator.accel_lag.first_s
    assert done.way_s == pytest.approx(travel(command, actuator) - until_s, abs=1e-11)
    assert residual_vibration(command, CRANE.mode, actuator) <= 1e-9


@pytest.mark.parametrize("lags", [np.zeros((2, 2)), KIM_LAGS[[0, 0]]])
def test_no_way_behind_alike_sets_is_shorter_by_duality(lags: np.ndarray) -> None:
    rng = np.random.default_rng(5)
    proven = 0
    for _ in range(60):
        case, swing_left = random_case(rng, lags), float(rng.choice([0.0, 0.1, 0.3]))
        done = stop_case(case, swing_left)
        if done.asked:
            # A pulse that turns the quickest mode by less than a thousandth is left out.
            bound = bound_of_way(case, done, swing_left)
            assert bound - 1e-8 <= done.stop.way_s <= bound + 2e-5
            proven += 1
    assert proven > 40


@pytest.mark.parametrize("swing_left", [0.0, 0.2])
def test_a_cone_programme_on_a_grid_goes_no_shorter_way(swing_left: float) -> None:
    case = replace(
        random_case(np.random.default_rng(8), KIM_LAGS[[0, 0]]), end_s=1.5 * PERIOD_S, level=1.0
    )
    cells = 600
    edges = np.linspace(0.0, case.end_s, cells + 1)
    turned = np.exp(case.poles_rad_s[:, None] * (case.end_s - edges))
    added = case.gains[0][:, None] * (turned[:, :-1] - turned[:, 1:])
    off = case.left_by(np.zeros(1), np.zeros(1))
    command = cp.Variable(cells)
    vibration = added @ command + off.vibration
    rules = [command >= 0, command <= 1]
    rules += [cp.abs(vibration) <= swing_left * np.abs(case.gains[0])]
    problem = cp.Problem(cp.Minimize(cp.sum(command) * case.end_s / cells), rules)
    problem.solve(solver=cp.CLARABEL)
    done = stop_case(case, swing_left)
    assert done.asked
    # The grid costs some of the square of its cells; it never gains.
    assert done.stop.way_s - off.way_s == pytest.approx(problem.value, abs=2e-5)
    assert done.stop.way_s - off.way_s <= problem.value + 1e-7


@pytest.mark.parametrize("actuator", DRIVES)
def test_any_state_of_a_drive_comes_to_rest_by_matrix_exponential(actuator: Unlimited) -> None:
    rng = np.random.default_rng(17)
    frequency = np.array([CRANE.mode.natural_frequency_rad_s])
    stopped = 0
    for _ in range(25):
        times = np.cumsum(rng.uniform(0.02, 1.2, 5)).tolist()
        levels = [1.0, 0.0, 1.0, 0.0, 1.0][: int(rng.integers(1, 6))]
        times = times[: len(levels)]
        now = times[-1] + float(rng.uniform(0, 1))
        axis = driven(actuator, times, levels, now)
        done = stop_of(axis, actuator)
        if done.plan.fallback is not None:
            continue
        stopped += 1
        # No reversal, and all within the period.
        directions = {math.copysign(1.0, level) for level in done.plan.levels if level}
        assert len(directions) <= 1
        assert {abs(level) for level in done.plan.levels} <= {0.0, 1.0}
        # Superposed, a pulse that is over can leave a velocity backward: that is its direction.
        if axis.level or axis.lag[:, 0].sum() > 1e-6:
            assert -1.0 not in directions
        assert done.plan.levels[-1:] in ((0.0,), ())
        assert all(now <= time <= now + PERIOD_S for time in done.plan.times_s)
        assert sorted(done.plan.times_s) == list(done.plan.times_s)
        command = whole_command(times, levels, done.plan)
        left, unit, _ = ringing_after(command, actuator, frequency, 0.0)
        assert abs(left[0]) / abs(unit[0]) <= 1e-9
    assert stopped > 15


@pytest.mark.parametrize("actuator", DRIVES)
def test_a_move_backward_stops_as_its_mirror_image(actuator: Unlimited) -> None:
    times = [0.0, 0.7, 1.1]
    forward = stop_of(driven(actuator, times, [1.0, 0.0, 1.0], 1.5), actuator)
    back = stop_of(driven(actuator, times, [-1.0, 0.0, -1.0], 1.5), actuator)
    assert back.plan.times_s == pytest.approx(forward.plan.times_s, abs=1e-12)
    assert [-one for one in back.plan.levels] == pytest.approx(forward.plan.levels)
    assert back.way_s == pytest.approx(-forward.way_s, abs=1e-12)


def test_a_dead_time_delays_the_answer_alone() -> None:
    times, levels = [0.0, 0.8], [1.0, 0.0]
    late = replace(KIM, dead_time_s=0.07)
    one, other = (stop_of(driven(drive, times, levels, 1.0), drive) for drive in (KIM, late))
    # The state when the drive answers is that of an event a dead time later.
    assert min(other.plan.times_s) >= 1.0
    assert other.end_s == pytest.approx(one.end_s + 0.07)


def test_two_modes_are_both_brought_to_rest() -> None:
    plant = Modes(
        modes=(
            Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01),
            Mode(natural_frequency_rad_s=9.4, damping_ratio=0.0),
        )
    )
    rows = rows_of(LiveMachine(plant=plant, actuator=KIM))
    started = replace(at_rest(2, LiveKind()), plan=Plan(times_s=(0.0, 0.6), levels=(0.4, 1.0)))
    axis = carry(rows, started, 1.7)
    done = emergency_stop(KIM, plant.modes, axis, EmergencyRequest(within_periods=2))
    assert done.plan.fallback is None
    command = whole_command([0.0, 0.6], [0.4, 1.0], done.plan)
    for mode in plant.modes:
        assert residual_vibration(command, mode, KIM) <= 1e-9


def test_a_swing_that_damps_out_by_itself_needs_no_pulse() -> None:
    damped = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.4)
    request = EmergencyRequest(swing_left=0.1)
    done = emergency_stop(Ideal(), (damped,), FULL_SPEED, request)
    assert done.plan.levels == (0.0,)
    assert done.way_s == 0
    assert done.swing_left == pytest.approx(math.exp(-0.4 * math.tau), rel=1e-12)


def test_at_rest_there_is_nothing_to_do() -> None:
    done = stop_of(at_rest(1, LiveKind()), KIM)
    assert done.plan == Plan()
    assert done.way_s == done.swing_left == 0


def test_what_cannot_be_met_is_told_with_about_the_least() -> None:
    # Off at once leaves -1, and a command of a quarter period adds j exp(-j t) dt: by duality the
    # largest of -cos(p) + integral min(0, sin(p + t)) over the phase p is left, sqrt(2) - 1.
    done = stop_of(FULL_SPEED, periods=0.25)
    assert done.plan.fallback is not None
    assert "within 0.25 periods no stop was found with a swing of 0" in done.plan.fallback
    assert done.swing_left == pytest.approx(math.sqrt(2) - 1, abs=0.005)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"swing_left": -0.1}, "swing_left must be between 0 and 1, got -0.1"),
        ({"swing_left": 1.0}, "swing_left must be between 0 and 1, got 1.0"),
        ({"swing_left": math.nan}, "swing_left must be between 0 and 1, got nan"),
        ({"within_periods": 0.0}, "within_periods must be between 0.05 and 8, got 0.0"),
        ({"within_periods": -1.0}, "within_periods must be between 0.05 and 8, got -1.0"),
        ({"within_periods": 9.0}, "within_periods must be between 0.05 and 8, got 9.0"),
    ],
)
def test_a_request_outside_its_rule_is_refused(fields: dict[str, float], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        EmergencyRequest(**fields)


def test_a_first_order_drive_of_two_sets_stops_too() -> None:
    drive = FirstOrder(accel_time_constant_s=0.12, decel_time_constant_s=0.065, model="switched")
    done = stop_of(FULL_SPEED, drive, swing_left=0.05)
    assert done.swing_left == pytest.approx(0.05, abs=1e-10)
