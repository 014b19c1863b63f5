"""The sheet of a recommendation: what it shows is what the operation answers."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from design.analysis.residual import residual_vibration
from design.pictures.recommendation_sheet import BEST
from design.pictures.style import STROKES
from schemas.recommendations import CandidateOut, RecommendationRequest, RecommendationResponse
from service.operations.recommendation import OPERATION
from tests.conftest import CRANE
from tests.design.pictures.drawn import collisions, line, lines, panel, points, words

DRIVEN = {"plant": CRANE["plant"], "actuator": CRANE["actuator"]}
IDEAL = {"kind": "ideal"}
REQUESTS: dict[str, dict[str, Any]] = {
    "crane": {**DRIVEN, "half_width": 0.18},
    "unity": {**DRIVEN, "half_width": 0.1, "sign": "unity", "max_duration_s": 2.0},
    "known": {"plant": CRANE["plant"], "actuator": IDEAL, "half_width": 0.0},
    "damping": {
        "plant": {**CRANE["plant"], "damping_ratio": 0.02},
        "actuator": CRANE["actuator"],
        "lower_ratio": 0.9,
        "upper_ratio": 1.2,
        "damping": {"from": 0.0, "to": 0.05},
    },
    "drive off": {
        "plant": {**CRANE["plant"], "damping_ratio": 0.02},
        "actuator": {
            "kind": "first_order",
            "accel_time_constant_s": 0.03,
            "decel_time_constant_s": 0.012,
        },
        "half_width": 0.05,
        "damping": {"from": 0.0, "to": 0.03},
        "drive_off_by": 0.2,
    },
    "modes": {
        "plant": {
            "kind": "modes",
            "modes": [
                {"natural_frequency_rad_s": 3.5, "damping_ratio": 0.0},
                {"natural_frequency_rad_s": 9.4, "damping_ratio": 0.02},
            ],
        },
        "actuator": IDEAL,
        "half_width": 0.05,
    },
    "limits": {
        "plant": {"kind": "pendulum", "cable_length_m": 9.0},
        "actuator": {
            "kind": "rate_limited",
            "accel_limit_m_s2": 0.3,
            "decel_limit_m_s2": 0.4,
            "speed_m_s": 1.0,
        },
        "half_width": 0.1,
        "max_duration_s": 12.0,
    },
}


@cache
def drawn(name: str) -> tuple[RecommendationResponse, Figure]:
    request = RecommendationRequest.model_validate(REQUESTS[name])
    answer = OPERATION.run(request)
    assert isinstance(answer, RecommendationResponse)
    return answer, OPERATION.draw(request)


def meeting(answer: RecommendationResponse) -> list[CandidateOut]:
    every = [answer.recommended, *answer.runners_up]
    return [one for one in every if one.same_as is None]


@pytest.mark.parametrize("name", REQUESTS)
def test_the_best_four_are_drawn_and_keep_the_tolerance_within_the_band(name: str) -> None:
    answer, figure = drawn(name)
    axes = panel(figure, "curves")
    best = meeting(answer)[:BEST]
    assert [one.get_gid() for one in lines(axes, "curve-")] == [f"curve-{one.name}" for one in best]
    tolerance = RecommendationRequest.model_validate(REQUESTS[name]).tolerance
    _, level = line(figure, "curves", "tolerance")
    assert level.tolist() == [100 * tolerance] * 2
    for one in best:
        ratios, residuals = line(figure, "curves", f"curve-{one.name}")
        within = (ratios >= answer.band.lower_ratio) & (ratios <= answer.band.upper_ratio)
        assert within.any()
        assert one.worst_residual is not None
        assert residuals[within].max() <= 100 * one.worst_residual * (1 + 1e-6) + 1e-9
        assert f"{one.name}, {one.ramp_end_s or one.duration_s:.4g} s" in words(figure)


@pytest.mark.parametrize("name", ["crane", "modes", "limits"])
def test_a_curve_is_the_residual_at_each_frequency(name: str) -> None:
    answer, figure = drawn(name)
    request = RecommendationRequest.model_validate(REQUESTS[name])
    modes, actuator = request.plant.to_design().modes, request.actuator.to_design()
    ratios, residuals = line(figure, "curves", f"curve-{answer.recommended.name}")
    impulses = answer.recommended.impulses.to_design()
    for ratio, residual in zip(ratios[::40], residuals[::40], strict=True):
        each = [
            residual_vibration(
                impulses,
                type(mode)(
                    natural_frequency_rad_s=float(ratio) * mode.natural_frequency_rad_s,
                    damping_ratio=mode.damping_ratio,
                ),
                actuator,
            )
            for mode in modes
        ]
        assert residual == pytest.approx(100 * max(each), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("name", REQUESTS)
def test_the_band_is_shaded(name: str) -> None:
    answer, figure = drawn(name)
    patches = panel(figure, "curves").patches
    (band,) = [one for one in patches if isinstance(one, Rectangle) and one.get_gid() == "band"]
    ends = (band.get_x(), band.get_x() + band.get_width())
    assert ends == pytest.approx((answer.band.lower_ratio, answer.band.upper_ratio))


@pytest.mark.parametrize("name", REQUESTS)
def test_a_bar_is_as_long_as_its_shaper_and_empty_where_that_misses(name: str) -> None:
    answer, figure = drawn(name)
    axes = panel(figure, "durations")
    bars = {str(one.get_gid()): one for one in axes.patches if isinstance(one, Rectangle)}
    every = [one for one in (*meeting(answer), *answer.others) if one.same_as is None]
    assert set(bars) == {f"bar-{one.name}" for one in every}
    for one in every:
        bar = bars[f"bar-{one.name}"]
        assert bar.get_width() == pytest.approx(one.ramp_end_s or one.duration_s, rel=1e-12)
        assert (to_hex(bar.get_facecolor()) == "#ffffff") != one.meets_all
        bounds = [bound for bound in axes.lines if bound.get_gid() == f"bound-{one.name}"]
        assert [points(bound)[0][0] for bound in bounds] == (
            [] if one.lower_bound_s is None else [one.lower_bound_s]
        )
    for one, (colour, _) in zip(meeting(answer), STROKES[:BEST], strict=False):
        assert to_hex(bars[f"bar-{one.name}"].get_facecolor()) == colour
    asked = REQUESTS[name].get("max_duration_s")
    assert [points(one)[0][0] for one in lines(axes, "longest")] == ([asked] if asked else [])
    heights = [bar.get_y() for bar in bars.values()]
    assert len(set(heights)) == len(heights)
    assert np.all(np.diff([bar.get_width() for bar in axes.patches]) >= 0)  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", REQUESTS)
def test_every_shaper_of_the_answer_is_named_beside_a_bar(name: str) -> None:
    answer, figure = drawn(name)
    ticks = panel(figure, "durations").get_yticklabels()
    named = [one for tick in ticks for one in tick.get_text().split(", ")]
    every = [answer.recommended, *answer.runners_up, *answer.others]
    assert sorted(named) == sorted(one.name for one in every)


@pytest.mark.parametrize("name", REQUESTS)
def test_no_text_meets_another_or_leaves_the_page(name: str) -> None:
    _, figure = drawn(name)
    assert collisions(figure) == []


def test_the_residual_over_all_that_is_asked_is_that_with_the_drive_off_too() -> None:
    answer, figure = drawn("drive off")
    best = answer.recommended
    (off,) = (one.value for one in best.requirements if one.requirement == "drive_off_by")
    assert off is not None
    assert best.worst_residual is not None
    assert off > 1.05 * best.worst_residual
    assert f"{100 * off:.3g} %" in words(figure)
    assert "drive off by 20 %" in words(figure)
