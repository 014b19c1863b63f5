"""What is left of a command that a controller plays in cycles, each level held for one of them."""

from dataclasses import dataclass

import numpy as np

from design.analysis.residual import residual_vibration
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.model.reference_ramps import reference
from design.response.closed_form import travel
from design.sampling.sample_grid import MAX_SAMPLES, split

CYCLES_PER_PERIOD = 10
"""Cycles of a period of the plant, at least: of longer ones there are no figures [-]."""

JITTER = 0.1
"""By how much of a cycle a call may be early or late [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlayedInCycles:
    """Figures of a command in steady cycles.

    Attributes
    ----------
    cycle_s
        How long each is [s].
    residual
        Residual vibration, a share of one unshaped step [-].
    jitter_s
        By how much a call may be early or late [s].
    with_jitter
        What the residual is then at most, to first order in the jitter [-].
    missed
        Travel less that of the command, over that of the command [-].
    """

    cycle_s: float
    residual: float
    jitter_s: float
    with_jitter: float
    missed: float


def reached_s(command: Impulses, actuator: Actuator) -> float:
    """Return when the last level of a command is reached [s].

    Parameters
    ----------
    command, actuator
        The command, and its drive.

    Returns
    -------
    float
        Time of the last step, or behind limits the end of the last ramp, without dead time.
    """
    ramps = reference(command, actuator)
    return max(float((ramps.times_s + ramps.ramps_s).max()), float(command.times_s[-1]))


def played_in_cycles(
    command: Impulses,
    mode: Mode,
    actuator: Actuator,
    cycle_s: float,
    swing: FreeSwing | None = None,
) -> PlayedInCycles | None:
    """Return what is left of a command, the mean of its levels in each cycle.

    A step between two cycles is shared by them, which keeps its mean time. A call that is early or
    late moves what it plays: the residual grows by no more than the sum of what each step adds
    that is moved alone, to first order.

    Parameters
    ----------
    command
        Steps of a move, from rest to rest.
    mode, actuator
        The plant's mode and its drive.
    cycle_s
        Time between two calls, > 0 [s].
    swing
        What the payload swings already at the first step.

    Returns
    -------
    PlayedInCycles or None
        None of cycles longer than a tenth of the plant's period or than the command, or too many.
    """
    longest_s = min(mode.period_s / CYCLES_PER_PERIOD, command.duration_s)
    if not command.duration_s / MAX_SAMPLES <= cycle_s <= longest_s:
        return None
    played = split(command, cycle_s)
    jitter_s = JITTER * cycle_s
    residual = residual_vibration(played, mode, actuator, swing)
    added = 0.0
    for step in range(played.times_s.size):
        moved = played.times_s + jitter_s * (np.arange(played.times_s.size) == step)
        # Both have a vector: what the step adds is no longer than their lengths together.
        late = Impulses(times_s=moved, amplitudes=played.amplitudes)
        added += residual_vibration(late, mode, actuator, swing) + residual
    way_s = travel(command, actuator)
    return PlayedInCycles(
        cycle_s=cycle_s,
        residual=residual,
        jitter_s=jitter_s,
        with_jitter=residual + added,
        missed=travel(played, actuator) / way_s - 1,
    )
