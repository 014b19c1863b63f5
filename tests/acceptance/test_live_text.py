"""Live blocks in Structured Text: a release after any time, on cables of any length, rests."""

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.export.live_blocks.block import bound
from tests.live_blocks import (
    CRANE,
    LENGTHS_M,
    THESIS,
    block_of,
    held,
    play_in_text,
    sent,
    text_of,
)

RELEASES = 1000
LENGTHS = 50
CYCLE_S = 0.01
Real = Literal["LREAL", "REAL"]
LONGEST_PERIODS = 1.2
"""Press that reaches every phase of the shaper; then all is as after a longer one [periods]."""

OVER_PERIODS = 0.75
"""Time after a release within which its last switch comes [periods]."""


@pytest.mark.parametrize("real", ["LREAL", "REAL"])
def test_a_thousand_releases_on_fifty_cables_keep_the_bound(real: Real) -> None:
    rng = np.random.default_rng(4)
    lengths_m = rng.uniform(*LENGTHS_M, LENGTHS)
    block = block_of(real=real)
    text = text_of(block)
    worst = 0.0
    for number in range(RELEASES):
        length_m = float(lengths_m[number % LENGTHS])
        mode = replace(CRANE, cable_length_m=length_m).mode
        press_s = float(rng.uniform(0.02, LONGEST_PERIODS)) * mode.period_s
        wanted = held((1.0, press_s), (0.0, OVER_PERIODS * mode.period_s), cycle_s=CYCLE_S)
        share = play_in_text(text, block.name, wanted, CYCLE_S, length_m)
        assert share[-1] == 0.0
        assert 0.0 <= share.min() <= share.max() <= 1.0
        worst = max(worst, residual_vibration(sent(share, CYCLE_S), mode, THESIS))
    assert worst <= bound(real) <= min(3 * worst, 1e-3)


@pytest.mark.parametrize("real", ["LREAL", "REAL"])
def test_the_forty_presses_keep_the_bound(real: Real) -> None:
    block = block_of(real=real)
    for press_s in np.random.default_rng(1).uniform(0.05, 2.5, 40).tolist():
        wanted = held((1.0, press_s), (0.0, 1.1), cycle_s=CYCLE_S)
        share = play_in_text(text_of(block), block.name, wanted, CYCLE_S)
        assert share[-1] == 0.0
        assert residual_vibration(sent(share, CYCLE_S), CRANE.mode, THESIS) <= bound(real)
