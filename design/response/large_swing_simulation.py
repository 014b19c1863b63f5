"""Large swings step by step through time: the certificate's own route.

The cable is a unit vector n in the plane of the motion, the load obeys Newton's law, and lags are
states beside it. With A the trolley's acceleration, G free fall and F = G - A,

    n'' = (F - (F . n) n) / L - |n'|^2 n - 2 z w n'

where the cable takes what is along it. All is carried by the method of Dormand and Prince of order
8, through SciPy; closed forms of the drive and the collocation of `large_swing` are not used.
"""

import math
from dataclasses import dataclass

import numpy as np

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.lags import Lag
from design.model.plants.large_swing import LargeSwing
from design.types import ComplexArray, FloatArray

RELATIVE, ABSOLUTE = 1e-12, 1e-14
"""Error of a step: those of some hundred steps stay below 1e-12 of the swing."""

TIME_CONSTANTS = 40.0
"""Of its slowest mode, after which a lag stands at what it follows: e^-40 [-]."""

FREE_FALL = np.array([0.0, -1.0])
"""Its direction, x and upward [-]."""


def simulated_swing(
    command: Impulses, swing: LargeSwing, actuator: Actuator, ratios: FloatArray
) -> ComplexArray:
    """Return the vibration vectors of a command on a load that swings far.

    Parameters
    ----------
    command
        Any steps.
    swing, actuator
        The load at its full speed, and a drive without limits to the acceleration.
    ratios
        Frequencies over the nominal one: cables of ``1 / ratio^2`` of the length, shape (r,) [-].

    Returns
    -------
    ComplexArray
        Referred back to the last step, shape (r,) [rad/s]. Without damping the magnitude is the
        root of twice the energy over the mass and the square of the length.
    """
    crane = swing.crane
    load = _Load(
        lengths=crane.cable_length_m / ratios**2,
        gravity=crane.gravity_m_s2,
        drags=2 * crane.damping_ratio * np.sqrt(crane.gravity_m_s2 / crane.cable_length_m) * ratios,
    )
    state: FloatArray = np.zeros((4, ratios.size))
    state[1] = -1.0
    drive = _Drive(actuator)
    settled_s = swing.settled_s(actuator, float(ratios.max()))
    ends = drive.moments(command, settled_s)
    for begin, end, change, column in ends:
        jump = drive.change(change, column, begin)
        state = load.pushed(state, swing.speed_m_s * jump)
        if end > begin:
            state = _carried(load, drive, state, begin, end, swing.speed_m_s)
    return load.vectors(state, crane.damping_ratio, settled_s)


@dataclass(frozen=True, slots=True, eq=False)
class _Load:
    """Loads on cables of several lengths; their states are n and n', shape (4, r)."""

    lengths: FloatArray
    gravity: float
    drags: FloatArray

    def rates(self, state: FloatArray, accel_m_s2: float) -> FloatArray:
        """Return how the states move."""
        direction, turning = state[:2], state[2:]
        pull = (self.gravity * FREE_FALL - np.array([accel_m_s2, 0.0]))[:, None]
        along = (pull * direction).sum(axis=0)
        spin = (turning * turning).sum(axis=0)
        bent = (pull - along * direction) / self.lengths - spin * direction - self.drags * turning
        return np.concatenate((turning, bent))

    def pushed(self, state: FloatArray, jump_m_s: float) -> FloatArray:
        """Return the states after a jump of the trolley's velocity."""
        direction = state[:2]
        push = np.array([[jump_m_s], [0.0]])
        along = (push * direction).sum(axis=0)
        return np.concatenate((direction, state[2:] - (push - along * direction) / self.lengths))

    def vectors(self, state: FloatArray, damping: float, since_s: float) -> ComplexArray:
        """Return the free swing, referred back by a time."""
        across, up, *turning = state
        rate = -turning[0] * up + turning[1] * across
        half = across / np.sqrt((1 - up) / 2)  # 2 sin(x / 2)
        decays = self.drags / 2
        turns = np.sqrt(self.gravity / self.lengths * (1 - damping**2))
        vectors: ComplexArray = (rate + decays * half + 1j * turns * half) * np.exp(
            decays * since_s
        )
        return vectors


