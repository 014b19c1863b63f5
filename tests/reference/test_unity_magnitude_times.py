"""Published and exact switch times of UMZV and UMZVD, in undamped periods.

W. Singhose, W. Seering, N. Singer, "Time-optimal negative input shapers", J. Dyn. Sys., Meas.,
Control 119 (1997), and its polynomials, checked against designs.
"""

import numpy as np
import pytest

from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.types import FloatArray
from tests.shaper_table import IDEAL

UMZVD_POLYNOMIALS = np.array([
    [0.08945, 0.28411, 0.23013, 0.16401],
    [0.36613, -0.08833, 0.24048, 0.17001],
    [0.64277, 0.29103, 0.23262, 0.43784],
    [0.73228, 0.00992, 0.49385, 0.38633],
])


def periods(name: str, damping_ratio: float) -> FloatArray:
    mode = Mode(natural_frequency_rad_s=2 * np.pi, damping_ratio=damping_ratio)
    return design(mode, IDEAL, SHAPERS[name]).impulses.times_s[1:]


@pytest.mark.parametrize(
    ("damping_ratio", "times"),
    [
        (0.0, [1 / 6, 1 / 3]),
        (0.05, [0.18140570, 0.33392558]),
        (0.1, [0.19679995, 0.33571738]),
        (0.2, [0.22990226, 0.34311836]),
    ],
)
def test_umzv_is_exact(damping_ratio: float, times: list[float]) -> None:
    assert periods("umzv", damping_ratio) == pytest.approx(times, abs=0.51e-8)  # every digit


@pytest.mark.parametrize(
    ("damping_ratio", "times"),
    [
        (0.0, [0.08951255, 0.36623382, 0.64295510, 0.73246765]),
        (0.1, [0.12030677, 0.35983063, 0.67456449, 0.73853028]),
    ],
)
def test_umzvd_is_exact(damping_ratio: float, times: list[float]) -> None:
    assert periods("umzvd", damping_ratio) == pytest.approx(times, abs=0.51e-8)  # every digit


def published_times(damping_ratio: float) -> FloatArray:
    values: FloatArray = UMZVD_POLYNOMIALS @ damping_ratio ** np.arange(4)
    return values


def test_the_published_polynomials_fit_to_2e_4_of_a_period_up_to_a_damping_of_0_3() -> None:
    errors = [
        np.abs(periods("umzvd", z) - published_times(z)).max() for z in np.linspace(0, 0.3, 31)
    ]
    assert max(errors) == pytest.approx(1.9e-4, abs=0.051e-4)  # two digits known


def test_the_published_polynomials_are_off_by_4e_3_of_a_period_at_a_damping_of_0_5() -> None:
    error = np.abs(periods("umzvd", 0.5) - published_times(0.5)).max()
    assert error == pytest.approx(4.4e-3, abs=0.051e-3)


def test_the_undamped_umzvd_is_symmetric_in_time() -> None:
    # Mirrored in time an undamped shaper is a shaper: t2 + t4 = t5, and t3 is the middle.
    t2, t3, t4, t5 = periods("umzvd", 0.0).tolist()
    assert t2 + t4 == pytest.approx(t5, abs=1e-12)  # roots found to 1e-13
    assert 2 * t3 == pytest.approx(t5, abs=1e-12)
