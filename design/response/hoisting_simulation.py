"""A swing on a cable that is hoisted, step by step through time: the certificate's own route.

The state of the plant is the deflection y of the load and its velocity p, of the trolley that of
its speed, ``y' = p - v`` and ``p' = -g y / L - c x'`` with the angle ``x = y / L`` and ``c = 2 z
sqrt(g L)``: the cable pulls the load, whatever the trolley does. At a kink of the length p changes
by that of L' times x. Lags are states beside it. All is carried by collocation at the nodes of
Radau (IIA), of order 15, forward in time; the closed forms and the kernel are not used.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.lags import Lag
from design.model.plants.hoisting import Hoisting
from design.response.closed_form import History
from design.types import ComplexArray, FloatArray

STAGES = 8
"""Nodes of a step; order 15."""

FIRST = 0.4
"""First step after a change, over the time constant of the fastest mode [-]."""

GROWTH = 1.35
"""Of one step to the next after a change [-]."""

TURN_RAD = 0.7
"""Largest turn of the swing, or decay of the slowest mode of a lag, in a step [rad]."""

MAX_WOUND = 0.15
"""Largest share of the cable that is wound in a step [-]."""

AT_REST = 45.0
"""Time constants of its slowest mode after which a lag is at rest: e^-45 [-]."""

AFTERWARDS_RAD = 0.1
"""Turn of the swing after the last change, at which what remains is taken [rad]."""

BLOCK = 256
"""Steps whose flows are computed at a time."""


def _radau() -> tuple[FloatArray, FloatArray]:
    """Return nodes on (0, 1] and the integrals of the nodes' polynomials up to each."""
    highest = np.zeros(STAGES + 1)
    highest[-1], highest[-2] = 1.0, -1.0
    nodes = np.sort(legendre.legroots(highest).real)
    nodes[-1] = 1.0
    for _ in range(3):  # Newton: the roots of a companion matrix lack two digits
        slope = legendre.legval(nodes[:-1], legendre.legder(highest))
        nodes[:-1] -= legendre.legval(nodes[:-1], highest) / slope
    values = legendre.legvander(nodes, STAGES - 1)
    integrals = np.stack(
        [legendre.legval(nodes, legendre.legint(row, lbnd=-1)) / 2 for row in np.eye(STAGES)],
        axis=1,
    )
    return (1 + nodes) / 2, integrals @ np.linalg.inv(values)


NODES, INTEGRALS = _radau()


@dataclass(frozen=True, slots=True, eq=False)
class _Lags:
    """The lags of a drive as states: of a switched one that of the set in force."""

    blocks: tuple[FloatArray, FloatArray]  # Matrices of both sets, accel and decel, (m, m) each
    switched: bool

    @classmethod
    def of(cls, actuator: Actuator) -> "_Lags":
        """Return those of a drive."""
        blocks = _block(actuator.accel_lag), _block(actuator.decel_lag)
        return cls(blocks, actuator.model == "switched")

    @property
    def size(self) -> int:
        """How many states they have."""
        orders = [len(block) for block in self.blocks]
        return max(orders) if self.switched else sum(orders)

    def matrix(self, column: int) -> FloatArray:
        """Return how the states move while a set is in force."""
        whole = np.zeros((self.size, self.size))
        blocks = [self.blocks[column]] if self.switched else self.blocks
        first = 0
        for block in blocks:
            last = first + len(block)
            whole[first:last, first:last] = block
            first = last
        return whole

    def changed(self, states: FloatArray, column: int, change: float) -> FloatArray:
        """Return the states after a change of the command; a lag of no order is at rest."""
        moved = states.copy()
        order = len(self.blocks[column])
        first = 0 if self.switched or column == 0 else len(self.blocks[0])
        if self.switched:
            moved[order:] = 0.0
        if order:
            moved[first] -= change
        return moved

    @property
    def velocity(self) -> FloatArray:
        """Which states are errors of the velocity, 1, and which rates, 0."""
        told = np.zeros(self.size)
        told[0:1] = 1.0
        if not self.switched and len(self.blocks[1]):
            told[len(self.blocks[0])] = 1.0
        return told


def _block(lag: Lag) -> FloatArray:
    """Return the matrix of ``[v - r, v']`` of a lag, by its order."""
    if lag.second_s2 > 0:
        return np.array([[0.0, 1.0], [-1 / lag.second_s2, -lag.first_s / lag.second_s2]])
    return np.array([[-1 / lag.first_s]]) if lag.first_s > 0 else np.zeros((0, 0))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Stretch:
    """A time without change of the command and without kink of the length."""

    begin_s: float
    end_s: float
    since_change_s: float  # Time from the latest change of the command to the begin [s]
    level: float  # Of the command [-]
    column: int  # Set in force
    change: float  # Of the command at the begin; 0 at a kink [-]
    length_m: float  # At the begin
    rate_m_s: float  # Of the length


