"""The largest deflection under a plan, from the closed form of each stretch of it."""

import math
from dataclasses import replace

import numpy as np

from design.live.machine import IDEAL_ROW, drive_row, mode_rows
from design.live.propagation import Rows, carry
from design.live.staircase import Staircase
from design.live.state import AxisState
from design.model.actuators.rate_limited import Unlimited
from design.model.lag_motions import free_motions
from design.model.plants.mode import Mode
from design.types import FloatArray

TURN = 0.05
"""Turn of the quickest mode from sample to sample; a parabola through three of them is exact to
1e-7 of the deflection [rad]."""

PARTS_OF_LAG = 12
"""Samples in the shortest time constant of a lag [-]."""

MAX_SAMPLES = 4000
"""Samples of one stretch."""


def peak_deflection(actuator: Unlimited, modes: tuple[Mode, ...], axis: AxisState) -> float:
    """Return the largest deflection of an axis from now on under its plan.

    Parameters
    ----------
    actuator, modes
        The drive, and the modes of the plant.
    axis
        The axis when the drive first answers. Its plan is when the drive answers to it.

    Returns
    -------
    float
        Over that of an unshaped step: the worst mode's [-].
    """
    drive = drive_row(actuator)
    rows = Rows(drive, mode_rows(modes, drive), mode_rows(modes, IDEAL_ROW), 0.0)
    stairs = Staircase(axis=axis, actuator=actuator, modes=modes)
    aftermath_s = stairs.settling_s + math.tau / stairs.slowest_rad_s
    begins = [axis.time_s, *axis.plan.times_s]
    largest = 0.0
    for begin, end in zip(begins, [*axis.plan.times_s, begins[-1] + aftermath_s], strict=True):
        axis = carry(rows, axis, max(begin, axis.time_s))
        if end > begin:
            values = np.abs(_deflections(replace(stairs, axis=axis), end - begin)) / stairs.units
            largest = max(largest, float(_vertices(values).max()))
    return largest


def _deflections(stairs: Staircase, span_s: float) -> FloatArray:
    """Return deflections over a stretch without switches, shape (t, m)."""
    axis, lags = stairs.axis, stairs.lags
    step_s = TURN / float(np.abs(stairs.poles_rad_s).max())
    constants = np.where(lags[:, 1] > 0, np.sqrt(lags[:, 1]), lags[:, 0])
    if np.any(constants > 0):
        step_s = min(step_s, float(constants[constants > 0].min()) / PARTS_OF_LAG)
    times = np.linspace(0.0, span_s, min(math.ceil(span_s / step_s) + 2, MAX_SAMPLES))
    moving = np.array(axis.vibration) * np.exp(np.multiply.outer(times, stairs.poles_rad_s))
    for chain in range(1 if stairs.switched else 2):
        force = axis.force if stairs.switched else chain
        first, second = lags[force]
        corner = second**-0.5 if second > 0 else 1.0
        flow = free_motions(np.array(first), np.array(second), times)
        state = flow @ np.array([axis.lag[chain, 0], axis.lag[chain, 1] / corner])
        of_error, of_rate = stairs.of_lags(force)
        moving -= np.multiply.outer(state[:, 0], of_error)
        moving -= np.multiply.outer(corner * state[:, 1], of_rate)
    return -moving.imag


def _vertices(values: FloatArray) -> FloatArray:
    """Return values, those that are largest beside their neighbours at their parabola's vertex."""
    before, here, after = values[:-2], values[1:-1], values[2:]
    bend = before - 2 * here + after
    is_peak = (here >= before) & (here >= after) & (bend < 0)
    gained = (after - before) ** 2 / np.where(is_peak, -8 * bend, 1.0)
    return np.concatenate((values, np.where(is_peak, here + gained, 0.0)))
