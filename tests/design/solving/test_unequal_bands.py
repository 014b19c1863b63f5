"""A tolerance over a band behind limits and two lags: kept, and in about the time behind one."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.numsi import NUM_SI, UnityBandOptions
from tests.design.solving.test_ramped_bands import largest_left
from tests.design.solving.test_ramps import end_s

Case = tuple[Mode, RateLimited, UnityBandOptions]

LONGER = 1.25
"""Time over that behind an ideal drive that two lags take at most: the braking one comes late."""


def random_two_lags(seed: int, count: int) -> list[Case]:
    """Return cases of ramps from .05 to 2 periods, of both models in turn."""
    rng = np.random.default_rng(seed)
    cases = []
    for number in range(count):
        model: Model = "switched" if number % 2 else "superposed"
        mode = Mode(
            natural_frequency_rad_s=float(rng.uniform(0.5, 20)),
            damping_ratio=float(rng.choice([0, 0.001, 0.01, 0.05, 0.1])),
        )
        half_width, tolerance = np.exp(rng.uniform(np.log([0.01, 0.01]), np.log([0.3, 0.2])))
        up, down = mode.period_s * np.exp(rng.uniform(math.log(0.05), math.log(2), 2))
        accel, decel = (
            SecondOrderSet(
                natural_frequency_rad_s=float(rng.uniform(3, 20)) * mode.natural_frequency_rad_s,
                damping_ratio=float(rng.uniform(0.5, 1.5)),
            )
            for _ in range(2)
        )
        limited = RateLimited(
            accel_limit_m_s2=1 / up,
            decel_limit_m_s2=1 / down,
            speed_m_s=1.0,
            then=SecondOrder(accel=accel, decel=decel, model=model),
        )
        options = UnityBandOptions(
            half_width=float(half_width), tolerance=float(tolerance), max_duration_periods=8.0
        )
        cases.append((mode, limited, options))
    return cases


def test_most_bands_behind_two_lags_are_kept_in_about_the_time_behind_one() -> None:
    refused = 0
    for mode, limited, options in random_two_lags(21, 12):
        try:
            found = design(mode, limited, NUM_SI, options)
        except InfeasibleDesignError:
            refused += 1
            continue
        assert found.certificate.verified
        assert not found.for_ideal
        left = largest_left(found, mode, limited, options.half_width)
        assert left <= options.tolerance * (1 + 1e-9)
        alone = replace(limited, then=Ideal())
        least = design(mode, alone, NUM_SI, options)
        assert end_s(found, limited) < LONGER * end_s(least, alone)
    assert refused <= 2


@pytest.mark.parametrize("model", ["superposed", "switched"])
def test_two_lags_that_are_nearly_one_take_its_time(model: Model) -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.01)
    one = SecondOrderSet(natural_frequency_rad_s=30.0, damping_ratio=0.7)
    other = SecondOrderSet(natural_frequency_rad_s=30.0 * (1 + 1e-7), damping_ratio=0.7)
    limited = RateLimited(
        accel_limit_m_s2=1.6,
        decel_limit_m_s2=2.5,
        speed_m_s=0.4,
        then=SecondOrder(accel=one, decel=other, model=model),
    )
    found = design(mode, limited, NUM_SI, UnityBandOptions(half_width=0.1, tolerance=0.05))
    assert end_s(found, limited) == pytest.approx(1.4190986, rel=1e-5)
