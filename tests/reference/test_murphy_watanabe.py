"""Impulses split over two samples each, after Murphy and Watanabe, at 7.3 Hz, z = .05, 10 ms.

Their digital filter gives each impulse the two amplitudes on its neighbouring samples that swing as
it does: exact for any impulses, but neither sum nor unity magnitude are kept.
"""

import cmath
import math

import numpy as np
import pytest

from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS

W, Z, SAMPLE_S = 2 * math.pi * 7.3, 0.05, 0.01
POLE = W * complex(-Z, math.sqrt(1 - Z * Z))

PUBLISHED_UMZV = ((0.16724, 0.27242, 0.20345, 0.0), (0.33323, 0.00533, 0.17914, 0.20125))
"""t2 and t3 over T, ascending powers of the damping ratio: Singhose, Seering, Singer (1997)."""


def split(times_s: list[float], amplitudes: list[float]) -> dict[int, float]:
    """Return amplitudes by the number of their sample."""
    shares: dict[int, float] = {}
    for time, amplitude in zip(times_s, amplitudes, strict=True):
        first = math.floor(time / SAMPLE_S)
        turns = [cmath.exp(-POLE * SAMPLE_S * number) for number in (first, first + 1)]
        wanted = amplitude * cmath.exp(-POLE * time)
        parts = np.linalg.solve(
            [[turn.real for turn in turns], [turn.imag for turn in turns]],
            [wanted.real, wanted.imag],
        )
        for number, part in zip((first, first + 1), parts.tolist(), strict=True):
            shares[number] = shares.get(number, 0.0) + part
    return {number: share for number, share in shares.items() if share}


def left_percent(shares: dict[int, float]) -> float:
    """Residual by the sum of its vectors, over an unshaped step of the same height [%]."""
    last = max(shares)
    vectors = [
        share * cmath.exp(POLE * SAMPLE_S * (last - number)) for number, share in shares.items()
    ]
    return 100 * abs(sum(vectors)) / sum(shares.values())


def exact(kind: str) -> tuple[list[float], list[float]]:
    mode = Mode(natural_frequency_rad_s=W, damping_ratio=Z)
    impulses = design(mode, Ideal(), SHAPERS[kind]).impulses
    return impulses.times_s.tolist(), impulses.amplitudes.tolist()


@pytest.mark.parametrize("kind", ["zv", "umzv", "umzvd"])
def test_exact_times_stay_exact(kind: str) -> None:
    assert left_percent(split(*exact(kind))) == pytest.approx(0, abs=1e-12)


def test_what_is_left_of_the_published_umzv_is_the_error_of_its_polynomials() -> None:
    times_s = [0.0]
    times_s += [2 * math.pi / W * float(np.polyval(row[::-1], Z)) for row in PUBLISHED_UMZV]
    shares = split(times_s, [1.0, -1.0, 1.0])
    assert left_percent(shares) == pytest.approx(0.043, abs=5e-4)
    assert min(abs(share) for number, share in shares.items() if number) < 0.6  # none at +-1