def _stretches(
    command: Impulses, plant: Hoisting, actuator: Actuator, end_s: float
) -> list[_Stretch]:
    """Return the stretches of a command from its first step to an end."""
    times = (command.times_s + actuator.dead_time_s).tolist()
    columns = np.where(command.accelerates, 0, 1).tolist()
    changes: dict[float, tuple[float, int]] = {}
    for time_s, change, column in zip(times, command.amplitudes.tolist(), columns, strict=True):
        changes[time_s] = changes.get(time_s, (0.0, 0))[0] + change, column
    kinks = [one for one in plant.cable_length_m.times_s if times[0] < one < end_s]
    stretches, level, column, latest = [], 0.0, 0, times[0]
    for begin, end in pairwise(sorted({*times, *kinks, end_s})):
        change, column = changes.get(begin, (0.0, column))
        level += change
        latest = begin if begin in changes else latest
        ends_m = plant.cable_length_m.at(begin), plant.cable_length_m.at(end)
        stretches.append(
            _Stretch(
                begin_s=begin,
                end_s=end,
                since_change_s=begin - latest,
                level=level,
                column=column,
                change=change,
                length_m=ends_m[0],
                rate_m_s=(ends_m[1] - ends_m[0]) / (end - begin),
            )
        )
    return stretches


def _steps(stretch: _Stretch, lags: _Lags, gravity_m_s2: float, at_s: FloatArray) -> FloatArray:
    """Return the ends of the steps of a stretch, its begin and the times asked for among them."""
    matrix = lags.matrix(stretch.column)
    poles = np.linalg.eigvals(matrix) if lags.size else np.zeros(0)
    poles = poles[poles != 0]  # a set of lower order leaves the other's states at rest
    lasting_s = stretch.end_s - stretch.begin_s
    shortest_m = min(stretch.length_m, stretch.length_m + stretch.rate_m_s * lasting_s)
    turns = float(np.sqrt(gravity_m_s2 / shortest_m)) / TURN_RAD
    winds = abs(stretch.rate_m_s) / shortest_m / MAX_WOUND
    longest = step = 1 / max(turns, winds, 1 / lasting_s)
    while_moving, moves_until_s = longest, stretch.begin_s
    if poles.size:
        step = max(FIRST / float(np.abs(poles).max()), (1 - 1 / GROWTH) * stretch.since_change_s)
        while_moving = min(longest, TURN_RAD / float(np.abs(poles).min()))
        moves_until_s += AT_REST / float(-poles.real.max()) - stretch.since_change_s
    ends = [stretch.begin_s]
    while ends[-1] < stretch.end_s:
        ends.append(ends[-1] + min(step, while_moving if ends[-1] < moves_until_s else longest))
        step *= GROWTH
    ends[-1] = stretch.end_s
    within = at_s[(at_s > stretch.begin_s) & (at_s < stretch.end_s)]
    return np.union1d(ends, within)


def _flows(
    ends_s: FloatArray, stretch: _Stretch, lags: _Lags, plant: Hoisting, ratio: float
) -> FloatArray:
    """Return the matrices of all steps of a stretch, of ``[lags, y, p, 1]``."""
    found = []
    for first in range(0, ends_s.size - 1, BLOCK):
        ends = ends_s[first : first + BLOCK + 1]
        steps = np.diff(ends)
        nodes = ends[:-1, None] + steps[:, None] * NODES
        matrices = _matrices(nodes, stretch, lags, plant, ratio)
        many, _, size, _ = matrices.shape
        # X_i = x + h sum_j a_ij A_j X_j at the nodes, for unit states x; the last node is the end.
        pulls = np.einsum("n,ij,njkl->nikjl", steps, INTEGRALS, matrices)
        coupled = np.eye(STAGES * size) - pulls.reshape(many, STAGES * size, STAGES * size)
        units = np.broadcast_to(np.tile(np.eye(size), (STAGES, 1)), (many, STAGES * size, size))
        found.append(np.linalg.solve(coupled, units)[:, -size:])
    return np.concatenate(found)


def _matrices(
    times_s: FloatArray, stretch: _Stretch, lags: _Lags, plant: Hoisting, ratio: float
) -> FloatArray:
    """Return the matrix of ``[lags, y, p, 1]`` at times, shape (..., n, n)."""
    order = lags.size
    y, p, one = order, order + 1, order + 2
    gravity = ratio**2 * plant.gravity_m_s2
    lengths = stretch.length_m + stretch.rate_m_s * (times_s - stretch.begin_s)
    matrix = np.zeros((*times_s.shape, order + 3, order + 3))
    matrix[..., :order, :order] = lags.matrix(stretch.column)
    matrix[..., y, p] = 1.0
    matrix[..., y, :order] = -lags.velocity
    matrix[..., y, one] = -stretch.level
    # c x' = 2 z sqrt(g / L) (y' - L' y / L)
    drag = 2 * plant.damping_ratio * np.sqrt(gravity / lengths)
    matrix[..., p, :] = -drag[..., None] * matrix[..., y, :]
    matrix[..., p, y] += (drag * stretch.rate_m_s - gravity) / lengths
    return matrix


