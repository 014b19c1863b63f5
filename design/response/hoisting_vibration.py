"""The vibration of a command on a cable that is hoisted, by the kernel of the swing.

Between two changes of the command a lag moves freely, in closed form. Its acceleration times the
kernel is integrated by Gauss and Legendre while the cable is hoisted, and in closed form after it.
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.polynomial.legendre import leggauss

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.lag_motions import free_motions
from design.model.lags import Lag
from design.model.plants.hoisting import Hoisting
from design.model.reference_ramps import reference
from design.response.closed_form import ringing_of_lag, states_of
from design.response.hoisting_kernel import HoistingKernel, hoisting_kernel
from design.types import FloatArray

NODES, WEIGHTS = (1 + leggauss(20)[0]) / 2, leggauss(20)[1] / 2
"""Of the mean from 0 to 1: exact to rounding over a panel."""

PANEL = 2.0
"""Longest panel over the inverse of what turns or decays in it, and the growth of panels [-]."""

AT_REST = 45.0
"""Time constants of its slowest mode after which a lag is at rest: e^-45 [-]."""

Segment = tuple[float, float, int, float, float]
"""Begin and end [s], column of the set, error [-] and rate [1/s] of the lag as it begins."""


def hoisting_vibration(
    command: Impulses, plant: Hoisting, actuator: Actuator, kernel: HoistingKernel | None = None
) -> complex:
    """Return the vibration vector of a command on a cable that is hoisted.

    Parameters
    ----------
    command
        Its times count from the moment that those of the hoisting do [s].
    plant, actuator
        The load on its cable, and a drive without limits to acceleration.
    kernel
        Of the plant; made from it if not given.

    Returns
    -------
    complex
        ``V``, seen at the end of the hoisting or, by the last length, at any later time t as ``V
        exp(s (t - end))``: 1 for a step of an ideal drive at that end. The deflection y over the
        speed obeys ``y' - conj(s) y = -V`` there [-].
    """
    kernel = hoisting_kernel(plant) if kernel is None else kernel
    lags = actuator.accel_lag, actuator.decel_lag
    end_s, pole = plant.end_s, kernel.pole_rad_s
    total = 0j
    for begin, end, column, error, rate in _segments(command, actuator):
        lag = lags[column]
        if lag.first_s == 0 and lag.second_s2 == 0:
            total -= error * complex(kernel.at(np.array([begin]))[0])
            continue
        if begin < end_s:
            total += _during(kernel, plant, lag, begin, min(end, end_s), error, rate)
        for time_s, sign in ((max(begin, end_s), 1.0), (end, -1.0)):
            if end_s <= time_s < math.inf and end > end_s:
                state = _moved(lag, error, rate, np.array([time_s - begin]))
                left = ringing_of_lag(lag, *state, pole)[0]
                total += sign * complex(left * np.exp(-pole * (time_s - end_s)))
    return total


def residual_reference_s(command: Impulses, plant: Hoisting, actuator: Actuator) -> float:
    """Return the moment of which the residual is said.

    Parameters
    ----------
    command, plant, actuator
        As of `hoisting_vibration`.

    Returns
    -------
    float
        The last step, or the end of the hoisting if that is later [s].
    """
    return max(plant.end_s, float(command.times_s[-1]) + actuator.dead_time_s)


def hoisting_residual(command: Impulses, plant: Hoisting, actuator: Actuator) -> float:
    """Return the residual vibration of a command on a cable that is hoisted.

    Parameters
    ----------
    command, plant, actuator
        As of `hoisting_vibration`.

    Returns
    -------
    float
        Amplitude of the free swing on the last length, extrapolated back to the last step or to
        the end of the hoisting, whichever is later, over that of a sudden step of the whole speed
        there, ``v / (w sqrt(1 - z^2))`` [-].
    """
    vector = hoisting_vibration(command, plant, actuator)
    decay = plant.last.mode.pole_rad_s.real
    later_s = residual_reference_s(command, plant, actuator) - plant.end_s
    return abs(vector) * math.exp(decay * later_s)


def _segments(command: Impulses, actuator: Actuator) -> Iterator[Segment]:
    """Yield how each lag moves freely from each change that it follows."""
    changes = reference(command, actuator)
    begins = (changes.times_s + actuator.dead_time_s).tolist()
    columns = np.where(changes.accelerates, 0, 1).tolist()
    if actuator.model == "superposed":
        for begin, column, change in zip(begins, columns, changes.changes.tolist(), strict=True):
            yield begin, math.inf, column, -change, 0.0
        return
    states = states_of(changes, actuator)
    errors = states.errors[0].sum(axis=1) - changes.changes
    rates = states.rates_s[0].sum(axis=1)
    yield from zip(
        begins, [*begins[1:], math.inf], columns, errors.tolist(), rates.tolist(), strict=True
    )


def _moved(
    lag: Lag, error: float, rate_s: float, elapsed_s: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return error and rate of a lag that moves freely."""
    flow = free_motions(np.array(lag.first_s), np.array(lag.second_s2), elapsed_s)
    if lag.second_s2 == 0:
        moved = flow[:, 0, 0] * error
        return moved, -moved / lag.first_s
    corner = lag.corner_rad_s
    moved = flow[:, 0, 0] * error + flow[:, 0, 1] * (rate_s / corner)
    return moved, corner * (flow[:, 1, 0] * error) + flow[:, 1, 1] * rate_s


def _during(
    kernel: HoistingKernel,
    plant: Hoisting,
    lag: Lag,
    begin_s: float,
    end_s: float,
    error: float,
    rate_s: float,
) -> complex:
    """Integrate the kernel times the acceleration of a lag that moves freely."""
    elapsed = _panels(plant, lag, begin_s, end_s)
    lengths = np.diff(elapsed)
    nodes = (elapsed[:-1, None] + lengths[:, None] * NODES).ravel()
    weights = (lengths[:, None] * WEIGHTS).ravel()
    _, rates = _moved(lag, error, rate_s, nodes)
    return complex((weights * rates) @ kernel.at(begin_s + nodes))


def _panels(plant: Hoisting, lag: Lag, begin_s: float, end_s: float) -> FloatArray:
    """Return ends of panels, as times since the begin: short ones first, for the fastest mode."""
    fast, slow = pole_rates(lag)
    highest = math.sqrt(plant.gravity_m_s2 / min(plant.cable_length_m.values))
    longest = PANEL / max(slow, highest)
    last = min(end_s - begin_s, AT_REST / decay_rate(lag))
    ends = [0.0, min(PANEL / fast, longest)]
    while ends[-1] < last:
        ends.append(ends[-1] + min((PANEL - 1) * ends[-1], longest))
    kinks = [time_s - begin_s for time_s in plant.cable_length_m.times_s]
    inside = [one for one in (*ends, *kinks) if 0 < one < last]
    return np.array(sorted({0.0, last, *inside}))


def pole_rates(lag: Lag) -> tuple[float, float]:
    """Return the magnitudes of a lag's poles, the faster first [rad/s].

    The lag is of first or second order.
    """
    if lag.second_s2 == 0:
        return 1 / lag.first_s, 1 / lag.first_s
    corner = lag.corner_rad_s
    damping = lag.first_s * corner / 2
    apart = damping + math.sqrt(max(damping**2 - 1, 0.0)) if damping > 1 else 1.0
    return corner * apart, corner / apart


def decay_rate(lag: Lag) -> float:
    """Return how fast the slowest mode of a lag decays [1/s]."""
    _, slow = pole_rates(lag)
    if lag.second_s2 == 0:
        return slow
    return slow * min(1.0, lag.first_s * lag.corner_rad_s / 2)
