"""The fastest shapers over a band behind a limit to the jerk: values, bounds, and no faster one."""

import math
from dataclasses import replace

import cvxpy as cp
import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.formulations.ramped_band import ramped_band_problem
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.ramps import ramped
from design.pipeline import Design, design
from design.shapers.numsi import NUM_SI, UnityBandOptions
from design.solvers.budget import Budget
from design.solving.ramps import solve_band_behind_limits
from tests.design.solving.test_ramped_bands import random_bands
from tests.jerk_route import integrate_jerk_limited
from tests.refusals import refused

MODE = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01)
STRAIGHT = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.4)
BAND = UnityBandOptions(half_width=0.1, tolerance=0.05)
STRAIGHT_END_S = 1.4190986
"""Of `BAND` without a limit to the jerk."""

Case = tuple[Mode, RateLimited, UnityBandOptions]


def limited_jerk(drive: RateLimited, rng: np.random.Generator, shortest: float) -> RateLimited:
    """Return a drive with a limit to the jerk.

    The time to its steepest slope is a share of a ramp, of which the shortest is given.
    """
    ramp_s = drive.speed_m_s / float(rng.choice([drive.accel_limit_m_s2, drive.decel_limit_m_s2]))
    to_limit_s = ramp_s * float(np.exp(rng.uniform(math.log(shortest), 0)))
    return replace(drive, jerk_limit_m_s3=float(drive.accel_limit_m_s2 / to_limit_s))


def with_jerk(seed: int, count: int, shortest: float = 0.02) -> list[Case]:
    """Return random bands behind limits with a limit to the jerk too, where that is served."""
    rng = np.random.default_rng(seed)
    cases = [
        (mode, limited_jerk(limited, rng, shortest), options)
        for mode, limited, options in random_bands(seed, count)
    ]
    return [case for case in cases if max(case[1].unit_ramps_s) < 3 * case[0].period_s]


def end_of(found: Design, drive: RateLimited) -> float:
    """Return when the last ramp ends; integration asks whether the level is 1 then."""
    made = ramped(found.impulses, drive)
    return float(made.times_s[-1] + made.ramps_s[-1])


def left_at(found: Design, mode: Mode, drive: RateLimited, ratio: float) -> float:
    """Return the residual at a ratio of the frequency, by integration of an ideal drive.

    With d'' + 2 z w d' + w^2 d = -v' the number d' - conj(s) d is driven by -v' alone.
    """
    true = replace(mode, natural_frequency_rad_s=ratio * mode.natural_frequency_rad_s)
    times = found.impulses.times_s
    command = Impulses(times_s=times, amplitudes=(-1.0) ** np.arange(times.size))
    alone = replace(drive, then=Ideal())
    deflection, rate, _, level = integrate_jerk_limited(command, true, alone, end_of(found, drive))
    assert level == pytest.approx(1.0, abs=1e-9)
    return float(abs(rate - true.pole_rad_s.conjugate() * deflection))


@pytest.mark.parametrize(
    ("jerk", "end"),
    # From dense cone programs: 1.5106 and 1.9065 s.
    [(20.0, 1.5105791), (3.0, 1.9064645)],
)
def test_bands_of_practice_end_as_early_as_is_possible(jerk: float, end: float) -> None:
    drive = replace(STRAIGHT, jerk_limit_m_s3=jerk)
    found = design(MODE, drive, NUM_SI, BAND)
    assert found.certificate.verified
    assert not found.for_ideal
    assert found.solver.gap is not None
    assert 0 <= found.solver.gap < 1e-8
    assert end_of(found, drive) == pytest.approx(end, abs=1e-6)
    left = [left_at(found, MODE, drive, ratio) for ratio in (0.9, 0.95, 1.0, 1.05, 1.1)]
    assert max(left) == pytest.approx(0.05, rel=1e-7)


def test_without_limit_to_the_jerk_the_end_is_that_of_straight_ramps() -> None:
    drives = [replace(STRAIGHT, jerk_limit_m_s3=jerk) for jerk in (1e3, 1e4, 1e6)]
    ends = [end_of(design(MODE, drive, NUM_SI, BAND), drive) for drive in drives]
    # The end is later by a time that goes as one over the jerk.
    later = np.array(ends) - STRAIGHT_END_S
    assert later[0] / later[1] == pytest.approx(10, rel=1e-2)
    assert abs(later[2]) < 2e-6


@pytest.mark.parametrize(("mode", "drive", "options"), with_jerk(17, 12))
def test_random_drives_are_solved_with_a_bound(
    mode: Mode, drive: RateLimited, options: UnityBandOptions
) -> None:
    found = design(mode, drive, NUM_SI, options)
    assert found.certificate.verified
    assert found.solver.gap is not None
    assert 0 <= found.solver.gap < 1e-6
    # Straight ramps are no slower, and the mean of theirs over the time in which a slope turns
    # from limit to limit is a course within the jerk of no larger residual.
    free = replace(drive, jerk_limit_m_s3=None)
    straight = end_of(design(mode, free, NUM_SI, options), free)
    assert drive.jerk_limit_m_s3 is not None
    turning = (drive.accel_limit_m_s2 + drive.decel_limit_m_s2) / drive.jerk_limit_m_s3
    assert straight * (1 - 1e-9) <= end_of(found, drive) <= (straight + turning) * (1 + 1e-9)


