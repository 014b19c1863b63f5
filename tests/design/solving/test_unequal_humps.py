"""Shapers with humps behind limits and two lags: their curves, by another route."""

from dataclasses import replace

import numpy as np
import pytest

from design.curve_fit.fit import fit
from design.curve_fit.fit_range import FitRange
from design.errors import InfeasibleDesignError, InvalidInputError
from design.formulations.ramped_humps import ramped_humps_problem
from design.formulations.unequal_humps import UnequalHumpsProblem
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import Design, design
from design.shapers.kind import ShaperKind
from design.shapers.numei import NUM_2EI, NUM_EI, HumpOptions
from design.shapers.numsi import NUM_SI, UnityBandOptions
from design.solvers.budget import Budget
from design.solvers.ramps.unequal_humps import follow_humps
from tests import expm_route
from tests.acceptance.random_unequal_bands import Case, random_band

CASES = [random_band(number) for number in range(16)]

LESS_THAN_A_PERIOD = [
    case for case in CASES if max(case.limited.straight_ramps_s) < case.mode.period_s
]


def humps(case: Case, kind: ShaperKind, periods: float = 8.0) -> Design:
    options = HumpOptions(tolerance=case.options.tolerance, max_duration_periods=periods)
    return design(case.mode, case.limited, kind, options)


def left_at(command: Impulses, case: Case, ratio: float) -> float:
    """Return the residual at a ratio of the frequency, by another route [-]."""
    w = case.mode.natural_frequency_rad_s
    off = replace(case.mode, natural_frequency_rad_s=ratio * w)
    return expm_route.outcome(command, off, case.limited).residual


@pytest.mark.parametrize("case", CASES)
def test_one_hump_has_its_height_and_peak_at_the_nominal_frequency(case: Case) -> None:
    found = humps(case, NUM_EI)
    assert found.certificate.verified
    assert not found.for_ideal
    assert found.solver.lower_bound_s is None
    below, nominal, above = (left_at(found.impulses, case, 1 + off) for off in (-1e-3, 0, 1e-3))
    assert nominal == pytest.approx(case.options.tolerance, rel=1e-8)
    assert max(below, above) < nominal
    assert below == pytest.approx(above, rel=1e-4)


@pytest.mark.parametrize("case", CASES)
def test_two_humps_have_their_height_beside_a_zero(case: Case) -> None:
    found = humps(case, NUM_2EI)
    assert found.certificate.verified
    assert left_at(found.impulses, case, 1.0) < 1e-9
    ratios = np.linspace(0.4, 1.8, 141)
    curve = np.array([left_at(found.impulses, case, one) for one in ratios.tolist()])
    for side in (ratios < 1, ratios > 1):
        outward = curve[side][np.argsort(np.abs(ratios[side] - 1))]
        top = next(k for k in range(1, outward.size - 1) if outward[k] >= outward[k + 1])
        assert outward[top] == pytest.approx(case.options.tolerance, rel=2e-2)
        assert outward[top] <= case.options.tolerance * (1 + 1e-9)


@pytest.mark.parametrize("kind", [NUM_EI, NUM_2EI])
@pytest.mark.parametrize("model", ["superposed", "switched"])
def test_two_lags_that_are_nearly_one_have_its_humps(kind: ShaperKind, model: Model) -> None:
    one = SecondOrderSet(natural_frequency_rad_s=30.0, damping_ratio=0.7)
    other = SecondOrderSet(natural_frequency_rad_s=30.0 * (1 + 1e-7), damping_ratio=0.7)
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01)
    both = []
    for decel in (one, other):
        limited = RateLimited(
            accel_limit_m_s2=1.6,
            decel_limit_m_s2=2.5,
            speed_m_s=0.4,
            then=SecondOrder(accel=one, decel=decel, model=model),
        )
        both.append(design(mode, limited, kind, HumpOptions(tolerance=0.05)).impulses.times_s)
    np.testing.assert_allclose(both[1], both[0], atol=1e-6)


@pytest.mark.parametrize("case", LESS_THAN_A_PERIOD[:4])
def test_a_tolerance_over_the_band_of_a_hump_takes_no_longer(case: Case) -> None:
    made = humps(case, NUM_EI)
    band = next(claim.band for claim in made.certificate.claims if claim.quantity == "band")
    assert band is not None
    options = UnityBandOptions(
        half_width=(band[1] - band[0]) / 2,
        tolerance=case.options.tolerance,
        max_duration_periods=8.0,
    )
    over = design(case.mode, case.limited, NUM_SI, options)
    ends = [expm_route.end_s(one.impulses, case.limited) for one in (over, made)]
    assert ends[0] <= ends[1] * (1 + 1e-6)


def test_humps_that_end_after_the_horizon_are_refused() -> None:
    with pytest.raises(InfeasibleDesignError) as caught:
        humps(random_band(16), NUM_EI, periods=0.1)
    assert caught.value.code == "ramped_humps_exceed_duration"


def test_humps_that_no_course_behind_one_lag_has_are_refused() -> None:
    with pytest.raises(InfeasibleDesignError) as caught:
        humps(random_band(30), NUM_EI)
    assert caught.value.code == "no_ramped_humps_found"
    assert "num_si" in str(caught.value)


def test_humps_that_are_not_followed_to_two_lags_are_refused() -> None:
    with pytest.raises(InfeasibleDesignError) as caught:
        humps(random_band(46), NUM_2EI)
    assert caught.value.code == "ramped_humps_not_followed"
    assert "num_si" in str(caught.value)


def test_a_search_without_work_finds_none() -> None:
    case = CASES[0]
    alike = ramped_humps_problem(
        case.mode,
        case.limited,
        zeros=(0.8, 1.2),
        humps=1,
        tolerance=0.05,
        max_duration_periods=3.0,
    )
    problem = UnequalHumpsProblem(alike=alike, designed_for=case.limited)
    switches = np.linspace(0, 5, 5)
    assert follow_humps(problem, switches, np.array([0.8, 1.2]), Budget(most=0)) is None


def test_no_curve_follows_humps_behind_limits() -> None:
    case = CASES[0]
    w = case.mode.natural_frequency_rad_s
    wanted = FitRange(over="natural_frequency_rad_s", start=0.98 * w, stop=1.02 * w, degree=4)
    with pytest.raises(InvalidInputError) as caught:
        fit(case.mode, case.limited, NUM_EI, wanted)
    assert caught.value.code == "fit_not_served"
