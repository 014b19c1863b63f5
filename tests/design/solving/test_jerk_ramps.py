"""The fastest shapers behind a limit to the jerk: values, bounds, and no faster one."""

import math
from dataclasses import replace

import cvxpy as cp
import numpy as np
import pytest

from design.analysis.shortest_jerk_ramps import JERKS, JerkProof, excluded_jerky_end_rad
from design.errors import InfeasibleDesignError
from design.formulations.ramped import RampedProblem, ramped_problem
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import design
from design.shapers.num_multi import SeveralModesOptions
from design.shapers.registry import SHAPERS
from design.shapers.settle_options import SettleOptions
from design.solvers.budget import Budget
from design.solving.ramps import solve_behind_limits
from tests.jerk_route import integrate_jerk_limited
from tests.refusals import refused

MODE = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01)
DRIVE = RateLimited(
    accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.4, jerk_limit_m_s3=100.0
)


def swing_left(times_s: np.ndarray, mode: Mode, drive: RateLimited, ratio: float = 1.0) -> float:
    """Amplitude of the free swing when all is over, by integration, times w."""
    from design.model.impulses import Impulses

    w = mode.natural_frequency_rad_s
    true = Mode(natural_frequency_rad_s=ratio * w, damping_ratio=mode.damping_ratio)
    steps = Impulses(times_s=times_s, amplitudes=(-1.0) ** np.arange(times_s.size))
    end = float(times_s[-1]) + sum(drive.unit_ramps_s)
    deflection, rate, *_ = integrate_jerk_limited(steps, true, drive, end)
    return math.hypot(w * deflection, rate)


def random_drives(seed: int, count: int) -> list[tuple[Mode, RateLimited, str]]:
    """Ramps and times to their full slope from a thousandth of a period to a whole one."""
    rng = np.random.default_rng(seed)
    cases = []
    for _ in range(count):
        mode = Mode(
            natural_frequency_rad_s=float(rng.uniform(0.5, 20)),
            damping_ratio=float(rng.choice([0, rng.uniform(0, 0.1), rng.uniform(0, 0.25)])),
        )
        up, down, bend = (mode.period_s * 10 ** rng.uniform(-2.5, 0, 3)).tolist()
        limited = RateLimited(
            accel_limit_m_s2=1 / up,
            decel_limit_m_s2=1 / down,
            speed_m_s=1.0,
            jerk_limit_m_s3=1 / (up * bend),
        )
        cases.append((mode, limited, str(rng.choice(["numzv", "numzvd"]))))
    return cases


@pytest.mark.parametrize(
    ("jerk", "kind", "end_s"),
    [
        # From a search over six changes of the jerk; without its limit .8422 and 1.5473 s.
        (100.0, "numzv", 0.858152),
        (100.0, "umzvd", 1.563785),
        (20.0, "umzv", 0.925911),
        (20.0, "numzvd", 1.640029),
        (3.0, "numzv", 1.374543),
    ],
)
def test_shapers_of_practice_end_as_early_as_is_possible(
    jerk: float, kind: str, end_s: float
) -> None:
    drive = replace(DRIVE, jerk_limit_m_s3=jerk)
    found = design(MODE, drive, SHAPERS[kind])
    assert found.certificate.verified
    assert not found.for_ideal
    assert found.solver.lower_bound_s == pytest.approx(end_s, abs=2e-6)
    assert found.solver.gap is not None
    assert 0 <= found.solver.gap < 1e-8
    assert swing_left(found.impulses.times_s, MODE, drive) < 1e-8
    if kind.endswith("d"):
        beside = [swing_left(found.impulses.times_s, MODE, drive, 1 + by) for by in (1e-3, -1e-3)]
        assert max(beside) < 1e-4  # of second order in 1e-3


