"""Emergency stops behind unequal sets: no random start of another solver goes a shorter way."""

from dataclasses import replace

import numpy as np
import pytest

from design.live.emergency import stop_case
from design.live.stop_case import StopCase
from tests.design.live.machines import CRANE
from tests.design.live.stop_cases import KIM_LAGS, least_of_random_starts, random_case


@pytest.mark.parametrize(("swing_left", "periods"), [(0.0, 1.0), (0.1, 1.0), (0.0, 2.0)])
def test_behind_the_thesis_drive_200_random_starts_find_no_shorter_way(
    swing_left: float, periods: float
) -> None:
    rng = np.random.default_rng(11)
    case = StopCase(
        level=1.0,
        force=0,
        lag=np.zeros((2, 2)),
        vibration=np.zeros(1, dtype=np.complex128),
        lags=KIM_LAGS,
        poles_rad_s=np.array([CRANE.mode.pole_rad_s]),
        switched=True,
        end_s=periods * CRANE.mode.period_s,
    )
    done = stop_case(case, swing_left)
    assert done.asked
    assert done.stop.way_s <= least_of_random_starts(case, swing_left, 200, rng) + 1e-7


def test_random_states_of_unequal_sets_stop_as_short_as_random_starts_find() -> None:
    rng = np.random.default_rng(13)
    for _ in range(8):
        case = replace(random_case(rng, KIM_LAGS), level=1.0)
        done = stop_case(case, 0.1)
        if done.asked:
            # A thousandth of a second of full speed before the stop begins can gain a little.
            best = least_of_random_starts(case, 0.1, 30, rng)
            assert done.stop.way_s <= best + 5e-4
