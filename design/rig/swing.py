r"""Equations of the swinging cable, compiled: one load, or a hook with a load under it.

Cables are unit vectors, x, y and z upward: ``n`` from the trolley to the hook, ``m`` from the hook
to the load. So nothing is singular, at rest or elsewhere. With the trolley's acceleration A, free
fall G, the upper cable's length l(t), the lower one's k, the mass ratio ``u`` of load to hook, and
tensions over the mass of the hook ``p`` and over that of the load ``q``, Newton's law reads

    (l n)'' = G - A - d (l n)' - p n + u q m
    (k m)'' = -d (k m)' + p n - (1 + u) q m

The lengths of ``n`` and ``m`` are 1, so that ``n . n'' = -n'^2``; this gives two linear equations
for the tensions. The drag ``d = 2 z w`` is that of velocities against the trolley: the slowest
mode, of frequency w at the present length, has the damping ratio z. Without a load, at constant
length and without drag, these are Lagrange's equations of the spherical pendulum: (2.1) of Kim
2011, with ``g sin(theta)`` for the ``g sin(phi)`` printed in its second line.

The linear model keeps what is of first order in the small deflections (Kim 2011, 2.7; the second
column of B there should be -1/L, since theta counts toward +y).
"""

import math

from design.rig.plant import DAMPING, GRAVITY, LINEAR, LOWER_LENGTH, MASS_RATIO, lowest_frequency
from design.tables.compiled import compiled, inlined
from design.types import FloatArray

(
    UPPER,  # The unit vector n, three numbers
    _UPPER_Y,
    UPPER_Z,
    UPPER_RATE,  # Its rate [1/s]
    _UPPER_RATE_Y,
    UPPER_RATE_Z,
    LOWER,  # The unit vector m
    _LOWER_Y,
    LOWER_Z,
    LOWER_RATE,
    _LOWER_RATE_Y,
    LOWER_RATE_Z,
    WORK,  # Done by the trolley, the hoist and the drag, per mass of the hook [m^2/s^2]
) = range(13)
STATE_SIZE = 13

_lowest_frequency = compiled(lowest_frequency)


@compiled
def drag(plant: FloatArray, length_m: float) -> float:
    """Return the drag over mass and velocity [1/s].

    Parameters
    ----------
    plant
        Shape (PLANT_SIZE,).
    length_m
        Length of the upper cable [m].

    Returns
    -------
    float
        ``2 z w``, with the frequency of the slowest mode.
    """
    if plant[DAMPING] == 0.0:
        return 0.0
    lowest = _lowest_frequency(plant[GRAVITY], plant[MASS_RATIO], length_m, plant[LOWER_LENGTH])
    return float(2 * plant[DAMPING] * lowest)


@inlined
def _dot(state: FloatArray, one: int, other: int) -> float:
    return float(
        state[one] * state[other]
        + state[one + 1] * state[other + 1]
        + state[one + 2] * state[other + 2]
    )


@compiled
def tensions(
    plant: FloatArray,
    state: FloatArray,
    length_m: float,
    hoist_m_s: float,
    accel_x: float,
    accel_y: float,
) -> tuple[float, float]:
    """Return the tension of each cable over its lower mass [m/s^2].

    Parameters
    ----------
    plant
        Shape (PLANT_SIZE,).
    state
        Shape (STATE_SIZE,).
    length_m, hoist_m_s
        Length of the upper cable, and its rate [m], [m/s].
    accel_x, accel_y
        Acceleration of the trolley [m/s^2].

    Returns
    -------
    tuple of float
        Of the upper cable over the mass of the hook, of the lower one over that of the load; the
        second is 0 without a load. A cable cannot push: negative ones are out of the model.
    """
    spin = length_m * _dot(state, UPPER_RATE, UPPER_RATE)
    pulled = -plant[GRAVITY] * state[UPPER_Z] - accel_x * state[UPPER] - accel_y * state[UPPER + 1]
    pulled += spin - drag(plant, length_m) * hoist_m_s
    if plant[MASS_RATIO] == 0.0:
        return pulled, 0.0
    lower_spin = plant[LOWER_LENGTH] * _dot(state, LOWER_RATE, LOWER_RATE)
    return _solve_tensions(plant[MASS_RATIO], _dot(state, UPPER, LOWER), pulled, lower_spin)