class _Drive:
    """The lags of a drive as states: one chain if they are switched, one for each set if not."""

    def __init__(self, actuator: Actuator) -> None:
        self.lags = (actuator.accel_lag, actuator.decel_lag)
        self.switched = actuator.model == "switched"
        chains = 1 if self.switched else 2
        self.goals = np.zeros(chains)  # What each follows
        self.states = np.zeros((chains, 2))  # Velocity and its rate
        self.rests_s = np.full(chains, -math.inf)  # When each stands
        self.active: list[Lag] = [self.lags[chain] for chain in range(chains)]

    def moments(self, command: Impulses, settled_s: float) -> list[tuple[float, float, float, int]]:
        """Return begin and end [s], change [-] and column of the set of each stretch.

        Stretches begin at steps, and after the last step where a lag comes to stand.
        """
        columns = np.where(command.accelerates, 0, 1).tolist()
        times = command.times_s.tolist()
        last = times[-1] + settled_s
        begins = list(zip(times, command.amplitudes.tolist(), columns, strict=True))
        stands = {at + _rest_s(self.lags[column]) for at, _, column in begins}
        begins += [(at, 0.0, 0) for at in sorted(stands) if times[-1] < at < last]
        ends = [*(one[0] for one in begins[1:]), last]
        return [(begin, end, *rest) for (begin, *rest), end in zip(begins, ends, strict=True)]

    def change(self, change: float, column: int, time_s: float) -> float:
        """Follow a step from now on; return by how much the velocity jumps."""
        if change == 0.0:
            return 0.0
        chain = 0 if self.switched else column
        self.active[chain] = lag = self.lags[column]
        self.goals[chain] += change
        self.rests_s[chain] = time_s + _rest_s(lag)
        if lag.first_s == 0.0 and lag.second_s2 == 0.0:
            jump = float(self.goals[chain] - self.states[chain, 0])
            self.states[chain] = self.goals[chain], 0.0
            return jump
        return 0.0

    def rates(self, states: FloatArray, time_s: float) -> tuple[FloatArray, float]:
        """Return how the states move, and the acceleration; a lag that stands does not."""
        moved = np.zeros_like(states)
        for chain, lag in enumerate(self.active):
            if time_s >= self.rests_s[chain]:
                continue
            velocity, rate = states[chain]
            behind = self.goals[chain] - velocity
            if lag.second_s2 > 0.0:
                moved[chain] = rate, (behind - lag.first_s * rate) / lag.second_s2
            elif lag.first_s > 0.0:
                moved[chain, 0] = behind / lag.first_s
        return moved, float(moved[:, 0].sum())


def _rest_s(lag: Lag) -> float:
    """Return the time after which a lag stands, by the real part of its slowest pole [s]."""
    powers = [lag.second_s2, lag.first_s, 1.0]
    poles = np.roots(np.trim_zeros(powers, "f"))
    return TIME_CONSTANTS / float(-poles.real.max()) if poles.size else 0.0


def _carried(
    load: _Load, drive: _Drive, state: FloatArray, begin_s: float, end_s: float, speed_m_s: float
) -> FloatArray:
    """Carry loads and drive over a stretch without a step."""
    from scipy.integrate import DOP853  # noqa: PLC0415 - takes longer to import than a design

    size = drive.states.size
    middle_s = (begin_s + end_s) / 2  # A lag stands over the whole stretch or moves over it

    def rates(_: float, whole: FloatArray) -> FloatArray:
        moved, accel = drive.rates(whole[:size].reshape(-1, 2), middle_s)
        bent = load.rates(whole[size:].reshape(4, -1), speed_m_s * accel)
        return np.concatenate((moved.ravel(), bent.ravel()))

    start = np.concatenate((drive.states.ravel(), state.ravel()))
    method = DOP853(rates, 0.0, start, end_s - begin_s, rtol=RELATIVE, atol=ABSOLUTE)
    while method.status == "running":
        method.step()
    if method.status != "finished":
        return np.full_like(state, np.nan)  # No number: no claim holds
    drive.states = method.y[:size].reshape(-1, 2)
    carried: FloatArray = method.y[size:].reshape(4, -1)
    return carried
