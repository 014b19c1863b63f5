"""What is left of a limited reference behind two lags, and how it changes with the switches.

With u the unit that a set makes of a slope (`UnequalRampsProblem.gains` g of set k)::

    F = sum over ramps of slope g_k integral of exp(-s t) dt
        + sum over changes of set of exp(-s t) [-(g_n - g_o) e + s (g_n b_n - g_o b_o) v']

where e = v - r and v' are the state of a switched drive that passes from set o to set n, and b the
coefficient of s^2 in 1/G: of ``e + a v' + b v'' = 0``, times exp(-s t) and integrated by parts. Of
order 1 it is the derivative in s. Superposed, no state is passed on.
"""

import math
from dataclasses import dataclass

import numpy as np

from design.formulations.unequal_ramps import UnequalRampsProblem
from design.model.lags import CRITICAL_PHASE
from design.solvers.ramps.course import NODES, SHORT_RAD, WEIGHTS
from design.types import BoolArray, ComplexArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnequalCourse:
    """A course under a command of n switches, and its derivatives in each.

    Attributes
    ----------
    switches
        Phases of the switches, ascending from 0, shape (n,) [rad].
    arrived
        Whether the reference arrives at 0 or full speed before the next switch, shape (n,).
    ends, end_changes
        When each ramp ends, shape (n,), and its derivatives, shape (n, n) [rad], [-].
    levels, level_changes
        Where, shape (n,) and (n, n) [-], [1/rad].
    values, changes
        The functionals, shape (m,) and (m, n).
    """

    switches: FloatArray
    arrived: BoolArray
    ends: FloatArray
    end_changes: FloatArray
    levels: FloatArray
    level_changes: FloatArray
    values: ComplexArray
    changes: ComplexArray

    @property
    def end(self) -> float:
        """When the last ramp ends [rad]."""
        return float(self.ends[-1])


