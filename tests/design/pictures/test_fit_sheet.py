"""The sheet of a fit: what it shows is what the operation answers."""

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.polynomial import polynomial

from design.pictures.fit_sheet import FLOOR, spread
from design.types import FloatArray
from schemas.fits import FitOut, FitRequest
from service.operations.fit import OPERATION
from tests.conftest import CRANE
from tests.design.pictures.drawn import collisions, line, lines, panel, points, words

LENGTHS = {"over": "/plant/cable_length_m", "from": 0.3, "to": 1.4}
MODE = {"kind": "mode", "natural_frequency_rad_s": 3.0}
LIMITS = {
    "kind": "rate_limited",
    "accel_limit_m_s2": 0.3,
    "decel_limit_m_s2": 0.4,
    "speed_m_s": 1.0,
}

REQUESTS: dict[str, dict[str, Any]] = {
    "length": {**CRANE, "fit": {**LENGTHS, "degree": 3}},
    "bound": {**CRANE, "fit": {**LENGTHS, "max_residual": 1e-6}},
    "frequency": {
        "plant": MODE,
        "actuator": CRANE["actuator"],
        "shaper": {"kind": "numzv"},
        "fit": {
            "over": "/plant/natural_frequency_rad_s",
            "from": 1.0,
            "to": 4.0,
            "degree": 2,
            "form": "time_in_frequency",
        },
    },
    "damping": {
        "plant": MODE,
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "umzvd"},
        "fit": {"over": "/plant/damping_ratio", "from": 0.0, "to": 0.3, "degree": 4},
    },
    "limits": {
        "plant": {"kind": "pendulum", "cable_length_m": 9.0},
        "actuator": LIMITS,
        "shaper": {"kind": "numzv"},
        "fit": {"over": "/plant/cable_length_m", "from": 7.0, "to": 10.0, "degree": 3},
    },
}


def drawn(name: str) -> tuple[FitOut, Figure]:
    request = FitRequest.model_validate(REQUESTS[name])
    answer = OPERATION.run(request)
    assert isinstance(answer, FitOut)
    return answer, OPERATION.draw(request)


def frequencies(name: str, values: FloatArray) -> FloatArray:
    """Natural frequencies at values of the field [rad/s]."""
    plant, over = REQUESTS[name]["plant"], REQUESTS[name]["fit"]["over"]
    if over.endswith("cable_length_m"):
        return np.asarray(np.sqrt(plant.get("gravity_m_s2", 9.80665) / values))
    if over.endswith("natural_frequency_rad_s"):
        return values
    return np.full(values.size, float(plant["natural_frequency_rad_s"]))


def times_of_answer(name: str, answer: FitOut, values: FloatArray) -> FloatArray:
    """Return times by the coefficients of the answer alone, shape (m, n) [s]."""
    natural = frequencies(name, values)
    if answer.value == "time_s":
        return np.asarray(polynomial.polyval(natural, np.array(answer.coefficients).T).T)
    x = values
    if "/" in answer.variable.is_ or "*" in answer.variable.is_:
        x = natural * answer.variable.to / natural.max()
    phases = polynomial.polyval(x, np.array(answer.coefficients).T).T
    return np.asarray(phases / natural[:, None])


@pytest.mark.parametrize("name", REQUESTS)
def test_each_curve_is_the_polynomial_of_the_answer(name: str) -> None:
    answer, figure = drawn(name)
    curves = lines(panel(figure, "times"), "time-")
    assert len(curves) == len(answer.coefficients)
    for number, curve in enumerate(curves):
        values, times = points(curve)
        assert values.size == answer.checked_points
        expected = times_of_answer(name, answer, values)[:, number]
        np.testing.assert_allclose(times, expected, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("name", REQUESTS)
def test_the_exact_curves_are_as_far_away_as_the_answer_says(name: str) -> None:
    answer, figure = drawn(name)
    axes = panel(figure, "times")
    pairs = zip(lines(axes, "time-"), lines(axes, "exact-"), strict=True)
    errors = [np.abs(points(fitted)[1] - points(exact)[1]).max() for fitted, exact in pairs]
    assert max(errors) == answer.worst_timing_error_s


@pytest.mark.parametrize("name", REQUESTS)
def test_the_residual_reaches_the_largest_of_the_answer_and_the_bound_is_drawn(name: str) -> None:
    answer, figure = drawn(name)
    _, residuals = line(figure, "residual", "residual")
    assert residuals.max() == 100 * max(answer.worst_residual, FLOOR)
    low, high = panel(figure, "residual").get_ylim()
    assert low < residuals.max() < high
    bound = REQUESTS[name]["fit"].get("max_residual")
    drawn_bounds = lines(panel(figure, "residual"), "bound")
    assert len(drawn_bounds) == (bound is not None)
    if bound is not None:
        assert points(drawn_bounds[0])[1].tolist() == [100 * bound] * 2
        assert residuals.max() <= 100 * bound < high
        assert "bound asked, 0.0001 %" in words(figure)


@pytest.mark.parametrize("name", REQUESTS)
def test_the_range_is_what_is_not_shaded(name: str) -> None:
    _, figure = drawn(name)
    fit = REQUESTS[name]["fit"]
    for where in ("times", "residual"):
        axes = panel(figure, where)
        shaded = [one for one in axes.patches if isinstance(one, Rectangle)]
        ends = sorted(x for one in shaded for x in (one.get_x(), one.get_x() + one.get_width()))
        left, right = axes.get_xlim()
        assert ends == pytest.approx([left, fit["from"], fit["to"], right])


@pytest.mark.parametrize("name", REQUESTS)
def test_no_text_meets_another_or_leaves_the_page(name: str) -> None:
    _, figure = drawn(name)
    assert collisions(figure) == []


@pytest.mark.parametrize("seed", range(20))
def test_spread_places_keep_their_distance_order_and_mean(seed: int) -> None:
    random = np.random.default_rng(seed)
    values = random.uniform(0, 1, random.integers(1, 30))
    places = spread(values, 0.05)
    assert places.mean() == pytest.approx(values.mean())
    order = np.argsort(values)
    assert (np.diff(places[order]) > 0.05 * (1 - 1e-9)).all()
    np.testing.assert_array_equal(spread(values, 0.0), values)
