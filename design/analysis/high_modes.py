"""How much a shaper excites modes above the one that it was designed for."""

from design.analysis.peaks import largest_between
from design.analysis.residuals_of_many import residual_curve
from design.analysis.step_contributions import step_contributions
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode

HIGH_MODES = (1.5, 10.0)
"""Ratios of frequency that count as high modes [-].

Below, a mode is the band's, if that is no wider; a decade on nothing new comes: V of an undamped
mode is almost periodic in frequency, and a drive passes little there.
"""

STEP_RAD = 0.1
"""Turn of the last impulse's phase from one frequency to the next, at most [rad]."""

MAX_STEP = 0.02
"""The same as a step of the ratio: far less than the peak of an actuator's set is wide [-]."""


def high_mode_gain(impulses: Impulses, mode: Mode, actuator: Actuator) -> float:
    """Return the largest residual of a command in any higher mode [-].

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

    Returns
    -------
    float
        Share of an unshaped step [-].
    """
    low, high = HIGH_MODES
    moving_s = float(step_contributions(impulses, actuator).until_end_s[0])
    turn = mode.natural_frequency_rad_s * moving_s
    points = int((high - low) * max(turn / STEP_RAD, 1 / MAX_STEP)) + 2
    return largest_between(
        lambda ratios: residual_curve(impulses, mode, actuator, ratios), low, high, points
    )
