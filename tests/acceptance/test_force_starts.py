"""A free body is moved in the least time that any of 400 starts of least squares finds."""

import numpy as np
import pytest

from design.model.plants.mode import Mode
from design.solvers.force_pulses import ForceTask, least_time
from tests.force_route import fastest_of_many


@pytest.mark.parametrize("seed", range(50))
def test_no_start_of_400_finds_a_faster_force(seed: int) -> None:
    """And the best of them is as fast, where there are no more switches than they try."""
    rng = np.random.default_rng(1000 + seed)
    mode = Mode(
        natural_frequency_rad_s=float(rng.uniform(1.0, 5.0)),
        damping_ratio=float(rng.choice([0.0, 0.02, 0.1])),
    )
    derivatives = seed % 2
    # Up to three periods, where few switches do.
    way_s2 = float((rng.uniform(0.05, 1.5) * mode.period_s) ** 2)
    steps = least_time(ForceTask(modes=(mode,), way_s2=way_s2, derivatives=derivatives))
    assert steps is not None
    found_s = fastest_of_many(mode, way_s2, derivatives, 400, rng)
    least_s = float(steps.times_s[-1])
    assert found_s >= least_s * (1 - 1e-9)
    if steps.times_s.size <= 5 + 2 * derivatives:
        assert found_s == pytest.approx(least_s, rel=1e-7)