@inlined
def _solve_tensions(ratio: float, cosine: float, upper: float, lower: float) -> tuple[float, float]:
    """Solve ``p - u c q = upper`` and ``-c p + (1 + u) q = lower``."""
    determinant = 1 + ratio * (1 - cosine * cosine)
    return (
        ((1 + ratio) * upper + ratio * cosine * lower) / determinant,
        (lower + cosine * upper) / determinant,
    )


@compiled
def swing_rates(
    plant: FloatArray,
    state: FloatArray,
    length_m: float,
    hoist_m_s: float,
    velocity_x: float,
    velocity_y: float,
    accel_x: float,
    accel_y: float,
    rates: FloatArray,
) -> None:
    """Fill in the rates of a state.

    Parameters
    ----------
    plant
        Shape (PLANT_SIZE,).
    state
        Shape (STATE_SIZE,).
    length_m, hoist_m_s
        Length of the upper cable, and its rate, which is constant [m], [m/s].
    velocity_x, velocity_y, accel_x, accel_y
        Of the trolley [m/s], [m/s^2].
    rates
        Shape (STATE_SIZE,); overwritten.
    """
    for index in range(3):
        rates[UPPER + index] = state[UPPER_RATE + index]
        rates[LOWER + index] = state[LOWER_RATE + index]
    if plant[LINEAR]:
        _linear_rates(plant, state, length_m, hoist_m_s, accel_x, accel_y, rates)
        return
    ratio, lower_m = plant[MASS_RATIO], plant[LOWER_LENGTH]
    slowed = drag(plant, length_m)
    upper, lower = tensions(plant, state, length_m, hoist_m_s, accel_x, accel_y)
    for index in range(3):
        pulled = ratio * lower * state[LOWER + index] - upper * state[UPPER + index]
        pulled -= slowed * (hoist_m_s * state[UPPER + index] + length_m * state[UPPER_RATE + index])
        if index == 0:
            pulled -= accel_x
        elif index == 1:
            pulled -= accel_y
        else:
            pulled -= plant[GRAVITY]
        pulled -= 2 * hoist_m_s * state[UPPER_RATE + index]
        rates[UPPER_RATE + index] = pulled / length_m
    if ratio > 0.0:
        for index in range(3):
            pulled = upper * state[UPPER + index] - (1 + ratio) * lower * state[LOWER + index]
            rates[LOWER_RATE + index] = pulled / lower_m - slowed * state[LOWER_RATE + index]
    else:
        for index in range(3):
            rates[LOWER_RATE + index] = 0.0
    # Power of the trolley's and the hoist's force, and of the drag, over the mass of the hook.
    power = -upper * (velocity_x * state[UPPER] + velocity_y * state[UPPER + 1] + hoist_m_s)
    for index in range(3):
        against = hoist_m_s * state[UPPER + index] + length_m * state[UPPER_RATE + index]
        trolley = velocity_x if index == 0 else (velocity_y if index == 1 else 0.0)
        power -= slowed * against * (trolley + against)
        if ratio > 0.0:
            against += lower_m * state[LOWER_RATE + index]
            power -= ratio * slowed * against * (trolley + against)
    rates[WORK] = power


@compiled
def _linear_rates(
    plant: FloatArray,
    state: FloatArray,
    length_m: float,
    hoist_m_s: float,
    accel_x: float,
    accel_y: float,
    rates: FloatArray,
) -> None:
    ratio, lower_m = plant[MASS_RATIO], plant[LOWER_LENGTH]
    slowed = drag(plant, length_m)
    weight = plant[GRAVITY] - slowed * hoist_m_s
    for index in range(2):
        pulled = -(accel_x if index == 0 else accel_y)
        pulled -= (plant[GRAVITY] + ratio * weight) * state[UPPER + index]
        pulled += ratio * weight * state[LOWER + index]
        pulled -= (2 * hoist_m_s + slowed * length_m) * state[UPPER_RATE + index]
        rates[UPPER_RATE + index] = pulled / length_m
        rates[LOWER_RATE + index] = 0.0
        if ratio > 0.0:
            pulled = (1 + ratio) * weight * (state[UPPER + index] - state[LOWER + index])
            rates[LOWER_RATE + index] = pulled / lower_m - slowed * state[LOWER_RATE + index]
    rates[UPPER_RATE_Z] = rates[LOWER_RATE_Z] = 0.0
    rates[WORK] = 0.0


