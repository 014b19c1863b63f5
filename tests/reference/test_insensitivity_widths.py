"""Insensitivity of the shapers that machine firmware carries, undamped, at 5 and 10 percent.

Widths to every digit known; the impulses are given by hand. Published for EI: .3992 (at 5 %).
"""

import math

import numpy as np
import pytest

from design.analysis.insensitivity import insensitivity
from design.model.actuators.ideal import Ideal
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.shaper_table import IDEAL

UNIT = Mode(natural_frequency_rad_s=2 * math.pi)
V = 0.05
ROOT2 = math.sqrt(2)
MZV_OUTER = 1 - 1 / ROOT2

BY_HAND = {
    "ZV": ([0.5, 0.5], [0, 0.5]),
    "ZVD": ([0.25, 0.5, 0.25], [0, 0.5, 1]),
    "ZVDD": ([0.125, 0.375, 0.375, 0.125], [0, 0.5, 1, 1.5]),
    "EI": ([(1 + V) / 4, (1 - V) / 2, (1 + V) / 4], [0, 0.5, 1]),
    # Three steps 3/8 of a period apart, the middle one sqrt(2) times the others.
    "MZV": ([MZV_OUTER, ROOT2 * MZV_OUTER, MZV_OUTER], [0, 0.375, 0.75]),
}


def by_hand(name: str) -> Impulses:
    amplitudes, periods = BY_HAND[name]
    return Impulses(times_s=np.array(periods, dtype=float), amplitudes=np.array(amplitudes))


def width(impulses: Impulses, tolerance: float) -> float:
    interval = insensitivity(impulses, UNIT, Ideal(), tolerance)
    assert interval is not None
    assert interval.width is not None
    return interval.width


@pytest.mark.parametrize("name", BY_HAND)
def test_amplitudes_given_by_hand_sum_to_one(name: str) -> None:
    assert sum(BY_HAND[name][0]) == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize(
    ("name", "at_5_percent", "at_10_percent"),
    [
        ("ZV", 0.06369, 0.12754),
        ("MZV", 0.10350, 0.21438),
        ("ZVD", 0.28713, 0.40967),
        ("ZVDD", 0.48038, 0.61457),
        ("EI", 0.39945, 0.49350),
    ],
)
def test_positive_shapers_have_their_known_widths(
    name: str, at_5_percent: float, at_10_percent: float
) -> None:
    assert width(by_hand(name), 0.05) == pytest.approx(at_5_percent, abs=0.51e-5)
    assert width(by_hand(name), 0.10) == pytest.approx(at_10_percent, abs=0.51e-5)


@pytest.mark.parametrize("tolerance", [0.05, 0.1])
@pytest.mark.parametrize(("name", "order"), [("ZV", 1), ("ZVD", 2), ("ZVDD", 3)])
def test_zv_shapers_of_any_order_have_closed_form_widths(
    name: str, order: int, tolerance: float
) -> None:
    # |cos(pi r / 2)|^order = V
    closed = 4 / math.pi * math.asin(tolerance ** (1 / order))
    # The tolerance's own margin of 1e-9 moves an edge by as much over the slope.
    assert width(by_hand(name), tolerance) == pytest.approx(closed, abs=1e-8)


@pytest.mark.parametrize(
    ("name", "at_5_percent", "at_10_percent"),
    [("umzv", 0.05515, 0.11039), ("umzvd", 0.25856, 0.36790)],
)
def test_unity_magnitude_shapers_have_their_known_widths(
    name: str, at_5_percent: float, at_10_percent: float
) -> None:
    impulses = design(UNIT, IDEAL, SHAPERS[name]).impulses
    assert width(impulses, 0.05) == pytest.approx(at_5_percent, abs=0.51e-5)
    assert width(impulses, 0.10) == pytest.approx(at_10_percent, abs=0.51e-5)
