"""The fastest shapers behind limits: their values, their bounds, and no faster one."""

import math
from itertools import pairwise

import cvxpy as cp
import numpy as np
import pytest

from design.analysis.shortest_ramps import RampedProof, excluded_end_rad
from design.errors import InfeasibleDesignError
from design.formulations.ramped import RampedProblem, ramped_problem
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.pipeline import Design, design
from design.shapers.registry import SHAPERS
from design.shapers.settle_options import SettleOptions
from design.solvers.budget import Budget
from design.solving.ramps import solve_behind_limits
from tests.expm_route import outcome, slope

DRIVE = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.4)
CRANE = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0)
"""Drives of the cases that follow."""

CASES: dict[str, tuple[Plant, RateLimited, str, float]] = {
    "drive, numzv": (Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01), DRIVE, "numzv", 0.8425),
    "drive, numzvd": (
        Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01), DRIVE, "numzvd", 1.5475,
    ),
    "crane, umzv": (Pendulum(cable_length_m=9.0, gravity_m_s2=9.81), CRANE, "umzv", 4.626),
    "crane, numzv": (Pendulum(cable_length_m=9.0, gravity_m_s2=9.81), CRANE, "numzv", 4.626),
    "crane, numzvd": (Pendulum(cable_length_m=9.0, gravity_m_s2=9.81), CRANE, "numzvd", 6.679),
    "crane, umzvd": (Pendulum(cable_length_m=9.0, gravity_m_s2=9.81), CRANE, "umzvd", 6.679),
}  # fmt: skip
"""Plant, drive, kind, and the latest end of the last ramp by a grid program [s]."""


def of_one_set(mode: Mode) -> SecondOrder:
    one = SecondOrderSet(
        natural_frequency_rad_s=2 * mode.natural_frequency_rad_s, damping_ratio=0.7
    )
    return SecondOrder(accel=one, decel=one)


def random_drives(
    seed: int, count: int, shortest: float = 0.05
) -> list[tuple[Mode, RateLimited, str]]:
    """Return cases with ramps from the shortest to 3 periods, and what follows symmetric."""
    rng = np.random.default_rng(seed)
    cases = []
    for _ in range(count):
        mode = Mode(
            natural_frequency_rad_s=float(rng.uniform(0.5, 20)),
            damping_ratio=float(rng.choice([0, rng.uniform(0, 0.1), rng.uniform(0, 0.3)])),
        )
        up, down = mode.period_s * np.exp(rng.uniform(math.log(shortest), math.log(3), 2))
        lag = of_one_set(mode)
        then = lag if rng.random() < 0.3 else Ideal()
        limited = RateLimited(
            accel_limit_m_s2=1 / up, decel_limit_m_s2=1 / down, speed_m_s=1.0, then=then
        )
        cases.append((mode, limited, str(rng.choice(["numzv", "numzvd"]))))
    return cases


def end_s(found: Design, limited: RateLimited) -> float:
    """Return when the last ramp ends, by the slopes between the switches."""
    level = 0.0
    switches = found.impulses.times_s.tolist()
    up, down = limited.accel_limit_m_s2, limited.decel_limit_m_s2
    for number, (now, following) in enumerate(pairwise(switches)):
        change = (up if number % 2 == 0 else -down) * (following - now) / limited.speed_m_s
        level = min(1.0, max(0.0, level + change))
    return float(switches[-1]) + (1 - level) * limited.speed_m_s / up


@pytest.mark.parametrize(("plant", "limited", "kind", "latest_s"), CASES.values(), ids=CASES)
def test_shapers_of_practice_end_as_early_as_is_possible(
    plant: Plant, limited: RateLimited, kind: str, latest_s: float
) -> None:
    found = design(plant, limited, SHAPERS[kind])
    end, bound = end_s(found, limited), found.solver.lower_bound_s
    assert end <= latest_s
    assert bound is not None
    assert bound <= end * (1 + 1e-12)
    assert bound >= 0.999 * end
    assert found.certificate.verified
    assert not found.for_ideal


def test_switches_of_equal_limits_are_those_that_practice_asked_for() -> None:
    limited = RateLimited(accel_limit_m_s2=4, decel_limit_m_s2=4, speed_m_s=1.0)
    found = design(Mode(natural_frequency_rad_s=2 * math.pi), limited, SHAPERS["numzv"])
    np.testing.assert_allclose(found.impulses.times_s, [0, 0.20589889, 0.36769666], atol=1e-8)


@pytest.mark.parametrize(
    ("mode", "limited", "kind"), [*random_drives(4, 40), *random_drives(5, 20, shortest=1e-6)]
)
def test_random_drives_are_solved_with_a_bound(mode: Mode, limited: RateLimited, kind: str) -> None:
    found = design(mode, limited, SHAPERS[kind])
    assert found.solver.gap is not None
    assert found.solver.gap < 1e-3
    assert outcome(found.impulses, mode, limited).residual < 1e-8
    if isinstance(limited.then, Ideal):  # a ramp turned midway is as designed, not unsettled
        assert not found.warnings
    if kind == "numzvd":
        assert slope(found.impulses, mode, limited) < 1e-5


