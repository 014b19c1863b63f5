"""Requirements that make no sense are refused."""

import math
from typing import Any

import pytest

from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.scheduled import Scheduled
from tests.design.recommendations.recommended import TWO_MODES, asked
from tests.refusals import refused


@pytest.mark.parametrize(
    ("wanted", "code", "field", "says"),
    [
        ({"half_width": 1.0}, "out_of_range", "half_width", "zero frequency, got 1.0"),
        ({"half_width": -0.1}, "out_of_range", "half_width", "between 0"),
        ({"half_width": math.nan}, "out_of_range", "half_width", "between 0"),
        (
            {"lower_ratio": -0.2, "upper_ratio": 1.2},
            "out_of_range",
            "lower_ratio",
            "not reach zero",
        ),
        ({"lower_ratio": 0.0, "upper_ratio": 1.2}, "out_of_range", "lower_ratio", None),
        (
            {"lower_ratio": 1.1, "upper_ratio": 1.2},
            "out_of_range",
            "lower_ratio",
            "between 0.05 and 1",
        ),
        (
            {"lower_ratio": 0.8, "upper_ratio": 0.9},
            "out_of_range",
            "upper_ratio",
            "between 1 and 10",
        ),
        ({"lower_ratio": 0.8}, "band_half_said", "upper_ratio", None),
        ({"half_width": 0.1, "lower_ratio": 0.9}, "band_said_twice", "lower_ratio", None),
        ({"tolerance": 1.0}, "out_of_range", "tolerance", "below 1, .*, got 1.0"),
        ({"tolerance": 0.0}, "out_of_range", "tolerance", "at least"),
        ({"damping": (0.1, 0.05)}, "range_below_start", "damping.to", None),
        ({"damping": (-0.1, 0.05)}, "out_of_range", "damping.from", "between 0 and 0.99"),
        ({"damping": (0.1, 0.2)}, "damping_outside_its_range", "plant.damping_ratio", None),
        ({"max_duration_s": 0.0}, "not_positive", "max_duration_s", None),
        ({"max_duration_s": math.inf}, "not_positive", "max_duration_s", None),
        ({"sample_time_s": -1.0}, "not_positive", "sample_time_s", None),
        ({"lowest_command": 0.5}, "out_of_range", "lowest_command", "between -10 and 0"),
        ({"highest_command": 0.5}, "out_of_range", "highest_command", "between 1 and 11"),
        ({"max_high_mode_gain": 0.0}, "out_of_range", "max_high_mode_gain", "> 0"),
    ],
)
def test_nonsense_is_refused_by_name(
    wanted: dict[str, Any], code: str, field: str, says: str | None
) -> None:
    with refused(code, field, says=says):
        asked(**wanted)


def test_equal_modes_and_what_several_modes_do_not_take_are_refused() -> None:
    one = Mode(natural_frequency_rad_s=3.5)
    with refused("modes_too_near", "modes.1"):
        asked(Modes(modes=(one, one)))
    with refused("requirement_of_one_mode", "damping"):
        asked(TWO_MODES, damping=(0.0, 0.1))
    hook = Scheduled(first=Pendulum(cable_length_m=0.7), last=Pendulum(cable_length_m=1.0))
    with refused("requirement_said_by_plant", "half_width"):
        asked(hook, half_width=0.1)