@dataclass(frozen=True, slots=True, eq=False)
class _Played:
    """States ``[lags, y, p]`` at the ends of all steps."""

    times_s: FloatArray  # Shape (n,); a change or a kink has been made where one is [s]
    states: FloatArray  # Shape (n, order + 2)
    levels: FloatArray  # Of the command, shape (n,) [-]
    last: _Stretch


def _play(
    command: Impulses,
    plant: Hoisting,
    actuator: Actuator,
    ratio: float,
    end_s: float,
    at_s: FloatArray,
) -> _Played:
    """Carry the states from the first step to an end."""
    lags = _Lags.of(actuator)
    y, p = lags.size, lags.size + 1
    state, rate_m_s = np.zeros(lags.size + 2), 0.0
    times, states, levels = [], [], []
    stretches = _stretches(command, plant, actuator, end_s)
    for stretch in stretches:
        if stretch.change:
            state[: lags.size] = lags.changed(state[: lags.size], stretch.column, stretch.change)
        state[p] += (stretch.rate_m_s - rate_m_s) * state[y] / stretch.length_m
        rate_m_s = stretch.rate_m_s
        ends = _steps(stretch, lags, ratio**2 * plant.gravity_m_s2, at_s)
        moving = np.append(state, 1.0)
        course = [state]
        for flow in _flows(ends, stretch, lags, plant, ratio):
            moving = flow @ moving
            course.append(moving[:-1])
        state = course[-1].copy()
        keep = len(course) - (0 if stretch is stretches[-1] else 1)
        times.append(ends[:keep])
        states.append(np.array(course[:keep]))
        levels.append(np.full(keep, stretch.level))
    return _Played(
        np.concatenate(times), np.concatenate(states), np.concatenate(levels), stretches[-1]
    )


def simulated_vibration(
    command: Impulses, plant: Hoisting, actuator: Actuator, ratio: float = 1.0
) -> complex:
    """Return the vibration on a cable that is hoisted, step by step.

    The second route to `design.response.hoisting_vibration`, but seen at another moment.

    Parameters
    ----------
    command
        Its times count from the moment that those of the hoisting do [s].
    plant, actuator
        The load on its cable, and a drive without limits to acceleration.
    ratio
        All frequencies over their nominal ones, > 0 [-].

    Returns
    -------
    complex
        ``-(y' - conj(s) y)`` at the last step or the end of the hoisting, whichever is later, with
        what the lags will still leave added [-].
    """
    last_s = max(plant.end_s, float(command.times_s[-1]) + actuator.dead_time_s)
    pole = ratio * plant.last.mode.pole_rad_s
    # A moment later the cable keeps its length, and no change is to come.
    after_s = AFTERWARDS_RAD / abs(pole)
    end_s = last_s + after_s
    played = _play(command, plant, actuator, ratio, end_s, np.zeros(0))
    lags = _Lags.of(actuator)
    order = lags.size
    matrix = _matrices(np.array(end_s), played.last, lags, plant, ratio)[:-1, :-1]
    vector: ComplexArray = np.empty(order + 2, dtype=np.complex128)
    vector[order:] = pole.conjugate(), -1.0
    # The left eigenvector of the mode: what a lag will still leave is in it.
    shifted = matrix[:order, :order].T - pole * np.eye(order)
    vector[:order] = np.linalg.solve(shifted, -(vector[order:] @ matrix[order:, :order]))
    state = played.states[-1].copy()
    state[order + 1] -= played.levels[-1]
    return complex(vector @ state * np.exp(-pole * (end_s - last_s)))


def hoisting_history(
    command: Impulses, plant: Hoisting, actuator: Actuator, times_s: FloatArray
) -> History:
    """Return the time history of a command on a cable that is hoisted.

    Parameters
    ----------
    command, plant, actuator
        As of `simulated_vibration`.
    times_s
        Times, shape (n,), not decreasing [s]; before the first step all is at rest.

    Returns
    -------
    History
        All of shape (n,); the deflection over the full speed in seconds, not times a frequency.
    """
    begin_s = float(command.times_s[0]) + actuator.dead_time_s
    end_s = max(float(times_s[-1]), float(command.times_s[-1]) + actuator.dead_time_s, plant.end_s)
    end_s += AFTERWARDS_RAD / plant.last.mode.natural_frequency_rad_s
    played = _play(command, plant, actuator, 1.0, end_s, times_s)
    lags = _Lags.of(actuator)
    found = np.maximum(np.searchsorted(played.times_s, times_s, side="right") - 1, 0)
    moving = times_s >= begin_s
    states = played.states[found]
    levels = np.concatenate(([0.0], np.cumsum(command.amplitudes)))
    return History(
        times_s=times_s,
        command=levels[np.searchsorted(command.times_s, times_s, side="right")],
        velocity=np.where(
            moving, played.levels[found] + states[:, : lags.size] @ lags.velocity, 0.0
        ),
        deflection=np.where(moving, states[:, lags.size], 0.0),
    )