@compiled
def jump_velocity(
    plant: FloatArray,
    state: FloatArray,
    length_m: float,
    jump_x: float,
    jump_y: float,
    hoist_jump: float,
) -> None:
    """Let the velocities of the trolley and of the hoist jump.

    The tensions are impulses then.

    Parameters
    ----------
    plant
        Shape (PLANT_SIZE,).
    state
        Shape (STATE_SIZE,); its rates change.
    length_m
        Length of the upper cable [m].
    jump_x, jump_y
        Of the trolley's velocity [m/s].
    hoist_jump
        Of the rate of the upper cable's length [m/s].
    """
    ratio = plant[MASS_RATIO]
    if plant[LINEAR]:
        for index in range(2):
            apart = hoist_jump * (state[UPPER + index] - state[LOWER + index])
            pulled = -(jump_x if index == 0 else jump_y)
            if ratio > 0.0:
                pulled += ratio * apart
                state[LOWER_RATE + index] -= (1 + ratio) * apart / plant[LOWER_LENGTH]
            state[UPPER_RATE + index] += pulled / length_m
        return
    along = -jump_x * state[UPPER] - jump_y * state[UPPER + 1]
    upper, lower = along - hoist_jump, 0.0
    if ratio > 0.0:
        cosine = _dot(state, UPPER, LOWER)
        upper, lower = _solve_tensions(ratio, cosine, along - hoist_jump, 0.0)
    for index in range(3):
        pulled = ratio * lower * state[LOWER + index] - (upper + hoist_jump) * state[UPPER + index]
        if index == 0:
            pulled -= jump_x
        elif index == 1:
            pulled -= jump_y
        state[UPPER_RATE + index] += pulled / length_m
        if ratio > 0.0:
            pulled = upper * state[UPPER + index] - (1 + ratio) * lower * state[LOWER + index]
            state[LOWER_RATE + index] += pulled / plant[LOWER_LENGTH]


@compiled
def energy(
    plant: FloatArray,
    state: FloatArray,
    length_m: float,
    hoist_m_s: float,
    velocity_x: float,
    velocity_y: float,
) -> float:
    """Return all energy over the mass of the hook [m^2/s^2].

    Parameters
    ----------
    plant
        Shape (PLANT_SIZE,).
    state
        Shape (STATE_SIZE,).
    length_m, hoist_m_s
        Length of the upper cable, and its rate [m], [m/s].
    velocity_x, velocity_y
        Of the trolley; 0 for the energy seen from it [m/s].

    Returns
    -------
    float
        Of hook and load; heights count from the trolley.
    """
    ratio, lower_m = plant[MASS_RATIO], plant[LOWER_LENGTH]
    height = length_m * state[UPPER_Z]
    total = plant[GRAVITY] * (height + ratio * (height + lower_m * state[LOWER_Z]))
    for index in range(3):
        speed = velocity_x if index == 0 else (velocity_y if index == 1 else 0.0)
        speed += hoist_m_s * state[UPPER + index] + length_m * state[UPPER_RATE + index]
        total += speed * speed / 2
        speed += lower_m * state[LOWER_RATE + index]
        total += ratio * speed * speed / 2
    return float(total)


@compiled
def keep_unit(state: FloatArray, vector: int) -> None:
    """Take rounding out of the direction of a cable.

    Its vector has length 1 again, and its rate is at right angles to it.

    Parameters
    ----------
    state
        Shape (STATE_SIZE,); changed.
    vector
        ``UPPER`` or ``LOWER``; its rate stands three numbers on.
    """
    length = math.sqrt(_dot(state, vector, vector))
    along = _dot(state, vector, vector + 3) / (length * length)
    for index in range(3):
        state[vector + 3 + index] -= along * state[vector + index]
        state[vector + index] /= length
