"""Velocity commands as steps."""

import numpy as np

from design.checks import MAX_VALUE, MIN_VALUE, require_between
from design.errors import InvalidInputError
from design.model.impulses import Impulses
from design.model.merging import merged
from design.types import FloatArray


def step() -> Impulses:
    """Return the unit step at time 0."""
    return Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))


def pulse(pulse_s: float) -> Impulses:
    """Return full speed from 0 to ``pulse_s``.

    Parameters
    ----------
    pulse_s
        Duration [s].

    Returns
    -------
    Impulses
        Steps of +1 at 0 and -1 at the end.

    Raises
    ------
    InvalidInputError
        If the duration is not between 1e-12 and 1e12 s.
    """
    require_between("pulse_s", pulse_s, MIN_VALUE, MAX_VALUE)
    return Impulses(times_s=np.array([0.0, pulse_s]), amplitudes=np.array([1.0, -1.0]))


def command_of_velocities(times_s: FloatArray, velocities: FloatArray) -> Impulses:
    """Return a command that takes each velocity at its time, and holds it.

    Parameters
    ----------
    times_s
        Times, shape (n,), not decreasing [s]. Of several velocities at one time the last counts.
    velocities
        Velocities from those times on as shares of full speed, shape (n,) [-]; at rest before.

    Returns
    -------
    Impulses
        The changes of velocity, one step a time; velocities that change nothing are left out.

    Raises
    ------
    InvalidInputError
        If time runs backwards, the lists differ in length, a velocity is no number of a size to
        compute with, or nothing ever moves.
    """
    if velocities.shape != times_s.shape:
        raise InvalidInputError(
            "velocity_m_s",
            f"{velocities.size} numbers",
            f"as many as the times, {times_s.size}",
            code="velocities_unlike_times",
        )
    huge = ~(np.abs(velocities) <= MAX_VALUE / 2)  # not a number is not
    if huge.any():
        index = int(huge.argmax())
        raise InvalidInputError(
            f"velocity_m_s.{index}",
            f"{float(velocities[index]):g} times",
            f"a number, at most {MAX_VALUE / 2:g} times full speed",
            code="velocity_out_of_range",
        )
    last = np.append(times_s[1:] != times_s[:-1], True)
    if not np.any(velocities[last]):
        raise InvalidInputError(
            "velocity_m_s",
            velocities[:1].tolist(),
            "not all zero, the last at each time",
            code="velocities_all_zero",
        )
    return merged(Impulses(times_s=times_s, amplitudes=np.diff(velocities, prepend=0.0)))


def convolve(command: Impulses, shaper: Impulses) -> Impulses:
    """Return a command shaped by a shaper.

    Every step of the command is replaced by the shaper's steps, scaled by its height.

    Parameters
    ----------
    command
        The command, of n steps.
    shaper
        The shaper, of m steps.

    Returns
    -------
    Impulses
        At most n m steps: those at one time are added up.

    Raises
    ------
    InvalidInputError
        If all of these cancel.

    Examples
    --------
    >>> zv = Impulses(times_s=np.array([0.0, 0.5]), amplitudes=np.array([0.5, 0.5]))
    >>> convolve(pulse(2.0), zv).times_s.tolist()
    [0.0, 0.5, 2.0, 2.5]
    """
    times = np.add.outer(command.times_s, shaper.times_s).ravel()
    amplitudes = np.multiply.outer(command.amplitudes, shaper.amplitudes).ravel()
    order = np.argsort(times, kind="stable")
    return merged(Impulses(times_s=times[order], amplitudes=amplitudes[order]))
