"""Response of actuator and mode by matrix exponential: a second opinion on the closed forms.

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
from design.responses import History
from design.types import ComplexArray, FloatArray


def _lag_matrix(lag: Lag, scale_rad_s: float) -> FloatArray:
    """State matrix of a lag's error ``[v - u, v' / scale]``, shape (order, order)."""
    if lag.second_s2 > 0:
        squared = 1 / lag.second_s2
        return np.array([[0.0, scale_rad_s], [-squared / scale_rad_s, -lag.first_s * squared]])
    if lag.first_s > 0:
        return np.array([[-1 / lag.first_s]])
    return np.zeros((0, 0))


@dataclass(frozen=True, slots=True, eq=False)
class _Dynamics:
    """State matrices of one actuator on modes of several frequencies, f of them, n states each.

    Sets are numbered 0, in force after a step that decreases the command's magnitude, and 1. For
    superposed steps both lags stand side by side in one matrix, whichever set is in force; a
    switched actuator has one state and a matrix for either set.
    """

    matrices: FloatArray  # (2, f, n, n)
    jumps: FloatArray  # (2, n): what a unit step into a set takes off the state
    kept: FloatArray  # (2, n): 0 for the states that an ideal set brings to rest at once
    coupled: list[int]  # states that are velocity errors


def _dynamics(actuator: Actuator, frequencies_rad_s: FloatArray, damping_ratio: float) -> _Dynamics:
    both = (actuator.decel_lag, actuator.accel_lag)
    scale = max(lag.corner_rad_s for lag in both)
    if actuator.model == "switched":
        lags, coupled, jumps, kept = _one_state(both, scale)
    else:
        lags, coupled, jumps, kept = _side_by_side(both, scale)
    size = lags.shape[-1]
    w = frequencies_rad_s
    matrices = np.zeros((len(lags), w.size, size + 2, size + 2))
    matrices[:, :, :size, :size] = lags[:, None]
    matrices[:, :, -1, coupled] = w[:, None]
    matrices[:, :, -2, -1] = w
    matrices[:, :, -1, -2] = -w
    matrices[:, :, -1, -1] = -2 * damping_ratio * w
    taken, left = np.zeros((2, size + 2)), np.ones((2, size + 2))
    taken[:, :size], left[:, :size] = jumps, kept
    taken[:, -2] = 1.0  # q is measured from the command
    return _Dynamics(np.broadcast_to(matrices, (2, *matrices.shape[1:])), taken, left, coupled)


def _side_by_side(
    both: tuple[Lag, Lag], scale_rad_s: float
) -> tuple[FloatArray, list[int], FloatArray, FloatArray]:
    """Lag states for superposed steps: each set has its own, excited by its own steps."""
    blocks = [_lag_matrix(lag, scale_rad_s) for lag in both]
    orders = [len(block) for block in blocks]
    matrix = np.zeros((sum(orders), sum(orders)))
    jumps = np.zeros((2, sum(orders)))
    coupled = []
    start = 0
    for which, (block, order) in enumerate(zip(blocks, orders, strict=True)):
        matrix[start : start + order, start : start + order] = block
        if order:
            jumps[which, start] = 1.0
            coupled.append(start)
        start += order
    return matrix[None], coupled, jumps, np.ones_like(jumps)


def _one_state(
    both: tuple[Lag, Lag], scale_rad_s: float
) -> tuple[FloatArray, list[int], FloatArray, FloatArray]:
    """Lag states of a switched actuator: one state, moved by the set in force."""
    blocks = [_lag_matrix(lag, scale_rad_s) for lag in both]
    order = max(map(len, blocks))
    matrices, jumps, kept = np.zeros((2, order, order)), np.zeros((2, order)), np.ones((2, order))
    jumps[:, :1] = 1.0
    for which, block in enumerate(blocks):
        if len(block) == order:
            matrices[which] = block
        else:
            kept[which] = 0.0
    return matrices, [0] if order else [], jumps, kept


def _states_after_steps(impulses: Impulses, dynamics: _Dynamics) -> FloatArray:
    """Error states just after each step, shape (steps, f, n)."""
    gaps = impulses.times_s[1:] - impulses.times_s[:-1]
    sets = impulses.accelerates.astype(int)
    carried = exponentials(dynamics.matrices[sets[:-1]] * gaps[:, None, None, None])
    jumps = impulses.amplitudes[:, None] * dynamics.jumps[sets]
    kept = dynamics.kept[sets]
    states = np.empty((gaps.size + 1, *dynamics.matrices.shape[1:3]))
    states[0] = -jumps[0] * kept[0]
    for index in range(gaps.size):
        moved = (carried[index] @ states[index][..., None])[..., 0]
        states[index + 1] = (moved - jumps[index + 1]) * kept[index + 1]
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
    dynamics = _dynamics(actuator, frequencies_rad_s, damping_ratio)
    final = _states_after_steps(impulses, dynamics)[-1]
    rising = _left_eigenvectors(dynamics, 1, frequencies_rad_s, damping_ratio)
    last = rising
    if not impulses.accelerates[-1]:
        last = _left_eigenvectors(dynamics, 0, frequencies_rad_s, damping_ratio)
    unit = -dynamics.jumps[1] * dynamics.kept[1]
    return (last * final).sum(axis=1), rising @ unit


def _left_eigenvectors(
    dynamics: _Dynamics, force: int, frequencies_rad_s: FloatArray, damping_ratio: float
) -> ComplexArray:
    """Left eigenvectors of the mode in the coupled system of one set, shape (f, n).

    ``l A = s l`` with ``l = [l_lags, -1, s/w]``, from the bottom block upward.
    """
    matrices = dynamics.matrices[force]
    size = matrices.shape[-1]
    lags = size - 2
    unit_pole = complex(-damping_ratio, (1 - damping_ratio**2) ** 0.5)
    left = np.empty((frequencies_rad_s.size, size), dtype=np.complex128)
    left[:, -2] = -1.0
    left[:, -1] = unit_pole
    if lags:
        poles = (unit_pole * frequencies_rad_s)[:, None, None]
        shifted = poles * np.eye(lags) - matrices[:, :lags, :lags].swapaxes(1, 2)
        drive = matrices[:, -1, :lags] * unit_pole
        # A set that brings a lag to rest at once: nothing of it rings.
        left[:, :lags] = (
            np.linalg.solve(shifted, drive[..., None])[..., 0] * dynamics.kept[force, :lags]
        )
    return left


def simulated_history(
    impulses: Impulses, mode: Mode, actuator: Actuator, times_s: FloatArray
) -> History:
    """Return what `design.responses.history` does, by this route.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive.
    times_s
        Times, shape (n,) [s]; before the first step all is at rest.
    """
    dynamics = _dynamics(actuator, np.array([mode.natural_frequency_rad_s]), mode.damping_ratio)
    after = _states_after_steps(impulses, dynamics)[:, 0]
    segment = np.searchsorted(impulses.times_s, times_s, side="right") - 1
    moving = segment >= 0
    started = np.maximum(segment, 0)
    elapsed = np.where(moving, times_s - impulses.times_s[started], 0.0)
    matrices = dynamics.matrices[impulses.accelerates.astype(int), 0]
    flow = exponentials(matrices[started] * elapsed[:, None, None])
    states = np.where(moving[:, None], (flow @ after[started][..., None])[..., 0], 0.0)
    command = np.where(moving, np.cumsum(impulses.amplitudes)[started], 0.0)
    return History(
        times_s=times_s,
        command=command,
        velocity=command + states[:, dynamics.coupled].sum(axis=1),
        deflection=-states[:, -1],
    )
