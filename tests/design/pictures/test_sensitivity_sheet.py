"""The sheet of a sensitivity: what it shows is what the operation answers."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from schemas.sensitivity import SensitivityRequest, SensitivityResponse
from service.operations.sensitivity import OPERATION
from tests.conftest import CRANE
from tests.design.pictures.drawn import collisions, line, panel, words

HALVES = {"times_s": [0, 0.9], "amplitudes": [0.5, 0.5]}
MANY = {"times_s": [0.13 * place for place in range(20)], "amplitudes": [0.05] * 20}
MODES = [
    {"natural_frequency_rad_s": 3.5 * 1.4**turn, "damping_ratio": 0.01 * turn} for turn in range(6)
]
LIMITS = {"accel_limit_m_s2": 0.3, "decel_limit_m_s2": 0.4, "speed_m_s": 1.0}
PLANTS = {
    "crane": CRANE["plant"],
    "three": {"kind": "modes", "modes": MODES[:3]},
    "six": {"kind": "modes", "modes": MODES},
    "long cable": {"kind": "pendulum", "cable_length_m": 9.0},
}

REQUESTS = {
    "crane": {"plant": PLANTS["crane"], "actuator": CRANE["actuator"], "impulses": HALVES},
    "unshaped": {
        "plant": PLANTS["crane"],
        "actuator": {"kind": "ideal"},
        "impulses": {"times_s": [0], "amplitudes": [1]},
    },
    "damping": {
        "plant": PLANTS["crane"],
        "actuator": {"kind": "ideal"},
        "impulses": HALVES,
        "damping": {"from": 0.0, "to": 0.3},
    },
    "three modes, damping": {
        "plant": PLANTS["three"],
        "actuator": CRANE["actuator"],
        "impulses": HALVES,
        "damping": {"from": 0.01, "to": 0.3},
    },
    "six modes": {"plant": PLANTS["six"], "actuator": CRANE["actuator"], "impulses": MANY},
    "limits": {
        "plant": PLANTS["long cable"],
        "actuator": {"kind": "rate_limited", **LIMITS},
        "impulses": MANY,
    },
    "far": {
        "plant": PLANTS["crane"],
        "actuator": {"kind": "ideal"},
        "impulses": MANY,
        "from_ratio": 0.01,
        "to_ratio": 20.0,
        "tolerance": 0.5,
    },
}


def drawn(name: str) -> tuple[SensitivityResponse, Figure]:
    request = SensitivityRequest.model_validate(REQUESTS[name])
    answer = OPERATION.run(request)
    assert isinstance(answer, SensitivityResponse)
    return answer, OPERATION.draw(request)


@pytest.mark.parametrize("name", REQUESTS)
def test_each_curve_is_that_of_the_answer(name: str) -> None:
    answer, figure = drawn(name)
    each = (
        {"": answer.sensitivity}
        if answer.modes is None
        else {f"-{number}": mode.sensitivity for number, mode in enumerate(answer.modes)}
    )
    for ending, curve in each.items():
        assert curve is not None
        ratios, residuals = line(figure, "sensitivity", f"residual{ending}")
        assert ratios.tolist() == curve.frequency_ratio
        np.testing.assert_allclose(residuals, 100 * np.array(curve.residual), rtol=1e-15)
        if curve.damping is not None:
            ratios, residuals = line(figure, "damping", f"damping{ending}")
            assert ratios.tolist() == curve.damping.damping_ratio
            np.testing.assert_allclose(residuals, 100 * np.array(curve.damping.residual))


@pytest.mark.parametrize("name", REQUESTS)
def test_every_curve_and_the_tolerance_are_within_the_panels(name: str) -> None:
    _, figure = drawn(name)
    for axes in figure.axes:
        low, high = axes.get_ylim()
        heights = np.concatenate([np.ravel(one.get_ydata()) for one in axes.lines])
        inside = heights[np.isfinite(heights)]
        assert low <= inside.min() <= inside.max() <= high


@pytest.mark.parametrize("name", REQUESTS)
def test_the_band_is_that_of_the_answer(name: str) -> None:
    answer, figure = drawn(name)
    patches = panel(figure, "sensitivity").patches
    shaded = [one for one in patches if isinstance(one, Rectangle) and one.get_gid() == "band"]
    band = answer.sensitivity.insensitivity
    assert bool(shaded) == (band is not None)
    if band is not None:
        ends = shaded[0].get_x(), shaded[0].get_x() + shaded[0].get_width()
        assert ends == pytest.approx((band.searched_from_ratio, band.searched_to_ratio))
    else:
        assert "no insensitivity" in words(figure)


@pytest.mark.parametrize("name", ["crane", "six modes"])
def test_the_second_axis_is_in_hertz(name: str) -> None:
    _, figure = drawn(name)
    axes = panel(figure, "sensitivity")
    (hertz,) = axes.child_axes
    figure.draw_without_rendering()
    request = SensitivityRequest.model_validate(REQUESTS[name])
    slowest = min(mode.natural_frequency_rad_s for mode in request.plant.to_design().modes)
    expected = np.array(axes.get_xlim()) * slowest / (2 * np.pi)
    assert hertz.get_xlim() == pytest.approx(expected)
    assert hertz.get_xlabel().endswith("[Hz]")


@pytest.mark.parametrize("name", REQUESTS)
def test_no_text_meets_another_or_leaves_the_page(name: str) -> None:
    _, figure = drawn(name)
    assert collisions(figure) == []
