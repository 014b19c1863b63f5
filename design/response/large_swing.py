"""What remains of large swings, by collocation: many courses of the command side by side.

The state is the angle x of the cable and the load's momentum over its mass along the arc, ``p = L
x' + v cos x`` with v the velocity of the trolley, so that jumps of v need no care:

    x' = (p - v cos x) / L
    p' = -g sin x - (2 z w + v sin(x) / L) (p - v cos x)

The velocity of the drive is a closed form. Panels are collocated at the nodes of Gauss, of order
20, by Picard's iteration.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.large_swing import LargeSwing
from design.response.closed_form import history
from design.response.hoisting_vibration import pole_rates
from design.types import ComplexArray, FloatArray

STAGES = 10
"""Nodes of a panel; order 20."""

NODES, WEIGHTS = (1 + legendre.leggauss(STAGES)[0]) / 2, legendre.leggauss(STAGES)[1] / 2

FIRST, GROWTH = 1.5, 2.0
"""First panel after a change over the time constant of the fastest mode, and of one to the next."""

LAG_PANEL = 3.0
"""Longest panel over the time constant of the slowest mode of a lag [-]."""

TURN_RAD = 0.8
"""Largest turn of a small swing in a panel [rad]."""

ITERATIONS = 60
"""Most iterations of a panel; 15 are usual."""

CONVERGED = 4 * float(np.finfo(np.float64).eps)
"""Change of an iteration over the largest angle that is rounding [-]."""


def _integrals() -> FloatArray:
    """Return the integrals of the nodes' polynomials up to each node, shape (s, s)."""
    values = legendre.legvander(2 * NODES - 1, STAGES - 1)
    rows = np.eye(STAGES)
    upto = [legendre.legval(2 * NODES - 1, legendre.legint(row, lbnd=-1)) / 2 for row in rows]
    matrix: FloatArray = np.stack(upto, axis=1) @ np.linalg.inv(values)
    return matrix


INTEGRALS = _integrals()


@dataclass(frozen=True, slots=True, eq=False)
class SwingEnds:
    """What is left of k courses of a command on r lengths of the cable.

    Attributes
    ----------
    vectors
        Rate and angle, w times, of the free swing that remains, referred back to the last step:
        the magnitude is the root of the energy. Shape (k, r) [rad/s].
    largest_rad
        Largest angle on the way, shape (k, r) [rad].
    """

    vectors: ComplexArray
    largest_rad: FloatArray


def swing_ends(
    swing: LargeSwing,
    actuator: Actuator,
    times_s: FloatArray,
    amplitudes: FloatArray,
    ratios: FloatArray,
) -> SwingEnds:
    """Return what remains of commands on a load that swings far.

    Parameters
    ----------
    swing, actuator
        The load at its full speed, and a drive without limits to the acceleration.
    times_s
        Times of the steps of k courses, ascending, shape (k, n) [s].
    amplitudes
        Of each course, shape (n,) [-].
    ratios
        Frequencies over the nominal one: cables of ``1 / ratio^2`` of the length, shape (r,) [-].

    Returns
    -------
    SwingEnds
        Of each course on each length.

    Raises
    ------
    InvalidInputError
        If the load forgets the swing before the drive is at rest.

    Notes
    -----
    Of a damped load the magnitude of a vector is the root of ``x'^2 + 2 z w x' s + w^2 s^2`` with
    ``s = 2 sin(x/2)``: twice the energy without damping, and of a small swing what dies away as
    ``exp(-z w t)`` and has no ripple.
    """
    crane = swing.crane
    mode = crane.mode
    settle_s = swing.settled_s(actuator, float(ratios.max()))
    lengths = crane.cable_length_m / ratios**2
    frequencies = mode.natural_frequency_rad_s * ratios
    state = _States(
        lengths=lengths[None, :, None],
        gravity=crane.gravity_m_s2,
        drag=(2 * crane.damping_ratio * frequencies)[None, :, None],
        angle=np.zeros((len(times_s), ratios.size)),
        momentum=np.zeros((len(times_s), ratios.size)),
        largest=np.zeros((len(times_s), ratios.size)),
    )
    begins, spans = _panels(times_s, settle_s, actuator, float(frequencies.max()))
    nodes = begins[..., None] + spans[..., None] * NODES
    velocities = np.stack([
        history(Impulses(times_s=one, amplitudes=amplitudes), mode, actuator, at.ravel()).velocity
        for one, at in zip(times_s, nodes, strict=True)
    ]).reshape(nodes.shape)
    for panel in range(spans.shape[1]):
        state.advance(
            spans[:, panel, None, None],
            swing.speed_m_s * velocities[:, panel, None, :],
        )
    return SwingEnds(
        vectors=state.vectors(
            swing.speed_m_s * float(amplitudes.sum()), crane.damping_ratio, frequencies, settle_s
        ),
        largest_rad=state.largest,
    )