@pytest.mark.parametrize(("mode", "limited", "kind"), random_drives(7, 40))
def test_random_drives_are_solved_with_a_bound(mode: Mode, limited: RateLimited, kind: str) -> None:
    found = design(mode, limited, SHAPERS[kind])
    assert found.certificate.verified
    assert found.solver.gap is not None
    assert found.solver.gap < 1e-6
    # No limit to the jerk is no slower.
    free = design(mode, replace(limited, jerk_limit_m_s3=None), SHAPERS[kind])
    assert free.solver.lower_bound_s is not None
    assert found.solver.lower_bound_s is not None
    assert free.solver.lower_bound_s < found.solver.lower_bound_s * (1 + 1e-9)


def test_a_jerk_beyond_reach_gives_the_optimum_without() -> None:
    found, free = (
        design(MODE, replace(DRIVE, jerk_limit_m_s3=jerk), SHAPERS["numzvd"])
        for jerk in (1e7, None)
    )
    np.testing.assert_allclose(found.impulses.times_s, free.impulses.times_s, atol=1e-6)


@pytest.mark.parametrize("kind", ["multi_umzv", "num_multi", "num_multi with slopes"])
@pytest.mark.parametrize("count", [2, 3])
def test_several_modes_are_served_with_a_bound(count: int, kind: str) -> None:
    rng = np.random.default_rng(count)
    modes = Modes(
        modes=tuple(
            Mode(natural_frequency_rad_s=float(w), damping_ratio=float(rng.uniform(0, 0.05)))
            for w in np.cumsum(rng.uniform(1, 3, count))
        )
    )
    name, _, slopes = kind.partition(" with ")
    options = SeveralModesOptions(slope=True) if slopes else None
    found = design(modes, DRIVE, SHAPERS[name], options)
    assert found.certificate.verified
    assert found.solver.gap is not None
    assert found.solver.gap < 1e-6
    for mode in modes.modes:
        assert swing_left(found.impulses.times_s, mode, DRIVE) < 1e-8
        # Where slopes vanish, a share off leaves its square times a bend of (w t)^2 / 2, some
        # hundreds; where they do not, it leaves the slope times it.
        beside = swing_left(found.impulses.times_s, mode, DRIVE, 1 + 1e-4)
        assert beside < 1e-5 if slopes else beside > 1e-5


def test_one_lag_that_follows_changes_no_switch() -> None:
    lag = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1, model="switched")
    alone = design(MODE, DRIVE, SHAPERS["numzvd"])
    found = design(MODE, replace(DRIVE, then=lag), SHAPERS["numzvd"])
    assert found.certificate.verified
    np.testing.assert_allclose(found.impulses.times_s, alone.impulses.times_s, atol=1e-12)


def least_left(problem: RampedProblem, end_rad: float, cells: int) -> float:
    """Return the least that slopes on a grid leave at an end: by a cone program."""
    assert problem.jerk is not None
    edges = np.linspace(0, end_rad, cells + 1)
    middle, width = (edges[1:] + edges[:-1]) / 2, float(edges[1])
    poles = problem.unit_poles[:, None]
    kernels = np.where(problem.orders[:, None] == 1, -middle, 1.0) * np.exp(-poles * middle)
    kernels = kernels * np.exp(problem.unit_poles.real * end_rad)[:, None] * width
    slopes = cp.Variable(cells + 1)
    means = (slopes[1:] + slopes[:-1]) / 2
    levels = cp.cumsum(means) * width
    left = cp.norm(np.vstack((kernels.real, kernels.imag)) @ means, 1)
    rise, fall = problem.ramps_rad
    program = cp.Problem(
        cp.Minimize(left),
        [
            slopes <= 1 / rise,
            slopes >= -1 / fall,
            cp.abs(cp.diff(slopes)) <= problem.jerk * width,
            slopes[0] == 0,
            slopes[-1] == 0,
            levels >= 0,
            levels <= 1,
            levels[-1] == 1,
        ],
    )
    program.solve(solver=cp.HIGHS)
    return float(program.value) if program.status == "optimal" else math.inf


