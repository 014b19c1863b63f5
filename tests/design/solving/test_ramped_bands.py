"""The fastest shapers over a band behind limits: values, bounds, and no faster one."""

import math

import cvxpy as cp
import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.formulations.ramped_band import ramped_band_problem
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.pipeline import Design, design
from design.shapers.numsi import NUM_SI, UnityBandOptions
from design.solvers.budget import Budget
from design.solving.ramps import solve_band_behind_limits
from tests.design.solving.test_ramps import CRANE, DRIVE, end_s, of_one_set
from tests.expm_route import outcome

CASES: dict[str, tuple[Plant, RateLimited, float, float]] = {
    "drive": (Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01), DRIVE, 1.42, 1.4190986),
    "crane": (Pendulum(cable_length_m=9.0, gravity_m_s2=9.81), CRANE, 6.12, 6.1119065),
}
"""Plant, drive, the latest end for 10 % at 5 %, by a grid program, and the end found [s]."""

Case = tuple[Mode, RateLimited, UnityBandOptions]


def random_bands(seed: int, count: int) -> list[Case]:
    """Return cases with ramps from .05 to 3 periods, bands from 1 to 40 %, 1 to 20 % left."""
    rng = np.random.default_rng(seed)
    cases = []
    for _ in range(count):
        mode = Mode(
            natural_frequency_rad_s=float(rng.uniform(0.5, 20)),
            damping_ratio=float(rng.choice([0, 0.001, 0.01, 0.05, 0.2])),
        )
        up, down = mode.period_s * np.exp(rng.uniform(math.log(0.05), math.log(3), 2))
        limited = RateLimited(
            accel_limit_m_s2=1 / up,
            decel_limit_m_s2=1 / down,
            speed_m_s=1.0,
            then=of_one_set(mode) if rng.random() < 0.3 else Ideal(),
        )
        half_width, tolerance = np.exp(rng.uniform(np.log([0.01, 0.01]), np.log([0.4, 0.2])))
        options = UnityBandOptions(
            half_width=float(half_width), tolerance=float(tolerance), max_duration_periods=8.0
        )
        cases.append((mode, limited, options))
    return cases


def largest_left(found: Design, mode: Mode, limited: RateLimited, half_width: float) -> float:
    """Return the largest residual over the band, by another route."""
    ratios = np.linspace(1 - half_width, 1 + half_width, 21).tolist()
    modes = [
        Mode(
            natural_frequency_rad_s=ratio * mode.natural_frequency_rad_s,
            damping_ratio=mode.damping_ratio,
        )
        for ratio in ratios
    ]
    return max(outcome(found.impulses, one, limited).residual for one in modes)


@pytest.mark.parametrize(("plant", "limited", "latest_s", "end"), CASES.values(), ids=CASES)
def test_bands_of_practice_end_as_early_as_is_possible(
    plant: Plant, limited: RateLimited, latest_s: float, end: float
) -> None:
    options = UnityBandOptions(half_width=0.1, tolerance=0.05)
    found = design(plant, limited, NUM_SI, options)
    assert found.certificate.verified
    assert not found.for_ideal
    assert end_s(found, limited) == pytest.approx(end, abs=1e-6)
    assert end_s(found, limited) <= latest_s
    assert found.solver.lower_bound_s is not None
    assert found.solver.lower_bound_s == pytest.approx(end_s(found, limited), rel=1e-6)
    assert largest_left(found, plant.modes[0], limited, 0.1) <= 0.05 * (1 + 1e-9)


@pytest.mark.parametrize(("mode", "limited", "options"), random_bands(11, 40))
def test_random_bands_are_served_with_a_bound(
    mode: Mode, limited: RateLimited, options: UnityBandOptions
) -> None:
    found = design(mode, limited, NUM_SI, options)
    assert found.certificate.verified
    assert found.solver.lower_bound_s is not None
    end = end_s(found, limited)
    assert (1 - 1e-3) * end < found.solver.lower_bound_s <= end * (1 + 1e-12)
    left = largest_left(found, mode, limited, options.half_width)
    assert left <= options.tolerance * (1 + 1e-9)


