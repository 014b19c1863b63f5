"""Exponential, sine, cosine and angle against decimal series and the machine's library."""

import math
import re
from collections.abc import Callable
from decimal import Decimal, localcontext

import numba
import numpy as np
import pytest

from design.tables.elementary import (
    PI,
    angle,
    exponential,
    exponential_less_one,
    near_angle,
    sine_and_cosine,
)

DIGITS = 60


def places_off(found: float, exact: Decimal) -> float:
    """Return an error in units of the last place."""
    with localcontext(prec=DIGITS):
        return float(abs(Decimal(found) - exact) / Decimal(math.ulp(float(exact))))


def decimal_sine(x: float, *, quarters: int = 0) -> Decimal:
    """Return the sine of x and some right angles by its series, reduced to half a turn."""
    with localcontext(prec=DIGITS):
        rest = (Decimal(x) + quarters * PI / 2) % (2 * PI)
        rest -= 2 * PI * round(rest / (2 * PI))
        total = term = rest
        for n in range(3, 81, 2):
            term *= -rest * rest / (n * (n - 1))
            total += term
        return total


@pytest.mark.parametrize("largest", [1e-3, 1.0, 40.0, 690.0])
def test_the_exponential_is_right_to_the_last_place(largest: float) -> None:
    rng = np.random.default_rng(1)
    with localcontext(prec=DIGITS):
        for x in rng.uniform(-largest, largest, 1000).tolist():
            assert places_off(exponential(x), Decimal(x).exp()) <= 1.0
            assert places_off(exponential_less_one(x), Decimal(x).exp() - 1) <= 2.0


def test_a_little_less_one_keeps_all_digits() -> None:
    with localcontext(prec=DIGITS):
        for x in (-(10.0 ** np.arange(-15.0, 0.0))).tolist():
            assert places_off(exponential_less_one(x), Decimal(x).exp() - 1) <= 2.0


@pytest.mark.parametrize("largest", [0.7, 10.0, 1000.0])
def test_sine_and_cosine_are_right_to_the_last_places(largest: float) -> None:
    rng = np.random.default_rng(2)
    for x in rng.uniform(-largest, largest, 1000).tolist():
        sine, cosine = sine_and_cosine(x)
        assert places_off(sine, decimal_sine(x)) <= 2.0
        assert places_off(cosine, decimal_sine(x, quarters=1)) <= 2.0


def test_near_the_zeros_of_sine_and_cosine_all_digits_stay() -> None:
    """The doubles next to whole numbers of right angles, up to a thousand turns."""
    for k in range(1, 4000, 7):
        x = float(k * PI / 2)
        sine, cosine = sine_and_cosine(x)
        little, exact = (cosine, decimal_sine(x, quarters=1)) if k % 2 else (sine, decimal_sine(x))
        assert abs(exact) < 1e-12
        assert places_off(little, exact) <= 2.0


def test_they_agree_with_the_machine_s_library_wherever_arguments_may_lie() -> None:
    """Up to a million, as a lag far faster than its plant turns in a gap."""
    rng = np.random.default_rng(3)
    for x in (rng.choice([-1.0, 1.0], 5000) * 10 ** rng.uniform(-9, 6, 5000)).tolist():
        np.testing.assert_allclose(
            sine_and_cosine(x), (math.sin(x), math.cos(x)), rtol=5e-16, atol=0
        )
    for x in rng.uniform(-700, 700, 5000).tolist():
        assert exponential(x) == pytest.approx(math.exp(x), rel=3e-16)


def test_special_arguments() -> None:
    assert exponential(0.0) == 1.0
    assert exponential_less_one(0.0) == 0.0
    assert sine_and_cosine(0.0) == (0.0, 1.0)
    assert 0.0 < exponential(-math.inf) < 1e-300
    assert exponential(math.inf) > 1e300
    assert exponential_less_one(-1e9) == -1.0
    assert math.isnan(exponential(math.nan))
    assert np.isnan(sine_and_cosine(math.nan)).all()
    assert np.isnan(sine_and_cosine(math.inf)).all()


def test_an_angle_is_that_of_the_library_in_every_direction() -> None:
    rng = np.random.default_rng(4)
    vectors = rng.normal(size=(5000, 2)) * 10 ** rng.uniform(-3, 3, (5000, 2))
    for x, y in [*vectors.tolist(), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -2.0), (3.0, 3.0)]:
        assert angle(x, y) == pytest.approx(math.atan2(y, x), rel=1e-15)
        assert near_angle(x, y) == pytest.approx(math.atan2(y, x), abs=2e-5)


@pytest.mark.parametrize(
    "function", [exponential, exponential_less_one, lambda x: sine_and_cosine(x)[0]]
)
def test_loops_are_made_of_vector_instructions_and_nothing_is_contracted(
    function: Callable[[float], float],
) -> None:
    """A fused multiply-add is rounded once where machines without it round twice."""
    one = numba.njit(function) if not hasattr(function, "py_func") else function

    @numba.njit(error_model="numpy")  # type: ignore[untyped-decorator]
    def loop(values: np.ndarray) -> None:
        for k in range(64):
            values[64 + k] = one(values[k])

    values = np.linspace(-3.0, 3.0, 128)
    loop(values)
    assert values[64] == function(-3.0)
    assembly = next(iter(loop.inspect_asm().values()))
    assert not re.search(r"\bv?fn?m(add|sub|la|ls)", assembly)
    if "xmm" in assembly:
        assert re.search(r"\bv?mulpd\b", assembly)
        assert not re.search(r"\bv?mulsd\b", assembly)
