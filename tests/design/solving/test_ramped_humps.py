"""Shapers with humps behind limits: their curves, and no faster course with their zeros."""

import math

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.pipeline import Design, design
from design.shapers.numei import NUM_2EI, NUM_EI, HumpOptions
from design.shapers.numsi import NUM_SI, UnityBandOptions
from design.solvers.budget import Budget
from design.solving.solve import solve
from tests.design.solving.test_ramps import end_s, of_one_set
from tests.expm_route import outcome
from tests.refusals import refused

Case = tuple[Mode, RateLimited, HumpOptions]


def random_humps(seed: int, count: int) -> list[Case]:
    """Return cases with ramps from .03 to 1 period, and humps from 1 to 15 %."""
    rng = np.random.default_rng(seed)
    cases = []
    for _ in range(count):
        mode = Mode(
            natural_frequency_rad_s=float(rng.uniform(0.5, 20)),
            damping_ratio=float(rng.choice([0, 0.01, 0.05, 0.1])),
        )
        up, down = mode.period_s * np.exp(rng.uniform(math.log(0.03), 0.0, 2))
        limited = RateLimited(
            accel_limit_m_s2=1 / up,
            decel_limit_m_s2=1 / down,
            speed_m_s=1.0,
            then=of_one_set(mode) if rng.random() < 0.3 else Ideal(),
        )
        tolerance = float(np.exp(rng.uniform(math.log(0.01), math.log(0.15))))
        cases.append((mode, limited, HumpOptions(tolerance=tolerance, max_duration_periods=8.0)))
    return cases


def left_at(found: Design, mode: Mode, limited: RateLimited, ratio: float) -> float:
    """Return the residual at a ratio of the frequency, by another route."""
    off = Mode(
        natural_frequency_rad_s=ratio * mode.natural_frequency_rad_s,
        damping_ratio=mode.damping_ratio,
    )
    return outcome(found.impulses, off, limited).residual


@pytest.mark.parametrize(("mode", "limited", "options"), random_humps(5, 15))
def test_one_hump_has_its_height_and_peak_at_the_nominal_frequency(
    mode: Mode, limited: RateLimited, options: HumpOptions
) -> None:
    found = design(mode, limited, NUM_EI, options)
    assert found.certificate.verified
    assert not found.for_ideal
    nominal = left_at(found, mode, limited, 1.0)
    assert nominal == pytest.approx(options.tolerance, rel=1e-7)
    beside = [left_at(found, mode, limited, 1 + change) for change in (-1e-3, 1e-3)]
    assert max(beside) < nominal
    assert beside[0] == pytest.approx(beside[1], rel=1e-4)


@pytest.mark.parametrize(("mode", "limited", "options"), random_humps(6, 15))
def test_two_humps_have_their_height_beside_a_zero(
    mode: Mode, limited: RateLimited, options: HumpOptions
) -> None:
    found = design(mode, limited, NUM_2EI, options)
    assert found.certificate.verified
    assert left_at(found, mode, limited, 1.0) < 1e-8
    ratios = np.linspace(0.4, 1.6, 241)
    curve = np.array([left_at(found, mode, limited, one) for one in ratios.tolist()])
    for side in (ratios < 1, ratios > 1):
        order = np.argsort(np.abs(ratios[side] - 1))
        outward = curve[side][order]
        top = next(k for k in range(1, outward.size - 1) if outward[k] >= outward[k + 1])
        assert outward[top] == pytest.approx(options.tolerance, rel=5e-3)
        assert outward[top] <= options.tolerance * (1 + 1e-9)


def test_a_tolerance_over_the_band_of_a_hump_takes_no_longer() -> None:
    mode = Mode(natural_frequency_rad_s=3.5)
    limited = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.4)
    humps = design(mode, limited, NUM_EI, HumpOptions(tolerance=0.05))
    band = next(claim.band for claim in humps.certificate.claims if claim.quantity == "band")
    assert band is not None
    half_width = (band[1] - band[0]) / 2
    over = design(mode, limited, NUM_SI, UnityBandOptions(half_width=half_width, tolerance=0.05))
    assert end_s(over, limited) <= end_s(humps, limited) * (1 + 1e-6)


def test_humps_that_no_course_has_are_refused() -> None:
    mode = Mode(natural_frequency_rad_s=1.0)
    limited = RateLimited(
        accel_limit_m_s2=1 / (1.5 * mode.period_s),
        decel_limit_m_s2=1 / (1.5 * mode.period_s),
        speed_m_s=1.0,
    )
    with pytest.raises(InfeasibleDesignError) as caught:
        design(mode, limited, NUM_EI, HumpOptions(tolerance=0.15))
    assert caught.value.code == "no_ramped_humps_found"
    assert "num_si" in str(caught.value)


def test_humps_that_end_after_the_horizon_are_refused() -> None:
    mode = Mode(natural_frequency_rad_s=1.0)
    limited = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=1.0, speed_m_s=1.0)
    with pytest.raises(InfeasibleDesignError) as caught:
        design(mode, limited, NUM_EI, HumpOptions(tolerance=0.05, max_duration_periods=0.1))
    assert caught.value.code == "ramped_humps_exceed_duration"


def test_zeros_for_which_the_budget_is_too_small_are_refused_with_their_places() -> None:
    mode = Mode(natural_frequency_rad_s=1.0)
    limited = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=1.0, speed_m_s=1.0)
    problem = NUM_2EI.formulate(NUM_2EI.case((mode,), limited, HumpOptions(tolerance=0.05)))
    says = r"without residual at 0\.\d+ and 1\.\d+ of the frequency: its budget of 0\.001 million"
    with refused("no_ramped_zeros_found", says=says):
        list(solve(problem, Budget(most=1000.0)))
