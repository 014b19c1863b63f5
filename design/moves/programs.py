"""A move as a controller replays it on its samples, judged as it is played."""

import math
from dataclasses import dataclass

import numpy as np

from design.analysis.judge import judge
from design.analysis.residual import residual_vibration
from design.analysis.warnings import DesignWarning
from design.checks import MIN_VALUE, require_between
from design.claims import zeros
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.sampling.sample_grid import ON_SAMPLE, split
from design.types import FloatArray

MAX_SAMPLES = 100_000
"""Longest program, a bound on the work of one request."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Program:
    """A command on a controller's samples.

    Attributes
    ----------
    times_s
        Samples from the first step to the first sample at or after the last, shape (n,) [s].
    velocity_m_s
        Mean velocity over the sample that follows, shape (n,): replayed and held, it meets every
        position [m/s].
    position_m
        Position of the command at each sample, exact, shape (n,) [m].
    residual
        Residual vibration of the velocities as they are played, a share of one unshaped step [-].
    warnings
        One with that figure where it is not zero.
    """

    times_s: FloatArray
    velocity_m_s: FloatArray
    position_m: FloatArray
    residual: float
    warnings: tuple[DesignWarning, ...]


def program(
    command: Impulses,
    mode: Mode,
    actuator: Actuator,
    speed_m_s: float,
    sample_time_s: float,
    swing: FreeSwing | None = None,
) -> Program:
    """Return a command as positions and velocities at a sample time.

    The mean velocity over a sample in which the command steps is between the two levels: each step
    is shared between the samples around it, and what is played is no longer what was designed.

    Parameters
    ----------
    command
        Steps as shares of the speed, the first at time 0.
    mode, actuator
        The plant's mode and its drive.
    speed_m_s
        Full speed, signed [m/s].
    sample_time_s
        Time between samples, > 0 [s].
    swing
        What the payload swings already at the first step.

    Returns
    -------
    Program
        What is sent at each sample, with what remains of it.

    Raises
    ------
    InvalidInputError
        If the sample time is longer than the command, or so short that there are too many samples.
    """
    require_between("sample_time_s", sample_time_s, MIN_VALUE, max(command.duration_s, MIN_VALUE))
    samples = math.ceil(command.duration_s / sample_time_s - ON_SAMPLE)
    if samples >= MAX_SAMPLES:
        raise InvalidInputError(
            "sample_time_s",
            sample_time_s,
            f"such that there are fewer than {MAX_SAMPLES} samples",
            code="too_many_samples",
        )
    played = split(command, sample_time_s)
    numbers = np.arange(samples + 1)
    times = sample_time_s * numbers
    levels = np.concatenate(([0.0], np.cumsum(played.amplitudes)))
    levels[-1] = float(command.amplitudes.sum())
    begun = np.searchsorted(np.rint(played.times_s / sample_time_s), numbers, side="right")
    since = np.maximum(np.subtract.outer(times, command.times_s), 0.0)
    judged = judge(played, (mode,), actuator, zeros(["residual"]), name="the program", swing=swing)
    warnings: tuple[DesignWarning, ...] = ()
    if not judged.certificate.verified:
        between = residual_vibration(command, mode, actuator, swing)
        warnings = (
            DesignWarning(
                code="program_residual",
                detail=f"played on samples of {sample_time_s:g} s, each velocity held, the "
                f"residual of the program is {100 * judged.residual:.4g} % of an unshaped "
                "step; that of its command, whose steps fall between the samples, is "
                f"{100 * between:.4g} %",
            ),
        )
    return Program(
        times_s=times,
        velocity_m_s=speed_m_s * levels[begun],
        position_m=speed_m_s * (since @ command.amplitudes),
        residual=judged.residual,
        warnings=warnings,
    )