@pytest.mark.parametrize(("derivatives", "jerk"), [(0, 20.0), (1, 20.0), (0, 3.0), (1, 100.0)])
def test_no_slopes_on_a_fine_grid_are_faster(derivatives: int, jerk: float) -> None:
    drive = replace(DRIVE, jerk_limit_m_s3=jerk)
    problem = ramped_problem((MODE,), drive, derivatives=derivatives, max_duration_periods=3.0)
    found = next(solve_behind_limits(problem, Budget()))
    assert found.solver.lower_bound_s is not None
    bound = 3.5 * found.solver.lower_bound_s
    # The grid's own error is some 1e-5; a hundredth less of time leaves a hundred times that.
    assert least_left(problem, 1.01 * bound, 600) < 3e-4
    assert least_left(problem, 0.99 * bound, 600) > 3e-3


def test_a_bound_is_for_its_targets() -> None:
    # The fastest rise alone ends after two equal pieces: the bound of y = 1 - t is exact.
    still = JerkProof(
        poles=np.array([1j]),
        orders=np.zeros(1),
        multipliers=np.zeros(1, dtype=np.complex128),
        targets=np.zeros(1, dtype=np.complex128),
        up=10.0,
        down=10.0,
        jerk=1.0,
        last=1.0,
        events=np.array([0.0, 1.0, 2.0]),
        stages=(JERKS, JERKS),
        prices=np.full(2, -1.0),
        final=-1.0,
    )
    assert still.surplus(2.0) == pytest.approx(0.0, abs=1e-12)
    assert excluded_jerky_end_rad(still) == pytest.approx(2.0, rel=1e-9)
    # The end of other targets, 1e-3 off, is excluded less late by what they are worth.
    off = replace(still, multipliers=np.ones(1, dtype=np.complex128) * 1e-2, prices=still.prices)
    assert excluded_jerky_end_rad(off) < 2.0


def test_a_horizon_too_short_is_refused_with_the_bound() -> None:
    options = SettleOptions(max_duration_periods=0.5)
    with pytest.raises(InfeasibleDesignError) as refusal:
        design(MODE, DRIVE, SHAPERS["numzvd"], options)
    assert refusal.value.code == "ramps_exceed_duration"


@pytest.mark.parametrize("kind", ["numzv", "numzvd"])
def test_what_has_to_settle_or_differs_in_its_lags_is_refused(kind: str) -> None:
    apart = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
    with refused("jerk_not_served", "actuator.jerk_limit_m_s3"):
        design(MODE, replace(DRIVE, then=apart), SHAPERS[kind])
    with refused("jerk_not_served", "actuator.jerk_limit_m_s3"):
        options = SHAPERS[kind].options(settle=True)
        design(MODE, DRIVE, SHAPERS[kind], options)


@pytest.mark.parametrize("slope", [False, True])
def test_several_modes_behind_two_lags_are_refused(*, slope: bool) -> None:
    modes = Modes(modes=(MODE, replace(MODE, natural_frequency_rad_s=9.4)))
    apart = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
    with refused("jerk_not_served", "actuator.jerk_limit_m_s3", says="where one lag follows"):
        options = SeveralModesOptions(slope=slope)
        design(modes, replace(DRIVE, then=apart), SHAPERS["num_multi"], options)


@pytest.mark.parametrize("jerk", [0.3, 100.0])
@pytest.mark.parametrize("kind", ["numzv", "numzvd", "num_ei", "num_2ei", "num_si"])
def test_what_is_not_served_is_named_however_long_its_ramps_are(kind: str, jerk: float) -> None:
    # At 0.3 m/s^3 a ramp lasts for more than a period: too long for five switches in three.
    apart = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
    drive = replace(DRIVE, jerk_limit_m_s3=jerk)
    for then, settle in ((apart, False), (apart, True), (drive.then, True)):
        options = SHAPERS[kind].options(settle=settle)
        with refused("jerk_not_served", "actuator.jerk_limit_m_s3"):
            design(MODE, replace(drive, then=then), SHAPERS[kind], options)
