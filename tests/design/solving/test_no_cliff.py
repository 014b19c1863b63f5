"""The end of the last ramp over ramps of every length: rising, without a jump, as its dual says.

The references within longer ramps are among those within shorter ones: the end never falls. How
fast it rises follows from the bound of `design.analysis.shortest_ramps`, whose surplus is 0 at the
optimum and falls by 1 with the end: with q = P + N and ramps R up and F down,

    dT/dR = integral over rises of |q| / R^2,    dT/dF = integral over falls of |q| / F^2.

It is no Lipschitz constant of 1: behind steep turns of the curve |q| is large. A curve that rises
has no jump if its values have no gap, however short the steps must be.
"""

import math

import numpy as np
import pytest

from design.analysis.ramp_figures import end_of_reference
from design.formulations.ramped import ramped_problem
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.solvers.budget import Budget
from design.solvers.ramps.search import candidates
from design.types import FloatArray

SMALL = 0.05
"""Largest gap between two values of a curve [periods]."""

SHORTEST = 1e-6
"""Step at which a larger gap would be a jump [periods]."""

CURVES = [(damping, ratio) for damping in (0.0, 0.02, 0.2) for ratio in (1.0, 0.25)]


def drive_of(rise: float, ratio: float) -> RateLimited:
    return RateLimited(
        accel_limit_m_s2=1 / rise, decel_limit_m_s2=1 / (ratio * rise), speed_m_s=1.0
    )


def end(rise: float, ratio: float, damping: float) -> float:
    mode = Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=damping)
    drive = drive_of(rise, ratio)
    return end_of_reference(design(mode, drive, SHAPERS["numzvd"]).impulses, drive)


@pytest.mark.parametrize(("damping", "ratio"), CURVES)
def test_the_end_rises_with_the_ramps_and_skips_no_value(damping: float, ratio: float) -> None:
    rises = [0.01, *np.linspace(0.1, 3.0, 30).tolist()]
    points = [(rise, end(rise, ratio, damping)) for rise in rises]
    while len(points) > 1:
        (rise, here), (longer, there) = points[:2]
        assert there >= here - 1e-9
        if there - here <= SMALL + 1.5 * (longer - rise):
            points.pop(0)
            continue
        assert longer - rise > SHORTEST, f"a jump by {there - here:.3g} at {rise:.6g}"
        middle = (rise + longer) / 2
        points.insert(1, (middle, end(middle, ratio, damping)))


def rates(rise: float, ratio: float, damping: float) -> tuple[float, float]:
    """Return dT/dR and dT/dF by the multipliers of the optimum."""
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=damping)
    turn = 2 * math.pi * rise
    drive = drive_of(turn, ratio)
    problem = ramped_problem((mode,), drive, derivatives=1, max_duration_periods=5.0)
    wanted = 2 * math.pi * end(rise, ratio, damping)
    found = next(
        one for one in candidates(problem, Budget()) if abs(one.course.end - wanted) < 1e-8
    )
    course = found.course
    pole = mode.pole_rad_s

    def pull(times: FloatArray) -> FloatArray:
        kernels = np.exp(-pole * times) * np.stack((np.ones_like(times), -times))
        total: FloatArray = (found.multipliers.conj() @ kernels).real
        return total

    levels = -pull(course.arrivals)
    levels[-1] -= 1 / course.last_slopes[-1]
    sums = {1.0: 0.0, -1.0: 0.0}
    for start, finish, slope, group in zip(
        course.starts, course.ends, course.slopes, course.groups, strict=True
    ):
        times = start + (finish - start) * (np.arange(4000) + 0.5) / 4000
        mean = float(np.abs(pull(times) + levels[group]).mean())
        sums[float(np.sign(slope))] += (finish - start) * mean
    return sums[1.0] / turn**2, sums[-1.0] / (ratio * turn) ** 2


@pytest.mark.parametrize("damping", [0.0, 0.02, 0.2])
@pytest.mark.parametrize("rise", [0.05, 0.3, 0.57, 0.83, 1.4, 2.2])
@pytest.mark.parametrize("ratio", [1.0, 0.25])
def test_the_end_rises_as_fast_as_the_dual_says(rise: float, ratio: float, damping: float) -> None:
    step = 1e-4 * rise
    found = (end(rise + step, ratio, damping) - end(rise - step, ratio, damping)) / (2 * step)
    of_rise, of_fall = rates(rise, ratio, damping)
    assert of_rise >= 0
    assert of_fall >= 0
    assert found == pytest.approx(of_rise + ratio * of_fall, rel=2e-3)


@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_short_equal_ramps_delay_the_end_by_at_most_themselves(damping: float) -> None:
    # Convolved with a box of R, the steps without limits become full ramps of R within the limits.
    mode = Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=damping)
    steps = end(1e-9, 1.0, damping)
    for rise in (1e-3, 1e-2, 0.1, 0.3, 1.0):
        assert steps <= end(rise, 1.0, damping) <= steps + rise + 1e-8
    assert mode.period_s == pytest.approx(1.0)