class TwoLags:
    """The functionals of one problem."""

    def __init__(self, problem: UnequalRampsProblem) -> None:
        alike = problem.alike
        self.poles, self.targets = alike.unit_poles, alike.targets
        self.ceiling = problem.ceiling
        self._first = alike.orders == 1
        self._steep = np.array([1 / alike.ramps_rad[0], -1 / alike.ramps_rad[1]])
        lags = zip(problem.first_rad.tolist(), problem.second_rad2.tolist(), strict=True)
        self._motions = [_Motion(*lag) for lag in lags]
        self._gains = problem.gains
        self._switched = problem.switched
        self._fastest = float(np.abs(self.poles).max())
        self._passed = self._passed_on(problem)

    def _passed_on(self, problem: UnequalRampsProblem) -> ComplexArray:
        """Return what passing on e and v' to either set adds, of either derivative.

        Shape (2, 2, 2, m): derivatives, the set that takes over, e or v'.
        """
        (g, rates), s = self._gains, self.poles
        b = problem.second_rad2[:, None]
        parts = np.array([[-g, s * g * b], [-rates, (g + s * rates) * b]]).swapaxes(1, 2)
        taken: ComplexArray = parts - parts[:, ::-1]
        return taken

    @np.errstate(over="ignore", invalid="ignore")
    def of(self, switches: FloatArray, arrived: BoolArray | None = None) -> UnequalCourse:
        """Return the course of a command.

        A step of a search may go so far that an exponential overflows; it is then no number, and
        the step is not taken.

        Parameters
        ----------
        switches
            Phases of the switches, ascending from 0, shape (n,) [rad].
        arrived
            Which ramps are over before the next switch, shape (n,); as it happens if not given.

        Returns
        -------
        UnequalCourse
            With its functionals and all derivatives.
        """
        count = switches.size
        steep = np.tile(self._steep, count // 2 + 1)[:count]
        each, nothing = np.eye(count), np.zeros(count)
        level, level_change = 0.0, nothing
        happens, lasting, ends, end_changes, levels, level_changes = [], [], [], [], [], []
        following = [*switches[1:].tolist(), np.inf]
        for k, (now, slope) in enumerate(zip(switches.tolist(), steep.tolist(), strict=True)):
            goal = self.ceiling * (1 - k % 2)
            length = (goal - level) / slope
            end = now + length
            over = bool(end <= following[k] if arrived is None else arrived[k])
            if over:
                end_change = each[k] - level_change / slope
                level, level_change = goal, nothing
            else:
                end, end_change = following[k], each[k + 1]
                length = end - now
                level += slope * length
                level_change = level_change + slope * (end_change - each[k])
            happens.append(over)
            lasting.append(length)
            ends.append(end)
            end_changes.append(end_change)
            levels.append(level)
            level_changes.append(level_change)
        sets = np.arange(count) % 2
        until, until_changes = np.array(ends), np.array(end_changes)
        # Of a steep ramp the difference of its ends has too few digits.
        lengths = np.array(lasting)
        values = self._ramps(switches, lengths, sets) @ steep
        changes = (self._kernels(until, sets) * steep) @ until_changes
        changes -= self._kernels(switches, sets) * steep
        if self._switched and count > 1:
            passed, passed_changes = self._pass_on(switches, lengths, until_changes, steep, happens)
            values = values + passed
            changes = changes + passed_changes
        return UnequalCourse(
            switches=switches,
            arrived=np.array(happens),
            ends=until,
            end_changes=until_changes,
            levels=np.array(levels),
            level_changes=np.array(level_changes),
            values=values,
            changes=changes,
        )

    def _kernels(self, times: FloatArray, sets: IntArray) -> ComplexArray:
        """Return what a unit slope adds at some times by some sets, shape (m, n)."""
        g, rates = (part[sets].T for part in self._gains)
        turned = np.exp(-np.multiply.outer(self.poles, times))
        kernels: ComplexArray = np.where(self._first[:, None], rates - times * g, g) * turned
        return kernels

    def _ramps(self, starts: FloatArray, lengths: FloatArray, sets: IntArray) -> ComplexArray:
        """Return the integrals of the kernels over the ramps, shape (m, n)."""
        ends = starts + lengths
        ramps: ComplexArray = self._integrals(ends, sets) - self._integrals(starts, sets)
        short = np.abs(lengths) * self._fastest < SHORT_RAD
        if short.any():
            # Of a short ramp the two are nearly alike, and their difference has few digits.
            times = starts[short] + np.multiply.outer(NODES, lengths[short])
            kernels = self._kernels(times.ravel(), np.tile(sets[short], NODES.size))
            kernels = kernels.reshape(-1, *times.shape)
            ramps[:, short] = np.tensordot(WEIGHTS, kernels, axes=(0, 1)) * lengths[short]
        return ramps

    def _integrals(self, times: FloatArray, sets: IntArray) -> ComplexArray:
        """Return antiderivatives of the kernels, shape (m, n)."""
        g, rates = (part[sets].T for part in self._gains)
        still = (self.poles == 0)[:, None]
        s = np.where(still, 1.0, self.poles[:, None])
        turned = np.exp(-self.poles[:, None] * times)
        swinging = np.where(self._first[:, None], (g * (times + 1 / s) - rates) / s, -g / s)
        standing = np.where(self._first[:, None], rates * times - g * times * times / 2, g * times)
        integrals: ComplexArray = np.where(still, standing, swinging * turned)
        return integrals

    def _pass_on(
        self,
        switches: FloatArray,
        lengths: FloatArray,
        end_changes: FloatArray,
        steep: FloatArray,
        arrived: list[bool],
    ) -> tuple[ComplexArray, ComplexArray]:
        """Return what a state that passes from set to set adds, shape (m,), (m, n)."""
        count = switches.size
        states, state_changes = self._states(switches, lengths, end_changes, steep, arrived)
        times = switches[1:]
        turned = np.exp(-np.multiply.outer(self.poles, times))
        # Shape (2, m, n - 1): what a unit of e and of v' adds where a set takes over.
        own, rates = self._passed[:, np.arange(1, count) % 2].transpose(0, 2, 3, 1)
        first = self._first[:, None]
        weights = np.where(first, rates - times * own, own) * turned
        drifts = np.where(first, -own, 0.0) * turned - self.poles[:, None] * weights
        added = np.einsum("cmk,kc->mk", weights, states)
        changes = np.einsum("cmk,kcn->mn", weights, state_changes)
        changes[:, 1:] += np.einsum("cmk,kc->mk", drifts, states)
        return added.sum(axis=1), changes

    def _states(
        self,
        switches: FloatArray,
        lengths: FloatArray,
        end_changes: FloatArray,
        steep: FloatArray,
        arrived: list[bool],
    ) -> tuple[FloatArray, FloatArray]:
        """Return ``e, v'`` at each switch but the first, and their derivatives.

        Shapes (n - 1, 2) and (n - 1, 2, n).
        """
        count = switches.size
        each = np.eye(count)
        state: tuple[float, float] = (0.0, 0.0)
        change: FloatArray = np.zeros((2, count))
        states, changes = [], []
        lasting = lengths.tolist()
        rests = (np.diff(switches) - lengths[:-1]).tolist()
        for k, slope in enumerate(steep[:-1].tolist()):
            lag = self._motions[k % 2]
            begins = lag.rates(state, slope)
            state, change = lag.moved(state, change - np.outer(begins, each[k]), lasting[k], slope)
            change = change + np.outer(lag.rates(state, slope), end_changes[k])
            if arrived[k]:
                change = change - np.outer(lag.rates(state, 0.0), end_changes[k])
                state, change = lag.moved(state, change, rests[k], 0.0)
                change = change + np.outer(lag.rates(state, 0.0), each[k + 1])
            states.append(state)
            changes.append(change)
        return np.array(states), np.array(changes)


class _Motion:
    """How ``e, v'`` of one lag move while the reference has a slope."""

    def __init__(self, first: float, second: float) -> None:
        self._first, self._second = first, second
        self._corner = second**-0.5 if second > 0 else 0.0
        self._damping = first * self._corner / 2
        self._root = math.sqrt(abs(self._damping**2 - 1))

    def rates(self, state: tuple[float, float], slope: float) -> tuple[float, float]:
        """Return the rates of e and v'."""
        error, rate = state
        if self._second > 0:
            return rate - slope, -(error + self._first * rate) / self._second
        return (-error / self._first - slope, 0.0) if self._first > 0 else (0.0, 0.0)

    def moved(
        self, state: tuple[float, float], change: FloatArray, elapsed: float, slope: float
    ) -> tuple[tuple[float, float], FloatArray]:
        """Return state and derivatives after some time."""
        (a, b), (c, d) = self._flow(max(elapsed, 0.0))
        # In a ramp that lasts e comes to -a slope, and v' to the slope.
        last = (-self._first * slope, slope if self._second > 0 else 0.0)
        error, rate = state[0] - last[0], state[1] - last[1]
        after = last[0] + a * error + b * rate, last[1] + c * error + d * rate
        return after, np.array([[a, b], [c, d]]) @ change

    def _flow(self, elapsed: float) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the free motion, as in `free_motions`, of e and v'."""
        if self._second == 0:
            kept = math.exp(-elapsed / self._first) if self._first > 0 else 0.0
            return (kept, 0.0), (0.0, 0.0)
        phase = self._corner * elapsed
        turn = self._root * phase
        if turn < CRITICAL_PHASE:
            even = math.exp(-self._damping * phase)
            odd = even * phase
        elif self._damping < 1:
            decay = math.exp(-self._damping * phase)
            even, odd = decay * math.cos(turn), decay * math.sin(turn) / self._root
        else:
            slow = math.exp(-phase / (self._damping + self._root))
            apart = -math.expm1(-2 * turn)
            even, odd = slow * (1 - apart / 2), slow * apart / (2 * self._root)
        sided = self._damping * odd
        return (even + sided, odd / self._corner), (-odd * self._corner, even - sided)
