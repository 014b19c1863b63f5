"""Behind limits no kind of the catalogue that meets what is asked is faster than the recommended.

`python -m tests.acceptance.test_recommended_behind_limits 50` tries more cranes than the suite.
"""

import dataclasses
import sys
import time

import numpy as np
import pytest

from design.errors import DesignError
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.pipeline import design
from design.recommendations.recommendation import Recommendation, recommend
from design.recommendations.requirements import Requirements, Sign
from design.shapers.numsi import UnityBandOptions
from design.shapers.registry import SHAPERS
from tests.expm_route import end_s, outcome

CRANES = 6
"""Of the suite; about a second each."""

Crane = tuple[Pendulum, RateLimited, float]
"""With the half width of the band that is asked, 0 for the nominal frequency alone."""

TOLERANCE = 0.05


def random_cranes(seed: int, count: int) -> list[Crane]:
    """Return cranes of 1 to 15 m with limits, and bands that are asked."""
    rng = np.random.default_rng(seed)
    cranes = []
    for _ in range(count):
        accel, decel = rng.uniform(0.1, 1.0, 2).tolist()
        drive = RateLimited(
            accel_limit_m_s2=accel, decel_limit_m_s2=decel, speed_m_s=float(rng.uniform(0.3, 1.5))
        )
        half_width = float(rng.choice([0.0, 0.05, 0.1, 0.2]))
        cranes.append((Pendulum(cable_length_m=float(rng.uniform(1, 15))), drive, half_width))
    return cranes


def worst_left(command: Impulses, mode: Mode, drive: RateLimited, half_width: float) -> float:
    """Return the largest residual over the band, by another route."""
    ratios = np.linspace(1 - half_width, 1 + half_width, 1 if half_width == 0 else 15)
    modes = [
        Mode(natural_frequency_rad_s=ratio * mode.natural_frequency_rad_s)
        for ratio in (ratios if half_width else [1.0])
    ]
    return max(outcome(command, one, drive).residual for one in modes)


def recommended(crane: Crane) -> Recommendation:
    """Return what is recommended for a crane."""
    plant, drive, half_width = crane
    return recommend(plant, drive, Requirements(half_width=half_width, tolerance=TOLERANCE))


def faster_ones(crane: Crane) -> list[str]:
    """Return the kinds that meet what is asked and end before the recommended one."""
    plant, drive, half_width = crane
    best = recommended(crane).recommended
    assert worst_left(best.impulses, plant.mode, drive, half_width) <= TOLERANCE * (1 + 1e-6)
    end = end_s(best.impulses, drive)
    assert best.end_s == pytest.approx(end, rel=1e-12)
    faster = []
    for name, kind in SHAPERS.items():
        told = {"tolerance": TOLERANCE, "half_width": max(half_width, 1e-3)}
        fields = {option.name for option in dataclasses.fields(kind.options)}
        options = {key: value for key, value in told.items() if key in fields}
        try:
            other = design(plant, drive, kind, kind.options(**options)).impulses
        except DesignError:
            continue
        meets = worst_left(other, plant.mode, drive, half_width) <= TOLERANCE
        if meets and end_s(other, drive) < end * (1 - 1e-6):
            faster.append(name)
    return faster


@pytest.mark.parametrize("crane", random_cranes(5, CRANES))
def test_no_kind_that_meets_what_is_asked_is_faster_than_the_recommended(crane: Crane) -> None:
    assert faster_ones(crane) == []


@pytest.mark.parametrize("sign", ["any", "unity", "positive"])
def test_the_bound_behind_limits_is_said_of_every_command(sign: Sign) -> None:
    mode = Mode(natural_frequency_rad_s=12.9, damping_ratio=0.1)
    drive = RateLimited(accel_limit_m_s2=9.0, decel_limit_m_s2=5.5, speed_m_s=0.8)
    asked = Requirements(half_width=0.33, tolerance=TOLERANCE, sign=sign)
    found = recommend(mode, drive, asked)
    options = UnityBandOptions(half_width=0.33, tolerance=TOLERANCE)
    bound = design(mode, drive, SHAPERS["num_si"], options).solver.lower_bound_s
    assert bound is not None
    says = f"no command between 0 and 1 that keeps 5 % over the band takes less than {bound:.4g} s"
    assert found.why[-1] == f"{says} (proven)"
    for one in (*found.candidates, *found.others):
        if worst_left(one.impulses, mode, drive, 0.33) <= TOLERANCE:
            assert one.end_s >= bound * (1 - 1e-9)


if __name__ == "__main__":
    times = []
    for number, one in enumerate(random_cranes(5, int(sys.argv[1]))):
        begun = time.perf_counter()
        recommended(one)
        times.append(time.perf_counter() - begun)
        print(number, f"{times[-1]:.2f} s", faster_ones(one) or "none is faster", flush=True)
    print(f"recommended in {np.median(times):.2f} s (median), {max(times):.2f} s at most")
