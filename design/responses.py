"""Exact response of actuator and mode to a stepped command, by matrix exponential.

The state is the distance to the equilibrium of the present command::

    [accel lag (0-2 states), decel lag (0-2 states), q, q'/w],   q'' + 2 z w q' + w^2 q = w^2 v

so that it is free between the steps, ``e(t + d) = expm(A d) e(t)``, and jumps at each. The
deflection of the payload under the acceleration v' is ``-q'/w^2``: driving q by v instead keeps
every jump finite, an ideal actuator's included.
"""

from dataclasses import dataclass

import numpy as np

from design.actuators import Actuator, Lag
from design.exponential import exponentials
from design.impulses import Impulses
from design.plants import Mode
from design.types import ComplexArray, FloatArray


def _lag_matrix(lag: Lag) -> FloatArray:
    """State matrix of a lag's error, shape (order, order); its first state is the velocity's."""
    if lag.second_s2 > 0:
        frequency = lag.second_s2**-0.5
        return np.array([[0.0, frequency], [-frequency, -lag.first_s * frequency**2]])
    if lag.first_s > 0:
        return np.array([[-1 / lag.first_s]])
    return np.zeros((0, 0))


@dataclass(frozen=True, slots=True, eq=False)
class _ErrorDynamics:
    """State matrices of one actuator on modes of several frequencies, f of them, n states each."""

    matrices: FloatArray  # (f, n, n)
    jumps: FloatArray  # (2, n): what a unit step takes off the state, by set (decel, accel)
    coupled: list[int]  # states that are velocity errors

    @property
    def size(self) -> int:
        return int(self.matrices.shape[-1])


def _error_dynamics(
    actuator: Actuator, frequencies_rad_s: FloatArray, damping_ratio: float
) -> _ErrorDynamics:
    blocks = [_lag_matrix(actuator.accel_lag), _lag_matrix(actuator.decel_lag)]
    orders = [len(block) for block in blocks]
    size = sum(orders) + 2
    w = frequencies_rad_s
    matrices = np.zeros((w.size, size, size))
    jumps = np.zeros((2, size))
    jumps[:, -2] = 1.0
    coupled = []
    start = 0
    for row, (block, order) in enumerate(zip(blocks, orders, strict=True)):
        if order:
            matrices[:, start : start + order, start : start + order] = block
            matrices[:, -1, start] = w
            jumps[1 - row, start] = 1.0
            coupled.append(start)
        start += order
    matrices[:, -2, -1] = w
    matrices[:, -1, -2] = -w
    matrices[:, -1, -1] = -2 * damping_ratio * w
    return _ErrorDynamics(matrices, jumps, coupled)


def _states_after_steps(impulses: Impulses, dynamics: _ErrorDynamics) -> FloatArray:
    """Error states just after each step, shape (steps, f, n)."""
    gaps = impulses.times_s[1:] - impulses.times_s[:-1]
    carried = exponentials(dynamics.matrices * gaps[:, None, None, None])
    jumps = impulses.amplitudes[:, None] * dynamics.jumps[impulses.accelerates.astype(int)]
    states = np.empty((gaps.size + 1, *dynamics.matrices.shape[:2]))
    states[0] = -jumps[0]
    for index in range(gaps.size):
        states[index + 1] = (carried[index] @ states[index][..., None])[..., 0] - jumps[index + 1]
    return states


def ringing_after(
    impulses: Impulses, actuator: Actuator, frequencies_rad_s: FloatArray, damping_ratio: float
) -> tuple[ComplexArray, ComplexArray]:
    """Return the free vibration that a command leaves, and that of an unshaped step.

    Parameters
    ----------
    impulses
        The command.
    actuator
        The actuator between command and mode.
    frequencies_rad_s
        Natural frequencies of the mode, shape (f,) [rad/s].
    damping_ratio
        Damping ratio of the mode [-].

    Returns
    -------
    tuple of ComplexArray
        Modal coordinates, shape (f,) each: of the command at its last step, and of a unit step
        that increases the command at that step. A unit step through an ideal actuator leaves 1.
        The actuator's own transient is projected out by the left eigenvector of the mode in the
        coupled system.
    """
    dynamics = _error_dynamics(actuator, frequencies_rad_s, damping_ratio)
    final = _states_after_steps(impulses, dynamics)[-1]
    # Left eigenvector l A = s l: [l_lags, -1, s/w], from the bottom block upward.
    unit_pole = complex(-damping_ratio, (1 - damping_ratio**2) ** 0.5)
    lags = dynamics.size - 2
    left = np.empty((frequencies_rad_s.size, dynamics.size), dtype=np.complex128)
    left[:, -2] = -1.0
    left[:, -1] = unit_pole
    if lags:
        poles = (unit_pole * frequencies_rad_s)[:, None, None]
        shifted = poles * np.eye(lags) - dynamics.matrices[:, :lags, :lags].swapaxes(1, 2)
        drive = dynamics.matrices[:, -1, :lags] * unit_pole
        left[:, :lags] = np.linalg.solve(shifted, drive[..., None])[..., 0]
    return (left * final).sum(axis=1), -left @ dynamics.jumps[1]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class History:
    """What happens over time, all of shape (n,).

    Attributes
    ----------
    times_s
        Times [s].
    command
        Commanded velocity as share of full speed [-].
    velocity
        Velocity of the actuator as share of full speed [-].
    deflection
        Deflection of the payload times w over full speed: a unit step through an ideal actuator
        swings with amplitude 1 if undamped [-].
    """

    times_s: FloatArray
    command: FloatArray
    velocity: FloatArray
    deflection: FloatArray


def history(impulses: Impulses, mode: Mode, actuator: Actuator, times_s: FloatArray) -> History:
    """Return the time history of a command, exact at each of ``times_s``.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive.
    times_s
        Times, shape (n,) [s]; before the first step all is at rest.
    """
    dynamics = _error_dynamics(
        actuator, np.array([mode.natural_frequency_rad_s]), mode.damping_ratio
    )
    after = _states_after_steps(impulses, dynamics)[:, 0]
    segment = np.searchsorted(impulses.times_s, times_s, side="right") - 1
    moving = segment >= 0
    started = np.maximum(segment, 0)
    elapsed = np.where(moving, times_s - impulses.times_s[started], 0.0)
    flow = exponentials(dynamics.matrices[0][None] * elapsed[:, None, None])
    states = np.where(moving[:, None], (flow @ after[started][..., None])[..., 0], 0.0)
    command = np.where(moving, np.cumsum(impulses.amplitudes)[started], 0.0)
    return History(
        times_s=times_s,
        command=command,
        velocity=command + states[:, dynamics.coupled].sum(axis=1),
        deflection=-states[:, -1],
    )
