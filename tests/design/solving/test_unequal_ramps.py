"""Shapers behind limits and two lags: certified by another route, and never slower than before."""

from dataclasses import replace

import numpy as np
import pytest

from design.curve_fit.fit import fit
from design.curve_fit.fit_range import FitRange
from design.errors import InfeasibleDesignError
from design.formulations.behind_limits import behind_limits
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.formulations.unity_magnitude import ZERO_VIBRATION, ZERO_VIBRATION_DERIVATIVE
from design.formulations.unity_magnitude_problem import unity_magnitude_problem
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.second_order import SecondOrder
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.shapers.settle_options import SettleOptions
from design.solvers.budget import Budget
from design.solvers.search import candidates
from design.solving.unequal_ramps import solve_behind_two_lags
from tests import expm_route
from tests.acceptance.random_ramps import Drive, random_drive

DRIVES = [random_drive(number) for number in range(24)]


@pytest.mark.parametrize("drive", DRIVES)
def test_random_drives_are_shaped(drive: Drive) -> None:
    found = design(drive.mode, drive.limited, SHAPERS[drive.kind])
    assert found.certificate.verified
    assert not found.for_ideal
    assert found.solver.lower_bound_s is None
    played = expm_route.outcome(found.impulses, drive.mode, drive.limited)
    assert played.residual < 1e-9
    if drive.kind == "numzvd":
        assert expm_route.slope(found.impulses, drive.mode, drive.limited) < 1e-5


@pytest.mark.parametrize("drive", DRIVES[:8])
def test_a_plant_and_drive_half_as_fast_take_twice_as_long(drive: Drive) -> None:
    limited, then = drive.limited, drive.limited.then
    slower: FirstOrder | SecondOrder
    if isinstance(then, FirstOrder):
        slower = replace(
            then,
            accel_time_constant_s=2 * then.accel_time_constant_s,
            decel_time_constant_s=2 * then.decel_time_constant_s,
        )
    else:
        assert isinstance(then, SecondOrder)
        accel, decel = (
            replace(one, natural_frequency_rad_s=one.natural_frequency_rad_s / 2)
            for one in (then.accel, then.decel)
        )
        slower = replace(then, accel=accel, decel=decel)
    slow = replace(limited, speed_m_s=2 * limited.speed_m_s, then=slower)
    mode = replace(drive.mode, natural_frequency_rad_s=drive.mode.natural_frequency_rad_s / 2)
    kind = SHAPERS[drive.kind]
    first, second = design(drive.mode, limited, kind), design(mode, slow, kind)
    np.testing.assert_allclose(second.impulses.times_s, 2 * first.impulses.times_s, rtol=1e-9)


@pytest.mark.parametrize("drive", DRIVES[:12])
def test_none_is_slower_than_the_fastest_of_whole_ramps(drive: Drive) -> None:
    found = design(drive.mode, drive.limited, SHAPERS[drive.kind]).impulses
    model = ZERO_VIBRATION if drive.kind == "numzv" else ZERO_VIBRATION_DERIVATIVE
    ends = []
    try:
        whole = unity_magnitude_problem(
            model, drive.mode, drive.limited, settle=False, max_duration_periods=5.0
        )
        for number, one in enumerate(candidates(whole, Budget(most=100_000))):
            ends.append(expm_route.end_s(one.impulses, drive.limited))
            if number > 3:
                break
    except InfeasibleDesignError:
        pass
    assert expm_route.end_s(found, drive.limited) <= min(ends, default=np.inf) * (1 + 1e-9)


@pytest.mark.parametrize("number", [0, 1, 2, 3])
def test_several_modes_are_shaped(number: int) -> None:
    drive = random_drive(number)
    w = drive.mode.natural_frequency_rad_s
    slower = Mode(natural_frequency_rad_s=w / 2.7, damping_ratio=0.02)
    modes = Modes(modes=(slower, drive.mode))
    found = design(modes, drive.limited, SHAPERS["multi_umzv"])
    assert found.certificate.verified
    assert not found.for_ideal
    for mode in modes.modes:
        assert expm_route.outcome(found.impulses, mode, drive.limited).residual < 1e-9


def problem_of(drive: Drive, max_duration_periods: float = 3.0) -> UnequalRampsProblem:
    problem = behind_limits(
        (drive.mode,), drive.limited, derivatives=0, max_duration_periods=max_duration_periods
    )
    assert isinstance(problem, UnequalRampsProblem)
    return problem


def test_what_ends_after_the_horizon_is_refused() -> None:
    drive = DRIVES[2]
    with pytest.raises(InfeasibleDesignError) as caught:
        design(
            drive.mode,
            drive.limited,
            SHAPERS["numzvd"],
            SettleOptions(max_duration_periods=0.1),
        )
    assert caught.value.code == "ramps_found_exceed_duration"


def test_a_search_without_work_says_so() -> None:
    with pytest.raises(InfeasibleDesignError) as caught:
        next(solve_behind_two_lags(problem_of(DRIVES[2]), Budget(most=0)))
    assert caught.value.code == "no_ramped_command_found"


def test_a_curve_follows_the_plant_behind_two_lags() -> None:
    drive = DRIVES[2]
    w = drive.mode.natural_frequency_rad_s
    wanted = FitRange(over="natural_frequency_rad_s", start=0.98 * w, stop=1.02 * w, degree=4)
    made = fit(drive.mode, drive.limited, SHAPERS[drive.kind], wanted)
    assert made.worst_residual < 1e-4
    assert made.worst_timing_error_s * w < 1e-4
