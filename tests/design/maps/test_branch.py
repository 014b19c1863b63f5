"""The branch that a map follows is the fastest of all."""

import math
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np

from design.fields import Axis
from design.maps.field_map import field_map
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from tests.map_cases import FREQUENCY, case
from tests.shaper_table import THESIS


@cache
def settling_s(one: SecondOrderSet) -> float:
    """From when on a step response stays within 20 % of its end, by simulation."""
    from scipy.signal import step

    w, z = one.natural_frequency_rad_s, one.damping_ratio
    times, velocity = step(([w * w], [1, 2 * z * w, w * w]), T=np.linspace(0, 20 / w, 4001))
    return float(times[np.flatnonzero(np.abs(velocity - 1) > 0.2)[-1] + 1])


def fastest_branch(actuator: SecondOrder) -> tuple[float, tuple[int, int, int]]:
    """Search every branch for the fastest whose steps settle to 80 %, by the step responses."""
    settling = [settling_s(one) for one in (actuator.accel, actuator.decel)]
    s = 1j * FREQUENCY
    accel, decel = (
        one.natural_frequency_rad_s**2
        / (
            s * s
            + 2 * one.damping_ratio * one.natural_frequency_rad_s * s
            + one.natural_frequency_rad_s**2
        )
        for one in (actuator.accel, actuator.decel)
    )
    ratio = decel / accel
    found = []
    for sign, n, m in product((1, -1), range(-1, 5), range(-1, 6)):
        half = sign * math.acos(abs(ratio) / 2)
        t2 = (half + float(np.angle(ratio)) + 2 * math.pi * n) / FREQUENCY
        t3 = (2 * half + 2 * math.pi * m) / FREQUENCY
        if t2 >= settling[0] and t3 - t2 >= settling[1]:
            found.append((t3, (n, m, sign)))
    return min(found)


def test_the_branch_is_the_fastest_of_all_that_settle() -> None:
    # Kim 2011, fig. 3-15.
    corners = np.linspace(1.5, 20.0, 8)
    x = Axis(path=("actuator", "accel", "natural_frequency_rad_s"), values=corners)
    y = Axis(path=("actuator", "decel", "natural_frequency_rad_s"), values=corners)
    of = case("numzv", quantity="branch", settle=True, max_duration_periods=5.0)
    found = field_map(of, x, y).values
    seen = set()
    for (row, decel), (column, accel) in product(
        enumerate(corners.tolist()), enumerate(corners.tolist())
    ):
        branch = found[row, column]
        if np.isnan(branch).any():
            continue
        drive = replace(
            THESIS,
            accel=replace(THESIS.accel, natural_frequency_rad_s=accel),
            decel=replace(THESIS.decel, natural_frequency_rad_s=decel),
        )
        _, expected = fastest_branch(drive)
        assert tuple(branch) == expected
        seen.add(expected)
    assert (0, 0, 1) in seen
    assert len(seen) > 2