def least_left(mode: Mode, limited: RateLimited, options: UnityBandOptions, end: float) -> float:
    """Return the least largest residual of an even grid's courses that end in time."""
    cells, ratios = 300, np.linspace(1 - options.half_width, 1 + options.half_width, 41)
    times = np.linspace(0, end, cells + 1)
    poles = mode.pole_rad_s * ratios[:, None]
    # The integral of exp(s (T - t)) over a cell, for a slope of 1 there.
    weights = np.diff(-np.exp(poles * (end - times)) / poles, axis=1)
    slopes, most = cp.Variable(cells), cp.Variable()
    levels = cp.cumsum(slopes) * (end / cells)
    left = cp.vstack((weights.real @ slopes, weights.imag @ slopes))
    program = cp.Problem(
        cp.Minimize(most),
        [
            cp.SOC(most * np.ones(ratios.size), left),
            slopes <= limited.accel_limit_m_s2,
            slopes >= -limited.decel_limit_m_s2,
            levels >= 0,
            levels <= 1,
            levels[-1] == 1,
        ],
    )
    program.solve(solver=cp.CLARABEL)
    return float(program.value) if program.status == "optimal" else math.inf


@pytest.mark.parametrize(("mode", "limited", "options"), random_bands(13, 6))
def test_a_dense_cone_program_finds_the_same_end(
    mode: Mode, limited: RateLimited, options: UnityBandOptions
) -> None:
    end = end_s(design(mode, limited, NUM_SI, options), limited)
    assert least_left(mode, limited, options, 0.998 * end) > options.tolerance
    assert least_left(mode, limited, options, 1.004 * end) < options.tolerance


def test_a_ramp_that_keeps_the_tolerance_by_itself_is_the_fastest() -> None:
    mode = Mode(natural_frequency_rad_s=1.0)
    limited = RateLimited(accel_limit_m_s2=1 / mode.period_s, decel_limit_m_s2=0.5, speed_m_s=1.0)
    found = design(mode, limited, NUM_SI, UnityBandOptions(half_width=0.04, tolerance=0.05))
    assert found.impulses.amplitudes.tolist() == [1.0]
    assert found.solver.lower_bound_s == pytest.approx(mode.period_s, rel=1e-9)
    # sinc(ratio) is .05 at 1.0525 and .0526 at .95.
    wider = design(mode, limited, NUM_SI, UnityBandOptions(half_width=0.06, tolerance=0.05))
    assert wider.impulses.amplitudes.size > 1


def test_a_dip_shorter_than_any_cell_is_found() -> None:
    mode = Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=0.001)
    limited = RateLimited(accel_limit_m_s2=1 / 1.97919, decel_limit_m_s2=1 / 0.58217, speed_m_s=1.0)
    options = UnityBandOptions(half_width=0.019625, tolerance=0.0297245, max_duration_periods=8.0)
    found = design(mode, limited, NUM_SI, options)
    assert np.diff(found.impulses.times_s).min() < 1e-3
    assert end_s(found, limited) == pytest.approx(found.solver.lower_bound_s, rel=1e-6)


def test_a_band_that_ends_after_the_horizon_is_refused_with_its_bound() -> None:
    options = UnityBandOptions(half_width=0.3, tolerance=0.02, max_duration_periods=0.1)
    with pytest.raises(InfeasibleDesignError) as caught:
        design(Pendulum(cable_length_m=9.0, gravity_m_s2=9.81), CRANE, NUM_SI, options)
    assert caught.value.code == "ramps_exceed_duration"
    assert "none ends before 1.68447" in str(caught.value)


def test_a_search_over_a_band_without_work_says_so() -> None:
    problem = ramped_band_problem(
        Mode(natural_frequency_rad_s=1.0),
        CRANE,
        half_width=0.1,
        tolerance=0.05,
        max_duration_periods=3.0,
    )
    with pytest.raises(InfeasibleDesignError) as caught:
        next(solve_band_behind_limits(problem, Budget(most=0)))
    assert caught.value.code == "no_ramped_command_found"
    assert "budget" in str(caught.value)
