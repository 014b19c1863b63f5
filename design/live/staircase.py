"""What steps at even times do to drive and modes: linear in the steps, by given sets.

Which set a step is followed by depends on its sign. With the sets given for each step, and the
signs held to them, deflection and vibration are linear in the steps of either model of a drive.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from design.live.state import AxisState
from design.model.actuators.rate_limited import Unlimited
from design.model.lag_motions import free_motions
from design.model.plants.mode import Mode
from design.types import ComplexArray, FloatArray, IntArray

SAMPLES_OF_CELL = 3
"""Moments of a cell at which the deflection is held: between them it exceeds by 1e-4 of itself."""

TAIL_SAMPLES = 24
"""Moments after the last step, while the lags come to rest [-]."""

SETTLED = 8.0
"""Lags are at rest after so many of their time constants, to 3e-4 of a step [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Staircase:
    """An axis in the direction of +x, its drive and modes.

    Attributes
    ----------
    axis
        The axis when the drive first answers, mirrored if it moves in -x.
    actuator, modes
        The drive and the modes, m of them.
    """

    axis: AxisState
    actuator: Unlimited
    modes: tuple[Mode, ...]

    @cached_property
    def lags(self) -> FloatArray:
        """``first, second`` of either set, shape (2, 2) [s], [s^2]."""
        lags = self.actuator.accel_lag, self.actuator.decel_lag
        return np.array([[lag.first_s, lag.second_s2] for lag in lags])

    @property
    def alike(self) -> bool:
        """Whether both sets are the same."""
        return bool(np.all(self.lags[0] == self.lags[1]))

    @property
    def switched(self) -> bool:
        """Whether both sets share one state."""
        return self.actuator.model == "switched"

    @cached_property
    def poles_rad_s(self) -> ComplexArray:
        """Upper poles, shape (m,) [rad/s]."""
        return np.array([mode.pole_rad_s for mode in self.modes])

    @cached_property
    def gains(self) -> ComplexArray:
        """G of either set at the poles, shape (2, m) [-]."""
        s = self.poles_rad_s
        return np.array([1 / (1 + first * s + second * s * s) for first, second in self.lags])

    @property
    def units(self) -> FloatArray:
        """What an unshaped step swings, shape (m,) [-]."""
        units: FloatArray = np.abs(self.gains[0])
        return units

    @property
    def settling_s(self) -> float:
        """How long the drive moves after a step [s]."""
        return SETTLED * float((self.lags[:, 0] + np.sqrt(self.lags[:, 1])).max())

    @property
    def slowest_rad_s(self) -> float:
        """Frequency of the slowest mode [rad/s]."""
        return float(np.abs(self.poles_rad_s).min())

    def of_lags(self, force: int) -> tuple[ComplexArray, ComplexArray]:
        """Return what error and rate of a lag will add to modes, shape (m,) each."""
        gain = self.gains[force]
        return -gain, gain * self.lags[force, 1] * self.poles_rad_s


class Response(NamedTuple):
    """What steps do.

    Attributes
    ----------
    deflection, by_steps
        Deflections of the modes over time without steps, and by each step, shapes (t, m) and
        (t, m, n) [-].
    vibration, vibration_by_steps
        Modal coordinates just after the last step, shapes (m,) and (m, n) [-].
    """

    deflection: FloatArray
    by_steps: FloatArray
    vibration: ComplexArray
    vibration_by_steps: ComplexArray


def response_of(stairs: Staircase, cell_s: float, sets: IntArray) -> Response:
    """Return what steps do, one at each edge of a cell.

    Parameters
    ----------
    stairs
        The axis.
    cell_s
        Time from step to step [s].
    sets
        Which set is in force after each step, 0 accelerates, shape (n,).

    Returns
    -------
    Response
        Over the cells, and until the lags are at rest after them.
    """
    count, axis, lags = sets.size, stairs.axis, stairs.lags
    ends = [stairs.of_lags(force) for force in (0, 1)]
    chains = 1 if stairs.switched else 2
    lag = np.zeros((chains, 2, count + 1))
    lag[:, :, 0] = axis.lag[:chains]
    rings = np.zeros((len(stairs.modes), count + 1), dtype=np.complex128)
    rings[:, 0] = axis.vibration
    force = axis.force
    spans = (cell_s / SAMPLES_OF_CELL, stairs.settling_s / TAIL_SAMPLES)
    flows = [[_flow(lags[one], span) for one in (0, 1)] for span in spans]
    turns = [np.exp(stairs.poles_rad_s * span)[:, None] for span in spans]
    seen = []
    for step, after in enumerate(sets.tolist()):
        chain = 0 if stairs.switched else after
        if stairs.switched and after != force:
            for column in (0, 1):
                rings += np.multiply.outer(
                    ends[after][column] - ends[force][column], lag[0, column]
                )
        force = after
        lag[chain, 0, step + 1] -= 1.0
        rings[:, step + 1] += stairs.gains[after]
        if lags[after, 1] == 0.0:
            lag[chain, 1] = 0.0
            if lags[after, 0] == 0.0:
                lag[chain, 0] = 0.0
        last = step + 1 == count
        if last:
            final = rings.copy()
        for _ in range(TAIL_SAMPLES if last else SAMPLES_OF_CELL):
            for one in range(chains):
                lag[one] = flows[last][force if stairs.switched else one] @ lag[one]
            rings *= turns[last]
            moving = rings.copy()
            for one in range(chains):
                of_error, of_rate = ends[force if stairs.switched else one]
                moving -= np.multiply.outer(of_error, lag[one, 0])
                moving -= np.multiply.outer(of_rate, lag[one, 1])
            seen.append(-moving.imag)
    whole = np.array(seen)
    return Response(whole[:, :, 0], whole[:, :, 1:], final[:, 0], final[:, 1:])


def _flow(lag: FloatArray, span_s: float) -> FloatArray:
    """Return how error and rate of a lag move over a time, shape (2, 2)."""
    first, second = float(lag[0]), float(lag[1])
    corner = second**-0.5 if second > 0 else 1.0
    scale = np.array([1.0, corner])
    moved = free_motions(np.array(first), np.array(second), np.array(span_s))
    flow: FloatArray = moved * scale[:, None] / scale
    return flow