def _panels(
    times_s: FloatArray, settle_s: float, actuator: Actuator, fastest_rad_s: float
) -> tuple[FloatArray, FloatArray]:
    """Return begin and length of each panel of each course, shape (k, p) [s].

    Courses have the same panels, as shares of the times between their steps.
    """
    lags = [lag for lag in (actuator.accel_lag, actuator.decel_lag) if lag.first_s + lag.second_s2]
    longest = TURN_RAD / fastest_rad_s
    first = longest
    if lags:
        rates = np.array([pole_rates(lag) for lag in lags])
        first = min(longest, FIRST / float(rates.max()))
        longest = min(longest, LAG_PANEL / float(rates[:, 1].min()))
    ends = np.concatenate((times_s, times_s[:, -1:] + settle_s), axis=1)
    begins, spans = [], []
    for segment in range(ends.shape[1] - 1):
        whole = ends[:, segment + 1] - ends[:, segment]
        if not whole.any():
            continue
        marks = [0.0]
        step = first
        usual = float(whole.max())
        while marks[-1] < usual:
            marks.append(marks[-1] + step)
            step = min(step * GROWTH, longest)
        shares = np.array(marks) / marks[-1]
        begins.append(ends[:, segment, None] + whole[:, None] * shares[:-1])
        spans.append(whole[:, None] * np.diff(shares))
    if not spans:
        return np.zeros((len(times_s), 0)), np.zeros((len(times_s), 0))
    return np.concatenate(begins, axis=1), np.concatenate(spans, axis=1)


@dataclass(slots=True, kw_only=True, eq=False)
class _States:
    """Angles and momenta, shape (k, r), on cables of shape (1, r, 1)."""

    lengths: FloatArray
    gravity: float
    drag: FloatArray
    angle: FloatArray
    momentum: FloatArray
    largest: FloatArray

    def advance(self, span_s: FloatArray, velocity: FloatArray) -> None:
        """Go on over a panel: its length, shape (k, 1, 1), and velocities, shape (k, 1, s)."""
        angle = np.broadcast_to(self.angle[..., None], (*self.angle.shape, STAGES))
        momentum = np.broadcast_to(self.momentum[..., None], angle.shape)
        begun = self.angle[..., None], self.momentum[..., None]
        for _ in range(ITERATIONS):
            turning, pushed = self._rates(angle, momentum, velocity)
            moved = begun[0] + span_s * (turning @ INTEGRALS.T)
            momentum = begun[1] + span_s * (pushed @ INTEGRALS.T)
            change = np.abs(moved - angle).max()
            angle = moved
            if change <= CONVERGED * np.abs(angle).max():
                break
        turning, pushed = self._rates(angle, momentum, velocity)
        self.angle = self.angle + span_s[..., 0] * (turning @ WEIGHTS)
        self.momentum = self.momentum + span_s[..., 0] * (pushed @ WEIGHTS)
        self.largest = np.maximum(self.largest, np.abs(angle).max(axis=-1))

    def _rates(
        self, angle: FloatArray, momentum: FloatArray, velocity: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        sine = np.sin(angle)
        against = momentum - velocity * np.cos(angle)
        turning = against / self.lengths
        return turning, -self.gravity * sine - self.drag * against - velocity * sine * turning

    def vectors(
        self, velocity: float, damping: float, frequencies: FloatArray, settle_s: float
    ) -> ComplexArray:
        """Return the free swing that remains, referred back by the time of settling."""
        rate = (self.momentum - velocity * np.cos(self.angle)) / self.lengths[..., 0]
        chord = 2 * np.sin(self.angle / 2)
        decay = damping * frequencies
        turn = frequencies * math.sqrt(1 - damping**2)
        vectors: ComplexArray = (rate + decay * chord + 1j * turn * chord) * np.exp(
            decay * settle_s
        )
        return vectors
