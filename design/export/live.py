"""For which drives a delay line is exact when a live command changes, and its residual otherwise.

A delay line convolves its command with the impulses of a row, one and the same for every change.
That residual follows from the records of the design:

- a drive that is one linear lag, or none, shapes a sum of steps as the sum of its answers: whatever
  the impulses leave after one step they leave after any command, at any time;
- with lags apart for more and less speed, superposed, a positive shaper's steps up share one lag
  and its steps down the other: each adds up to nothing, and so do all. Steps up and down in one
  shaper do not: at a release they change sets, so that a stop needs a separate shaper;
- a switched drive, or one with limits, has one state for all steps: a change is exact only if the
  last sequence is over and the drive at rest at its speed, and a release as above.

References
----------
.. [1] J. Kim, master thesis, 2011, eqs. 3.56-3.59: a stop mirrored from its start is exact for a
   symmetric actuator only.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from design.analysis.residual import residual_vibration
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.commands import convolve
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.types import FloatArray

PRESSES = 40
MIN_PRESS, MAX_PRESS = 0.025, 1.25
"""Pulses that are tried, in periods of the slowest mode: from a tap to beyond any usual shaper."""

LEVEL_MARGIN = 1e-9
"""How far a level may be outside 0 to 1: rounding [-]."""


class Early(NamedTuple):
    """What pulses leave that end at any time, as shares of an unshaped step.

    ``beyond``: share of the pulses whose shaped command goes beyond 0 to 1.
    """

    median: float
    most: float
    beyond: float


def early_releases(
    shaper: Impulses, modes: tuple[Mode, ...], actuator: Actuator, presses_s: FloatArray
) -> Early:
    """Return what is left of pulses of full speed through a delay line.

    Parameters
    ----------
    shaper
        Impulses of the delay line.
    modes, actuator
        Of the machine.
    presses_s
        Lengths of the pulses, shape (m,), > 0 [s].

    Returns
    -------
    Early
        Of the residuals the median and the largest; the share of pulses with levels beyond 0 to 1.
    """
    left, beyond = [], []
    for press in presses_s.tolist():
        pulse = Impulses(times_s=np.array([0.0, press]), amplitudes=np.array([1.0, -1.0]))
        command = convolve(pulse, shaper)
        levels = command.amplitudes.cumsum()
        beyond.append(levels.min() < -LEVEL_MARGIN or levels.max() > 1 + LEVEL_MARGIN)
        left.append(max(residual_vibration(command, mode, actuator) for mode in modes))
    return Early(float(np.median(left)), max(left), float(np.mean(beyond)))


def live_remarks(
    tried: Impulses, row: int, plant: Plant, drives: Sequence[Actuator], *, positive: bool
) -> list[str]:
    """Return the lines on live commands for the head of a program.

    Parameters
    ----------
    tried, row, plant
        The first row that has a design, its number from 0, and its plant.
    drives
        Of the rows, its own first; one stands for all that are alike.
    positive
        Whether all amplitudes are above 0.

    Returns
    -------
    list of str
        Lines without marks of a comment.
    """
    held = list(drives)
    limited = any(isinstance(drive, RateLimited) for drive in held)
    apart = any(drive.accel_lag != drive.decel_lag for drive in held)
    switched = apart and any(getattr(drive, "model", "") == "switched" for drive in held)
    lines = ["live commands: the delay line convolves the command with a row, whenever it changes;"]
    if limited:
        lines += [
            "behind the limits of this drive it is as claimed only for a step from rest to full",
            "speed that is not changed before the last ramp is over: limits are not linear",
        ]
    elif not apart:
        lines.append(
            "behind this drive, which is linear, each change leaves at any time what its row leaves"
        )
        if not positive:
            lines += [
                "but a command that changes before the last sequence is over goes beyond 0 to 1:",
                "what clips it there spoils it",
            ]
    elif positive and not switched:
        lines += [
            "steps up share the acceleration set of this drive, steps down the deceleration set:",
            "where they superpose each change leaves at any time what its row leaves",
        ]
    elif positive:
        lines += [
            "behind this drive, whose sets are switched, a start leaves what its row leaves; a",
            "release goes by the other set, and an early one meets a drive that has not settled",
        ]
    else:
        lines += [
            "behind this drive, which accelerates and brakes differently, a start has the residual",
            "of its row, if the last sequence is over by then; a release never does. This delay",
            "line is for starts only. For a joystick take a positive shaper, such as zvd, or the",
            "start and stop blocks of a move",
        ]
    if limited:  # nothing is known of commands beyond 0 to 1, as these may be
        return lines
    return [*lines, *_early_release_lines(tried, row, plant.modes, held[0])]


def _early_release_lines(
    tried: Impulses, row: int, modes: tuple[Mode, ...], drive: Actuator
) -> list[str]:
    period_s = max(mode.period_s for mode in modes)
    presses_s = np.linspace(MIN_PRESS, MAX_PRESS, PRESSES) * period_s
    early = early_releases(tried, modes, drive, presses_s)
    lines = [
        f"commands on for {presses_s[0]:.2g} to {presses_s[-1]:.2g} s, shaped by row {row}, leave "
        f"{100 * early.most:.3g} % at worst,",
        f"{100 * early.median:.3g} % in the median",
    ]
    if early.beyond:
        lines[-1] += f"; {100 * early.beyond:.0f} % of these commands go below 0 or above 1"
    return lines
