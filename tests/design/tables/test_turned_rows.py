"""Where ramps begin to turn between two rows, the bound that a table tells still holds."""

from typing import Any

import numpy as np
import pytest

from design.model.actuators.rate_limited import RateLimited
from design.tables.interpolation import interpolant
from design.tables.turned_rows import cells_across_kinks, cells_of_far_rows, turned_ramps
from tests.designed_tables import designed_table

W = 3.5
PERIOD_S = 2 * np.pi / W

KINKS: dict[str, tuple[str, float, float, float, str, float, int]] = {
    "frequency": ("numzv", 0.141, 0.299, 0.1, "plant.natural_frequency_rad_s", 2.93, 24),
    "limit": ("numzv", 0.912, 0.101, 0.1, "actuator.accel_limit_m_s2", 1.54, 21),
    "slope": ("numzvd", 0.0749, 0.106, 0.02, "actuator.accel_limit_m_s2", 1.77, 11),
}
"""Kind, ramps in periods, damping, field, its widest over its least, points."""


@pytest.mark.parametrize("which", KINKS)
def test_the_bound_holds_anywhere_across_a_kink(which: str) -> None:
    kind, up, down, damping, field, wide, count = KINKS[which]
    limits = {"accel_limit_m_s2": 1 / (up * PERIOD_S), "decel_limit_m_s2": 1 / (down * PERIOD_S)}
    request: dict[str, Any] = {
        "plant": {"kind": "mode", "natural_frequency_rad_s": W, "damping_ratio": damping},
        "actuator": {"kind": "rate_limited", **limits, "speed_m_s": 1.0},
        "shaper": {"kind": kind},
    }
    middle = {"natural_frequency_rad_s": W, **limits}[field.partition(".")[2]]
    side = np.sqrt(wide)
    axis = np.geomspace(middle / side, middle * side, count)
    head, rows = designed_table(request, {field: axis.tolist()})
    made = interpolant(head, rows)
    residuals = made.residuals(np.linspace(axis[0], axis[-1], 4001)[:, None])
    known = residuals[~np.isnan(residuals)]
    assert known.size > 3000
    assert known.max() <= made.residual_bound
    assert known.max() > made.residual_bound / 2


def test_a_step_that_comes_before_the_ramp_is_over_turns_it() -> None:
    drive = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=2.0, speed_m_s=1.0)
    times = np.array([[0.0, 1.5, 2.5], [0.0, 0.5, 2.5], [0.0, 1.5, 1.7], [np.nan] * 3])
    turned = turned_ramps(times, np.array([1.0, -1.0, 1.0]), [drive] * 4)
    np.testing.assert_array_equal(
        turned,
        [[False, False, False], [False, True, False], [False, False, True], [False] * 3],
    )


def test_cells_reach_across_where_the_four_rows_around_differ() -> None:
    turned = np.zeros((9, 1), dtype=bool)
    turned[5:] = True  # between rows 4 and 5: cells 3, 4, 5 have both in their stencils
    np.testing.assert_array_equal(np.flatnonzero(cells_across_kinks(turned)), [3, 4, 5])
    # At an end the stencil is that of the cell beside it.
    assert cells_across_kinks(turned[3:]).tolist() == [True, True, True, False, False]
    assert not cells_across_kinks(np.ones((1, 4, 2), dtype=bool)).any()


def test_rows_of_two_branches_are_far_from_each_other() -> None:
    phases = np.linspace(0, 0.1, 9)[:, None] + np.array([0.0, 1.0])
    assert not cells_of_far_rows(phases).any()
    phases[5:, 1] += 0.4
    np.testing.assert_array_equal(np.flatnonzero(cells_of_far_rows(phases)), [3, 4, 5])
    phases[0] = np.nan  # a row without a design says nothing
    np.testing.assert_array_equal(np.flatnonzero(cells_of_far_rows(phases)), [3, 4, 5])
