"""How much a shaper excites modes above the one that it was designed for."""

import numpy as np

from design.actuators import Actuator
from design.analysis.residual import residual_curve
from design.impulses import Impulses
from design.plants import Mode

HIGH_MODES = (1.5, 10.0)
"""Ratios of frequency that count as high modes [-].

Below, a mode is the band's; a decade on nothing new comes: V of an undamped mode is almost
periodic in frequency, and a drive passes little there.
"""

STEP_RAD = 0.1
"""Turn of the last impulse's phase from one frequency to the next, at most [rad]."""

LARGEST_STEP = 0.02
"""The same as a step of the ratio: far less than the peak of an actuator's set is wide [-]."""

ZOOMS = 7
"""How often a peak is looked at four times closer: it is then known to 1e-10."""


def high_mode_gain(impulses: Impulses, mode: Mode, actuator: Actuator) -> float:
    """Return the most that a command leaves in any higher mode, a share of an unshaped step [-].

    The largest residual from 1.5 to 10 times the mode's frequency at its damping ratio, peaks found
    between grid points. It is in units of the unshaped step *at that frequency*: 1 is as good as no
    shaper. Behind an ideal actuator a positive shaper has at most 1, any other at most the sum
    of its amplitudes' sizes.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The mode that it was designed for, and the drive.
    """
    low, high = HIGH_MODES
    turn = mode.natural_frequency_rad_s * impulses.duration_s
    points = int((high - low) * max(turn / STEP_RAD, 1 / LARGEST_STEP)) + 2
    ratios = np.linspace(low, high, points)
    values = residual_curve(impulses, mode, actuator, ratios)
    largest = float(values.max())
    around = np.pad(values, 1, constant_values=-np.inf)
    peaks = np.flatnonzero((values >= around[:-2]) & (values >= around[2:]))
    middles, reach = ratios[peaks], float(ratios[1] - ratios[0])
    for _ in range(ZOOMS):
        closer = np.clip(middles[:, None] + reach * np.linspace(-1, 1, 9), low, high)
        curves = residual_curve(impulses, mode, actuator, closer.ravel()).reshape(closer.shape)
        largest = max(largest, float(curves.max()))
        middles, reach = closer[np.arange(middles.size), curves.argmax(axis=1)], reach / 4
    return largest