@pytest.mark.parametrize("count", [2, 3, 4])
def test_several_modes_behind_limits_are_served_with_a_bound(count: int) -> None:
    rng = np.random.default_rng(count)
    modes = Modes(
        modes=tuple(
            Mode(natural_frequency_rad_s=float(w), damping_ratio=float(rng.uniform(0, 0.05)))
            for w in np.cumsum(rng.uniform(1, 3, count))
        )
    )
    found = design(modes, DRIVE, SHAPERS["multi_umzv"])
    assert found.certificate.verified
    assert not found.for_ideal
    assert found.solver.gap is not None
    assert found.solver.gap < 1e-3
    for mode in modes.modes:
        assert outcome(found.impulses, mode, DRIVE).residual < 1e-8


def least_left(problem: RampedProblem, end_rad: float, cells: int) -> float:
    """Return the least that a reference on a grid leaves at an end: by a cone program."""
    edges = np.linspace(0, end_rad, cells + 1)
    middle = (edges[1:] + edges[:-1]) / 2
    poles = problem.unit_poles[:, None]
    width = edges[1]
    kernels = np.where(problem.orders[:, None] == 1, -middle, 1.0) * np.exp(-poles * middle)
    kernels = kernels * np.exp(problem.unit_poles.real * end_rad)[:, None]
    levels = cp.Variable(cells + 1)
    rises = cp.diff(levels)
    up, down = (width / ramp for ramp in problem.ramps_rad)
    left = cp.norm(np.vstack((kernels.real, kernels.imag)) @ rises, 1)
    program = cp.Problem(
        cp.Minimize(left),
        [levels >= 0, levels <= 1, levels[0] == 0, levels[-1] == 1, rises <= up, rises >= -down],
    )
    program.solve(solver=cp.HIGHS)
    return float(program.value) if program.status == "optimal" else math.inf


@pytest.mark.parametrize(("mode", "limited", "kind"), random_drives(7, 6))
def test_a_dense_program_finds_the_same_end(mode: Mode, limited: RateLimited, kind: str) -> None:
    problem = ramped_problem(
        (mode,), limited, derivatives=int(kind == "numzvd"), max_duration_periods=20.0
    )
    end = end_s(design(mode, limited, SHAPERS[kind]), limited) * mode.natural_frequency_rad_s
    assert least_left(problem, 0.998 * end, 400) > 1e-6
    assert least_left(problem, 1.004 * end, 400) < 1e-8


def test_what_ends_after_the_horizon_is_refused_with_its_bound() -> None:
    limited = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0)
    options = SettleOptions(max_duration_periods=0.1)
    with pytest.raises(InfeasibleDesignError) as caught:
        design(Pendulum(cable_length_m=9.0, gravity_m_s2=9.81), limited, SHAPERS["numzvd"], options)
    assert caught.value.code == "ramps_exceed_duration"
    assert "none ends before 1.10967" in str(caught.value)


def test_a_search_without_work_says_so() -> None:
    problem = ramped_problem(
        (Mode(natural_frequency_rad_s=1.0),), CRANE, derivatives=0, max_duration_periods=3.0
    )
    with pytest.raises(InfeasibleDesignError) as caught:
        next(solve_behind_limits(problem, Budget(most=0)))
    assert caught.value.code == "no_ramped_command_found"


def test_a_bound_is_below_what_any_multipliers_exclude() -> None:
    """The surplus by plain sums over a fine grid, whatever the multipliers: never above."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        ends = np.sort(rng.uniform(1, 9, 3))
        proof = RampedProof(
            tolerance=0.0,
            poles=np.array([-0.05 + 1j, -0.05 + 1j]),
            orders=np.array([0.0, 1.0]),
            multipliers=rng.normal(size=2) + 1j * rng.normal(size=2),
            targets=np.zeros(2, dtype=complex),
            up=float(rng.uniform(0.2, 2)),
            down=float(rng.uniform(0.2, 2)),
            last=1.0,
            rests=ends[None, :2],
            turns=ends[:1],
            end=float(ends[2]),
        )
        times = np.linspace(0, proof.end, 40_001)
        kernels = np.stack((
            np.exp(-proof.poles[0] * times),
            -times * np.exp(-proof.poles[1] * times),
        ))
        pull = (proof.multipliers.conj() @ kernels).real
        arriving, leaving = np.searchsorted(times, ends[:2])
        n = np.where(times <= ends[0], -pull[arriving], -1 / proof.up - pull[-1])
        resting = (times > ends[0]) & (times <= ends[1])
        n[resting] = -pull[resting]
        q = pull + n
        cost = np.maximum(-proof.up * q, proof.down * q)
        falls = -np.minimum(np.diff(n), 0).sum()
        plain = -np.trapezoid(cost, times) - n[-1] - falls
        assert proof.surplus(proof.end) == pytest.approx(plain, rel=2e-3, abs=2e-3)
        assert excluded_end_rad(proof) <= proof.end
        assert leaving > arriving
