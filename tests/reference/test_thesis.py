"""Numbers of Kim's master thesis (2011), chapter 3, and what becomes of them when recomputed.

The thesis's own variants of the equations are written out here and solved by SciPy; the package
designs with the exact slope.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest

from design.analysis.insensitivity import insensitivity
from design.analysis.residual import residual_vibration
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.types import FloatArray
from tests.shaper_table import CRANE, THESIS

W = CRANE.mode.natural_frequency_rad_s
SIGNS = np.array([1.0, -1.0, 1.0, -1.0, 1.0])
UMZVD_SEED = 2 * math.pi * np.array([0.08945, 0.36613, 0.64277, 0.73228])
"""Table 3-1 at no damping, times w."""

TABLE_3_2 = np.array([
    [0.0534, -0.3856, 0.8690],
    [0.2184, -1.5773, 3.4823],
    [0.3834, -2.7689, 6.1304],
    [0.4367, -3.1546, 6.9634],
])
"""t2 to t5 as a w^2 + b w + c."""

EQ_3_60 = np.array([0.1739, 0.6369, 1.1360, 1.2724])

FREQUENCIES = np.linspace(1.0, 4.0, 31)
"""Those that the table's polynomials were fitted through [rad/s]."""

Equations = Callable[[FloatArray, float], FloatArray]


def alpha_and_beta(w: float) -> tuple[float, float]:
    """Eq. 3.50, from the gains of both sets at jw."""
    gains = [a * a / (a * a - w * w + 2j * z * a * w) for a, z in ((20.0, 0.8), (50.0, 1.5))]
    ratio = gains[1] / gains[0]
    return abs(ratio), -math.atan2(ratio.imag, ratio.real)


def phase_kept(times: FloatArray, w: float) -> FloatArray:
    """Eqs. 3.45-3.48 at no damping: the actuator's phase kept, its slope ignored."""
    return constraints(times, w, slope_phase=True)


def phase_dropped(times: FloatArray, w: float) -> FloatArray:
    """Leave beta out of the two rows of the slope too."""
    return constraints(times, w, slope_phase=False)


def constraints(times: FloatArray, w: float, *, slope_phase: bool) -> FloatArray:
    alpha, beta = alpha_and_beta(w)
    t = np.concatenate(([0.0], times))
    weights = SIGNS * np.array([1.0, alpha, 1.0, alpha, 1.0])
    late = np.array([0.0, beta, 0.0, beta, 0.0])
    value = (weights * np.exp(1j * (w * t + late))).sum()
    slope = (weights * t * np.exp(1j * (w * t + late * slope_phase))).sum()
    return np.array([value.real, value.imag, slope.real, slope.imag])


def solve_equations(equations: Equations, w: float) -> FloatArray:
    from scipy.optimize import root

    end = root(equations, UMZVD_SEED / w, args=(w,), tol=1e-14)
    assert np.abs(end.fun).max() < 1e-12
    times: FloatArray = end.x
    return times


def command(times: FloatArray) -> Impulses:
    return Impulses(
        times_s=np.concatenate(([0.0], times)), amplitudes=SIGNS[: times.size + 1].copy()
    )


def residual(times: FloatArray, w: float, actuator: Actuator = THESIS) -> float:
    return residual_vibration(command(times), Mode(natural_frequency_rad_s=w), actuator)


def width(times: FloatArray) -> float:
    interval = insensitivity(command(times), CRANE.mode, THESIS, 0.05)
    assert interval is not None
    assert interval.width is not None
    return interval.width


@pytest.fixture(scope="module")
def solutions() -> FloatArray:
    """Solve 3.45-3.48: rows of t2 to t5 over `FREQUENCIES`."""
    return np.array([solve_equations(phase_kept, w) for w in FREQUENCIES.tolist()])


@pytest.fixture(scope="module")
def fitted(solutions: FloatArray) -> FloatArray:
    """Quadratics in w through the solutions, rows of coefficients a, b, c."""
    return np.polyfit(FREQUENCIES, solutions, 2).T


def polynomials(table: FloatArray, w: float) -> FloatArray:
    return np.array([np.polyval(row, w) for row in table])


def test_the_crane_swings_at_3_50_rad_per_s() -> None:
    assert pytest.approx(3.50178526, abs=5e-9) == W  # every digit known


def test_alpha_and_beta_are_those_of_the_package() -> None:
    from design.formulations.lag_parameters import decel_over_accel

    alpha, beta = alpha_and_beta(W)
    ratio = decel_over_accel(CRANE.mode, THESIS)
    assert [alpha, beta] == pytest.approx([0.9921129437, -0.0732506641], abs=0.51e-10)
    assert abs(ratio) == pytest.approx(alpha, rel=1e-14)
    assert -math.atan2(ratio.imag, ratio.real) == pytest.approx(beta, abs=1e-14)


@pytest.mark.parametrize(
    ("name", "times", "insensitive", "digits"),
    [
        ("numzv", [0.32126352, 0.60069086], 0.05520, 8),
        ("numzvd", [0.18211712, 0.66033323, 1.18087995, 1.32079496], 0.25866, 8),
        ("umzvd", [0.160611, 0.657126, 1.153642, 1.314252], 0.21247, 6),
    ],
)
def test_designs_at_the_thesis_parameters(
    name: str, times: list[float], insensitive: float, digits: int
) -> None:
    made = design(CRANE, THESIS, SHAPERS[name]).impulses.times_s[1:]
    assert made == pytest.approx(times, abs=0.51 * 10.0**-digits)  # every digit known
    assert width(made) == pytest.approx(insensitive, abs=0.51e-5)


