"""How candidates are judged: over a band, over damping, by the formula."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.scheduled import Scheduled
from tests.design.recommendations.recommended import asked, everything
from tests.second_route import claims_by_formula, largest_in_band_by_formula
from tests.shaper_table import CRANE, IDEAL, LIMITED, THESIS


@pytest.mark.parametrize(
    ("plant", "actuator", "wanted"),
    [
        (CRANE, THESIS, {"half_width": 0.12}),
        (CRANE, LIMITED, {"half_width": 0.1, "tolerance": 0.1}),
        (replace(CRANE, damping_ratio=0.1), IDEAL, {"lower_ratio": 0.8, "upper_ratio": 1.05}),
        (CRANE, THESIS, {"half_width": 0.1, "sample_time_s": 0.01}),
    ],
    ids=["thesis", "limited", "damped", "sampled"],
)
def test_the_largest_residual_is_that_of_the_formula(
    plant: Pendulum, actuator: Actuator, wanted: dict[str, Any]
) -> None:
    found = asked(plant, actuator, **wanted)
    for one in everything(found).values():
        by_formula = largest_in_band_by_formula(
            one.impulses, plant.mode, actuator, found.question.band, 801
        )
        if actuator is LIMITED and one.lowest_command < 0:
            continue  # a reversal makes two ramps, which that formula does not know
        # The grid misses a peak by its curvature, |V| (w t_n step / 2)^2 / 2 and less.
        assert by_formula <= one.designed.worst_residual * (1 + 1e-9) + 1e-12, one.name
        assert by_formula >= one.designed.worst_residual * (1 - 1e-4) - 1e-9, one.name


def test_a_range_of_damping_is_judged_as_a_whole() -> None:
    plant = Mode(natural_frequency_rad_s=2 * math.pi * 45, damping_ratio=0.06)
    found = asked(plant, half_width=0.1, damping=(0.05, 0.1))
    (middle,) = found.question.designed_for
    assert middle.damping_ratio == pytest.approx(0.075)
    for one in found.candidates:
        worst = max(
            claims_by_formula(one.impulses, replace(plant, damping_ratio=z), IDEAL, ratio)[
                "residual"
            ]
            for z in np.linspace(0.05, 0.1, 6).tolist()
            for ratio in np.linspace(0.9, 1.1, 41).tolist()
        )
        assert worst <= one.designed.worst_residual * (1 + 1e-9)
        assert one.designed.worst_residual <= 0.05 * (1 + 1e-9)
    # Designed for the middle alone these leave more at the ends: they are made anew for less.
    tightened = everything(found)["si"].designed
    assert tightened.choice.asked["tolerance"] < 0.05
    assert tightened.lower_bound_s is not None
    assert tightened.lower_bound_s < everything(found)["si"].duration_s


def test_a_wide_range_of_damping_costs_specified_insensitivity_less_than_others() -> None:
    # For the middle alone it leaves 8.3 %; made for 2.4 % it keeps 5 % and is the fastest still.
    plant = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.1)
    found = asked(plant, half_width=0.1, damping=(0.05, 0.2), sign="positive")
    assert found.recommended.name == "si"
    assert 0.99 * 0.05 <= found.recommended.designed.worst_residual <= 0.05
    assert found.recommended.duration_s < 0.95 * everything(found)["zvd"].duration_s


def test_a_tolerance_larger_than_any_of_a_kind_is_kept_by_its_largest() -> None:
    told = everything(asked(tolerance=0.7, half_width=0.5))
    assert told["ei"].designed.choice.asked == {"tolerance": 0.5}
    assert not told["ei"].missed


def test_the_range_of_a_scheduled_plant_is_the_band() -> None:
    hook = Scheduled(first=Pendulum(cable_length_m=0.7), last=Pendulum(cable_length_m=1.0))
    found = asked(hook, THESIS)
    assert found.question.band == hook.band
    middle = asked(hook.middle, THESIS, lower_ratio=hook.band[0], upper_ratio=hook.band[1])
    assert found.recommended.duration_s == pytest.approx(middle.recommended.duration_s, rel=1e-9)
