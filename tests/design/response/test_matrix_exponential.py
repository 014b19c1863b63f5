"""The stacked matrix exponential against closed forms and against SciPy's."""

import math

import numpy as np
import pytest

from design.response.matrix_exponential import BLOCK, exponentials
from design.types import FloatArray

EPS = 2.0**-52


def rotation(phase: float) -> FloatArray:
    return np.array([[0.0, phase], [-phase, 0.0]])


def test_the_exponential_of_nothing_is_the_identity() -> None:
    assert exponentials(np.zeros((3, 2, 2))).tolist() == [np.eye(2).tolist()] * 3


def test_a_stack_of_none_gives_none() -> None:
    assert exponentials(np.zeros((0, 4, 4))).shape == (0, 4, 4)


def test_a_shift_gives_the_powers_over_factorials() -> None:
    result = exponentials(np.diag([1.0, 1.0, 1.0], k=1)[None])[0]
    # A few roundings of the 13 terms.
    assert result[0] == pytest.approx([1, 1, 1 / 2, 1 / 6], abs=4 * EPS)


@pytest.mark.parametrize("phase", [1e-8, 0.3, 5.37, 5.38, 100.0, 1e4, 1e6])
def test_a_rotation_keeps_its_phase_and_its_size(phase: float) -> None:
    result = exponentials(rotation(phase)[None])[0]
    expected = [[math.cos(phase), math.sin(phase)], [-math.sin(phase), math.cos(phase)]]
    # Each squaring doubles the error, so that it grows with the phase itself.
    assert result == pytest.approx(np.array(expected), abs=8 * EPS * max(1.0, phase))


@pytest.mark.parametrize("rate", [1e2, 1e4, 1e6])
def test_the_slow_mode_of_a_stiff_system_keeps_its_digits(rate: float) -> None:
    result = exponentials(np.diag([-rate, -0.7])[None])[0]
    # The identity is taken off before squaring: without that the error is EPS * rate.
    assert result[1, 1] == pytest.approx(math.exp(-0.7), rel=50 * EPS)
    assert abs(result[0, 0]) <= 10 * EPS


def test_one_scaling_for_the_stack_costs_its_small_members_nothing() -> None:
    small = rotation(1e-3)
    alone, beside = exponentials(small[None])[0], exponentials(np.stack([small, 1e6 * small]))[0]
    assert beside == pytest.approx(alone, abs=10 * EPS)  # a few roundings


def test_a_stack_of_several_blocks_is_that_of_its_members() -> None:
    phases = np.linspace(0, 20, 2 * BLOCK + 3)
    result = exponentials(np.stack([rotation(phase) for phase in phases.tolist()]).reshape(
        -1, 1, 2, 2
    ))  # fmt: skip
    assert result.shape == (phases.size, 1, 2, 2)
    assert result[:, 0, 0, 0] == pytest.approx(np.cos(phases), abs=100 * EPS)


@pytest.mark.parametrize("size", [1, 2, 4, 6])
@pytest.mark.parametrize("scale", [1e-6, 0.1, 3.0, 30.0])
def test_random_stable_matrices_agree_with_scipy(size: int, scale: float) -> None:
    from scipy.linalg import expm

    random = np.random.default_rng(10 * size)
    matrices = scale * random.standard_normal((8, size, size)) / size
    # Shifted so that nothing grows, as nothing does in an actuator on a plant.
    growth = np.linalg.eigvals(matrices).real.max(axis=1)
    matrices -= np.maximum(growth, 0.0)[:, None, None] * np.eye(size)
    expected = np.stack([expm(one) for one in matrices])
    # Both routes lose EPS times the norm.
    norm = np.abs(matrices).sum(axis=1).max()
    assert exponentials(matrices) == pytest.approx(expected, abs=10 * EPS * (1 + norm))


@pytest.mark.parametrize("rate", [1e2, 1e3, 1e4, 1e5, 1e6])
def test_stiff_lags_on_a_slow_mode_agree_with_scipy(rate: float) -> None:
    from scipy.linalg import expm

    random = np.random.default_rng(7)
    for _ in range(20):
        w, z = random.uniform(1, 5), random.uniform(0, 0.3)
        matrix = np.array([[-rate, 0, 0], [0, 0, w], [w, -w, -2 * z * w]])
        # SciPy squares the exponential itself and loses EPS * rate on its diagonal.
        assert exponentials(matrix[None])[0] == pytest.approx(expm(matrix), abs=4 * EPS * rate)


def test_stiff_lags_on_a_slow_mode_agree_with_the_closed_form() -> None:
    # y' = -y + x, x' = -rate x:  y(1) from x(0) = 1 is (e^-1 - e^-rate) / (rate - 1).
    for rate in (1e2, 1e4, 1e6):
        result = exponentials(np.array([[[-rate, 0.0], [1.0, -1.0]]]))[0]
        assert result[1, 0] == pytest.approx(math.exp(-1) / (rate - 1), rel=1e-13)
        assert result[1, 1] == pytest.approx(math.exp(-1), rel=50 * EPS)


def test_two_halves_make_a_whole() -> None:
    random = np.random.default_rng(3)
    matrices = random.standard_normal((5, 4, 4))
    halves = exponentials(matrices / 2)
    assert halves @ halves == pytest.approx(exponentials(matrices), rel=1e-12, abs=1e-13)


def test_leading_axes_are_kept() -> None:
    random = np.random.default_rng(4)
    matrices = random.standard_normal((2, 3, 4, 4))
    one_by_one = [[exponentials(m[None])[0] for m in row] for row in matrices]
    # Only the common scaling differs.
    assert exponentials(matrices) == pytest.approx(np.array(one_by_one), abs=1e-13)
