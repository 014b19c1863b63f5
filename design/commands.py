"""Velocity commands as steps."""

import math
from dataclasses import dataclass

import numpy as np

from design.errors import InvalidInputError
from design.impulses import Impulses
from design.types import LARGEST, SMALLEST, FloatArray, require_between

MOST_SAMPLES = 100_000
"""Longest program, a bound on the work of one request."""


def step() -> Impulses:
    """Return the unit step at time 0."""
    return Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))


def pulse(pulse_s: float) -> Impulses:
    """Return full speed from 0 to ``pulse_s``.

    Raises
    ------
    InvalidInputError
        If the pulse is not > 0.
    """
    require_between("pulse_s", pulse_s, SMALLEST, LARGEST)
    return Impulses(times_s=np.array([0.0, pulse_s]), amplitudes=np.array([1.0, -1.0]))


def listed(times_s: FloatArray, velocities: FloatArray) -> Impulses:
    """Return a command that takes each velocity at its time and holds it.

    Parameters
    ----------
    times_s
        Times, shape (n,), not decreasing [s].
    velocities
        Velocities from those times on as shares of full speed, shape (n,) [-]; at rest before.

    Raises
    ------
    InvalidInputError
        If time runs backwards, the lists differ in length, or nothing ever moves.
    """
    if velocities.shape != times_s.shape:
        raise InvalidInputError(
            "velocity_m_s", f"{velocities.size} numbers", f"as many as the times, {times_s.size}"
        )
    if not np.any(velocities):
        raise InvalidInputError("velocity_m_s", velocities[:1].tolist(), "not all zero")
    return Impulses(times_s=times_s, amplitudes=np.diff(velocities, prepend=0.0))


def convolved(command: Impulses, shaper: Impulses) -> Impulses:
    """Return a command shaped by a shaper: every step replaced by the shaper's steps."""
    times = np.add.outer(command.times_s, shaper.times_s).ravel()
    amplitudes = np.multiply.outer(command.amplitudes, shaper.amplitudes).ravel()
    order = np.argsort(times, kind="stable")
    return Impulses(times_s=times[order], amplitudes=amplitudes[order])


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
    """

    times_s: FloatArray
    velocity_m_s: FloatArray
    position_m: FloatArray


def program(command: Impulses, speed_m_s: float, sample_time_s: float) -> Program:
    """Return a command as positions and velocities at a sample time.

    Parameters
    ----------
    command
        Steps as shares of the speed.
    speed_m_s
        Full speed, signed [m/s].
    sample_time_s
        Time between samples, > 0 [s].

    Raises
    ------
    InvalidInputError
        If the sample time is longer than the command, or so short that there are too many samples.
    """
    require_between("sample_time_s", sample_time_s, SMALLEST, max(command.duration_s, SMALLEST))
    samples = math.ceil(command.duration_s / sample_time_s * (1 - 1e-12))
    if samples >= MOST_SAMPLES:
        raise InvalidInputError(
            "sample_time_s", sample_time_s, f"such that there are fewer than {MOST_SAMPLES} samples"
        )
    times = float(command.times_s[0]) + sample_time_s * np.arange(samples + 1)
    since = np.maximum(np.subtract.outer(times, command.times_s), 0.0)
    positions = speed_m_s * (since @ command.amplitudes)
    return Program(
        times_s=times,
        velocity_m_s=np.append(np.diff(positions) / sample_time_s, 0.0),
        position_m=positions,
    )
