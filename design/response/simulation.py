"""Response of actuator and mode by matrix exponential: a second opinion on the closed forms.

The state is the distance to the equilibrium of the present command::

    [accel lag (0-2 states), decel lag (0-2 states), q, q'/w],   q'' + 2 z w q' + w^2 q = w^2 v

so that it is free between the steps, ``e(t + d) = expm(A d) e(t)``, and jumps by J at each; a ramp
of the reference takes J off at a constant rate, one more column of A. The
deflection of the payload under the acceleration v' is ``-q'/w^2``: driving q by v instead keeps
every jump finite, an ideal actuator's included.
"""

from dataclasses import dataclass

import numpy as np

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.lags import Lag
from design.model.ramps import Reference
from design.model.reference_ramps import reference
from design.response.matrix_exponential import exponentials
from design.response.one_state import one_state
from design.response.ramp_flows import whole_ramp_flows
from design.types import ComplexArray, FloatArray

UNIT_STEP = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))


def _lag_matrix(lag: Lag, scale_rad_s: float) -> FloatArray:
    """State matrix of a lag's error ``[v - u, v' / scale]``, shape (order, order)."""
    if lag.second_s2 > 0:
        squared = 1 / lag.second_s2
        return np.array([[0.0, scale_rad_s], [-squared / scale_rad_s, -lag.first_s * squared]])
    if lag.first_s > 0:
        return np.array([[-1 / lag.first_s]])
    return np.zeros((0, 0))


@dataclass(frozen=True, slots=True, eq=False)
class Dynamics:
    """State matrices of one actuator on modes of several frequencies, f of them, n states each.

    Sets are numbered 0, in force after a step that decreases the command's magnitude, and 1. For
    superposed steps both lags stand side by side in one matrix, whichever set is in force; a
    switched actuator has one state and a matrix for either set.
    """

    matrices: FloatArray  # (2, f, n, n)
    jumps: FloatArray  # (2, n): what a unit step into a set takes off the state
    kept: FloatArray  # (2, n): 0 for the states that an ideal set brings to rest at once
    coupled: list[int]  # states that are velocity errors


def dynamics_of(
    actuator: Actuator, frequencies_rad_s: FloatArray, damping_ratio: float | FloatArray
) -> Dynamics:
    """Return the state matrices of an actuator on modes.

    Parameters
    ----------
    actuator, frequencies_rad_s, damping_ratio
        As of `ringing_after`.

    Returns
    -------
    Dynamics
        For either set in force.
    """
    both = (actuator.decel_lag, actuator.accel_lag)
    scale = max(lag.corner_rad_s for lag in both)
    blocks = [_lag_matrix(lag, scale) for lag in both]
    arrange = one_state if actuator.model == "switched" else _side_by_side
    lags, coupled, jumps, kept = arrange(blocks)
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
    return Dynamics(np.broadcast_to(matrices, (2, *matrices.shape[1:])), taken, left, coupled)


def _side_by_side(blocks: list[FloatArray]) -> tuple[FloatArray, list[int], FloatArray, FloatArray]:
    """Lag states for superposed steps: each set has its own, excited by its own steps."""
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


def states_at_changes(
    changes: Reference, dynamics: Dynamics, initial: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return error states as each change begins, and where its ramp ends.

    Parameters
    ----------
    changes, dynamics
        Changes of the reference; matrices of actuator and modes.
    initial
        As of `ringing_after`.

    Returns
    -------
    tuple of FloatArray
        Shape (changes, f, n) each, in the change's own set; of a step the second is just after it.
    """
    held = changes.times_s[1:] - changes.times_s[:-1] - changes.ramps_s[:-1]
    sets = changes.accelerates.astype(int)
    carried = exponentials(dynamics.matrices[sets[:-1]] * held[:, None, None, None])
    kept = dynamics.kept[sets]
    jumps = changes.changes[:, None] * dynamics.jumps[sets] * kept
    ramps = (
        whole_ramp_flows(dynamics.matrices[sets], changes, jumps) if changes.ramps_s.any() else ()
    )
    before = np.zeros((sets.size, *dynamics.matrices.shape[1:3]))
    if initial is not None:
        before[0, :, -2:] = initial
    after = np.empty_like(before)
    for index in range(sets.size):
        if index > 0:
            before[index] = (carried[index - 1] @ after[index - 1][..., None])[..., 0] * kept[index]
        if ramps:
            flows, pulls = ramps
            after[index] = (flows[index] @ before[index][..., None])[..., 0] + pulls[index]
        else:
            after[index] = before[index] - jumps[index]
    return before, after


def ringing_after(
    impulses: Impulses,
    actuator: Actuator,
    frequencies_rad_s: FloatArray,
    damping_ratio: float | FloatArray,
    initial: FloatArray | None = None,
) -> tuple[ComplexArray, ComplexArray, float]:
    """Return the vibration that a command and an unshaped step leave.

    Parameters
    ----------
    impulses, actuator
        The command, and the actuator between command and mode.
    frequencies_rad_s, damping_ratio
        Of the mode, shape (f,) each, or one damping ratio for all [rad/s], [-].
    initial
        State ``q, q'/w`` just before the first step, shape (f, 2); at rest if not given.

    Returns
    -------
    tuple of ComplexArray, ComplexArray and float
        Modal coordinates, shape (f,) each, of the command when its last step or ramp is over, and
        of a unit step then without limits, 1 through an ideal actuator; from the first step until
        then [s]. The actuator's own transient is projected out by the left eigenvector of the mode
        in the coupled system.
    """
    dynamics = dynamics_of(actuator, frequencies_rad_s, damping_ratio)
    unit_poles = np.broadcast_to(
        -damping_ratio + 1j * np.sqrt(1 - np.square(damping_ratio)), frequencies_rad_s.shape
    )
    rising = _left_eigenvectors(dynamics, 1, frequencies_rad_s, unit_poles)
    last = rising
    changes = reference(impulses, actuator)
    if not changes.accelerates[-1]:
        last = _left_eigenvectors(dynamics, 0, frequencies_rad_s, unit_poles)
    final = states_at_changes(changes, dynamics, initial)[1][-1]
    moving_s = float(changes.times_s[-1] + changes.ramps_s[-1] - changes.times_s[0])
    unit = rising @ (-dynamics.jumps[1] * dynamics.kept[1])
    return (last * final).sum(axis=1), unit, moving_s


def _left_eigenvectors(
    dynamics: Dynamics, force: int, frequencies_rad_s: FloatArray, unit_poles: ComplexArray
) -> ComplexArray:
    """Left eigenvectors of the mode in the coupled system of one set, shape (f, n).

    ``l A = s l`` with ``l = [l_lags, -1, s/w]``, from the bottom block upward.
    """
    matrices = dynamics.matrices[force]
    size = matrices.shape[-1]
    lags = size - 2
    left = np.empty((frequencies_rad_s.size, size), dtype=np.complex128)
    left[:, -2] = -1.0
    left[:, -1] = unit_poles
    if lags:
        poles = (unit_poles * frequencies_rad_s)[:, None, None]
        shifted = poles * np.eye(lags) - matrices[:, :lags, :lags].swapaxes(1, 2)
        drive = matrices[:, -1, :lags] * unit_poles[:, None]
        # A set that brings a lag to rest at once: nothing of it rings.
        left[:, :lags] = (
            np.linalg.solve(shifted, drive[..., None])[..., 0] * dynamics.kept[force, :lags]
        )
    return left