@pytest.mark.parametrize(
    ("equations", "times", "insensitive"),
    [
        (phase_kept, [0.17966144, 0.66058444, 1.17758684, 1.31968167], 0.25856),
        (phase_dropped, [0.15977778, 0.67590937, 1.16871988, 1.33368704], 0.22683),
    ],
)
def test_the_thesis_own_equations_give_zero_residual_but_not_zero_slope(
    equations: Equations, times: list[float], insensitive: float
) -> None:
    made = solve_equations(equations, W)
    assert made == pytest.approx(times, abs=0.51e-8)
    assert width(made) == pytest.approx(insensitive, abs=0.51e-5)
    assert residual(made, W) < 1e-12
    # At 1 % off the exact slope leaves only the curvature: it is the smallest of all.
    exact = design(CRANE, THESIS, SHAPERS["numzvd"]).impulses.times_s[1:]
    off = [max(residual(t, 0.999 * W), residual(t, 1.001 * W)) for t in (exact, made)]
    assert off[0] < off[1]


def test_the_thesis_sine_and_cosine_rows_are_the_same_equations() -> None:
    # 3.52-3.55 written out as in the thesis, beta in all four.
    alpha, beta = alpha_and_beta(W)
    t2, t3, t4, t5 = solve_equations(phase_kept, W)
    late2, late4 = W * t2 + beta, W * t4 + beta
    rows = [
        1 - alpha * math.cos(late2) + math.cos(W * t3) - alpha * math.cos(late4) + math.cos(W * t5),
        -alpha * math.sin(late2) + math.sin(W * t3) - alpha * math.sin(late4) + math.sin(W * t5),
        -alpha * t2 * math.cos(late2)
        + t3 * math.cos(W * t3)
        - alpha * t4 * math.cos(late4)
        + t5 * math.cos(W * t5),
        alpha * t2 * math.sin(late2)
        - t3 * math.sin(W * t3)
        + alpha * t4 * math.sin(late4)
        - t5 * math.sin(W * t5),
    ]
    assert rows == pytest.approx([0, 0, 0, 0], abs=1e-12)


def test_umzvd_ignoring_the_actuator_leaves_2_45_percent() -> None:
    made = design(CRANE, THESIS, SHAPERS["umzvd"])
    assert made.residual == pytest.approx(0.0245, abs=0.51e-4)


@pytest.mark.parametrize(("name", "share"), [("numzvd", 0.052), ("numzv", 0.147)])
def test_swapping_the_sets_by_mistake_costs_what_compensation_gains(
    name: str, share: float
) -> None:
    made = design(CRANE, THESIS, SHAPERS[name]).impulses
    swapped = SecondOrder(accel=THESIS.decel, decel=THESIS.accel)
    assert residual_vibration(made, CRANE.mode, swapped) == pytest.approx(share, abs=0.51e-3)


def test_table_3_2_is_a_quadratic_fit_to_every_printed_digit(fitted: FloatArray) -> None:
    assert np.round(fitted, 4).tolist() == TABLE_3_2.tolist()


def test_the_fit_of_table_3_2_has_an_r_of_0_992_where_0_9999_is_printed(
    solutions: FloatArray, fitted: FloatArray
) -> None:
    errors = solutions - np.array([polynomials(fitted, w) for w in FREQUENCIES.tolist()])
    spread = solutions - solutions.mean(axis=0)
    r = np.sqrt(1 - (errors**2).sum(axis=0) / (spread**2).sum(axis=0))
    assert r == pytest.approx(0.992, abs=0.51e-3)


def test_table_3_2_is_off_by_up_to_0_358_s(solutions: FloatArray) -> None:
    errors = np.abs(solutions - np.array([polynomials(TABLE_3_2, w) for w in FREQUENCIES.tolist()]))
    assert errors.max() == pytest.approx(0.358, abs=0.51e-3)
    assert np.unravel_index(errors.argmax(), errors.shape) == (0, 3)  # t5 at 1 rad/s


def test_table_3_2_leaves_up_to_7_7_percent() -> None:
    left = [residual(polynomials(TABLE_3_2, w), w) for w in np.linspace(1, 4, 301).tolist()]
    assert max(left) == pytest.approx(0.077, abs=0.51e-3)
    assert residual(polynomials(TABLE_3_2, W), W) == pytest.approx(0.0065, abs=0.51e-4)


def test_eq_3_60_comes_from_the_fit_behind_table_3_2_and_is_no_solution(
    fitted: FloatArray,
) -> None:
    assert np.round(polynomials(fitted, W), 4).tolist() == EQ_3_60.tolist()
    assert residual(EQ_3_60, W) == pytest.approx(0.0037, abs=0.51e-4)
    assert np.abs(constraints(EQ_3_60, W, slope_phase=True)).max() > 1e-3


@pytest.mark.parametrize(("degree", "left"), [(2, 2.0e-5), (5, 1.9e-9), (8, 5e-13)])
def test_fitted_without_dimension_the_times_serve_the_whole_range(degree: int, left: float) -> None:
    # t ~ 1/w is no polynomial; w t is nearly one. Through as many Chebyshev points as coefficients.
    points = 2.5 - 1.5 * np.cos(math.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    phases = [
        w * design(Mode(natural_frequency_rad_s=w), THESIS, SHAPERS["numzvd"]).impulses.times_s[1:]
        for w in points.tolist()
    ]
    fit = np.polyfit(points / 20, np.array(phases), degree).T
    grid = np.linspace(1, 4, 301).tolist()
    worst = max(residual(polynomials(fit, w / 20) / w, w) for w in grid)
    assert worst == pytest.approx(left, rel=0.1)  # one or two digits known