@pytest.mark.parametrize(("mode", "drive", "options"), with_jerk(18, 8))
def test_random_drives_keep_their_tolerance_by_integration(
    mode: Mode, drive: RateLimited, options: UnityBandOptions
) -> None:
    found = design(mode, drive, NUM_SI, options)
    ratios = np.linspace(1 - options.half_width, 1 + options.half_width, 5).tolist()
    left = [left_at(found, mode, drive, ratio) for ratio in ratios]
    assert max(left) <= options.tolerance * (1 + 1e-7)


def least_left(mode: Mode, drive: RateLimited, options: UnityBandOptions, end: float) -> float:
    """Return the least largest residual of an even grid's slopes that end in time."""
    assert drive.jerk_limit_m_s3 is not None
    cells, ratios = 240, np.linspace(1 - options.half_width, 1 + options.half_width, 41)
    width = end / cells
    nodes, shares = np.polynomial.legendre.leggauss(6)
    inner = (nodes + 1) / 2
    times = width * (np.arange(cells)[:, None] + inner)
    kernels = np.exp(mode.pole_rad_s * ratios[:, None, None] * (end - times)) * shares * width / 2
    before, after = (kernels * (1 - inner)).sum(axis=2), (kernels * inner).sum(axis=2)
    slopes, most = cp.Variable(cells + 1), cp.Variable()
    levels = cp.cumsum((slopes[1:] + slopes[:-1]) / 2) * width
    left = [
        part @ slopes[:-1] + other @ slopes[1:]
        for part, other in ((before.real, after.real), (before.imag, after.imag))
    ]
    program = cp.Problem(
        cp.Minimize(most),
        [
            cp.SOC(most * np.ones(ratios.size), cp.vstack(left)),
            slopes <= drive.accel_limit_m_s2 / drive.speed_m_s,
            slopes >= -drive.decel_limit_m_s2 / drive.speed_m_s,
            cp.abs(cp.diff(slopes)) <= drive.jerk_limit_m_s3 / drive.speed_m_s * width,
            slopes[0] == 0,
            slopes[-1] == 0,
            levels >= 0,
            levels <= 1,
            levels[-1] == 1,
        ],
    )
    program.solve(solver=cp.CLARABEL)
    return float(program.value) if program.status == "optimal" else math.inf


@pytest.mark.parametrize(
    ("mode", "drive", "options"),
    [(MODE, replace(STRAIGHT, jerk_limit_m_s3=jerk), BAND) for jerk in (20.0, 3.0)]
    + with_jerk(19, 6),
)
def test_no_slopes_of_a_dense_cone_program_are_faster(
    mode: Mode, drive: RateLimited, options: UnityBandOptions
) -> None:
    found = design(mode, drive, NUM_SI, options)
    assert found.solver.lower_bound_s is not None
    # Courses of the grid are courses: none keeps the tolerance before the bound. That it is kept
    # at some ratios alone is worth a ten thousandth of the time.
    assert least_left(mode, drive, options, 0.9995 * found.solver.lower_bound_s) > options.tolerance
    assert least_left(mode, drive, options, 1.005 * end_of(found, drive)) < options.tolerance


def test_a_ramp_that_keeps_the_tolerance_by_itself_is_the_fastest() -> None:
    mode = Mode(natural_frequency_rad_s=1.0)
    # It rises for a period at most, and leaves nothing there.
    limit = 1 / mode.period_s
    drive = RateLimited(
        accel_limit_m_s2=limit, decel_limit_m_s2=0.5, speed_m_s=1.0, jerk_limit_m_s3=1.0
    )
    options = UnityBandOptions(half_width=0.04, tolerance=0.05)
    found = design(mode, drive, NUM_SI, options)
    assert found.impulses.amplitudes.tolist() == [1.0]
    assert end_of(found, drive) == pytest.approx(drive.unit_ramps_s[0], rel=1e-12)
    assert found.solver.gap is not None
    assert found.solver.gap < 1e-8


def test_one_lag_that_follows_changes_no_switch() -> None:
    drive = replace(STRAIGHT, jerk_limit_m_s3=20.0)
    lag = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1, model="switched")
    found = design(MODE, replace(drive, then=lag), NUM_SI, BAND)
    assert found.certificate.verified
    alone = design(MODE, drive, NUM_SI, BAND)
    np.testing.assert_allclose(found.impulses.times_s, alone.impulses.times_s, atol=1e-12)


def test_a_horizon_too_short_is_refused_with_the_bound() -> None:
    drive = replace(STRAIGHT, jerk_limit_m_s3=20.0)
    with pytest.raises(InfeasibleDesignError) as refusal:
        design(MODE, drive, NUM_SI, replace(BAND, max_duration_periods=0.3))
    assert refusal.value.code == "ramps_exceed_duration"


def test_a_spent_budget_is_told() -> None:
    drive = replace(STRAIGHT, jerk_limit_m_s3=20.0)
    problem = ramped_band_problem(
        MODE, drive, half_width=0.1, tolerance=0.05, max_duration_periods=3.0
    )
    with refused("no_ramped_command_found"):
        next(solve_band_behind_limits(problem, Budget(most=0.0)))


@pytest.mark.parametrize("options", [replace(BAND, settle=True), replace(BAND, impulses=5)])
def test_a_number_of_impulses_or_settling_is_refused(options: UnityBandOptions) -> None:
    drive = replace(STRAIGHT, jerk_limit_m_s3=20.0)
    with refused("jerk_not_served", "actuator.jerk_limit_m_s3"):
        design(MODE, drive, NUM_SI, options)


def test_two_different_lags_are_refused() -> None:
    apart = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
    with refused("jerk_not_served", "actuator.jerk_limit_m_s3"):
        design(MODE, replace(STRAIGHT, jerk_limit_m_s3=20.0, then=apart), NUM_SI, BAND)
