"""Residual vibration from the transfer function at the pole (docs/theory.md, section 1)."""

import math

import numpy as np

from design.actuators import Actuator
from design.errors import InvalidInputError
from design.impulses import Impulses
from design.plants import Mode
from design.types import ComplexArray, FloatArray

SLOWEST = 100.0
"""Largest time constant of a set times the plant's natural frequency [-]."""

RESONANCE = 1e-6
"""Below this ``|1/G|`` at the plant's pole, a set of the actuator rings with the plant [-]."""

SMALLEST_DENOMINATOR = 1e-12
"""Where a sensitivity curve meets a set's own pole, ``|1/G|`` is taken as this [-]."""


def require_workable(mode: Mode, actuator: Actuator) -> None:
    """Raise InvalidInputError if a set of the actuator is out of all proportion to the plant.

    A set with its own pole at the plant's rings with it, and a residual in units of the unshaped
    step means nothing; one a hundred times slower passes so little on that it drowns in rounding.
    """
    for name, lag in (("accel", actuator.accel_lag), ("decel", actuator.decel_lag)):
        slowness = mode.natural_frequency_rad_s * max(lag.first_s, lag.second_s2**0.5)
        if slowness > SLOWEST:
            raise InvalidInputError(
                f"actuator.{name}",
                f"{slowness:.3g} times slower",
                f"at most {SLOWEST:g} times slower than the plant",
            )
        distance = abs(lag.denominator(mode.pole_rad_s))
        if distance < RESONANCE:
            raise InvalidInputError(
                f"actuator.{name}",
                f"1/G = {distance:.1e} there",
                "without a pole at the plant's own, where it rings with it",
            )


def residual_vectors(
    impulses: Impulses, poles_rad_s: ComplexArray, actuator: Actuator
) -> ComplexArray:
    """Return the vibration vector at each pole over that of the unshaped step.

    Parameters
    ----------
    impulses
        The command.
    poles_rad_s
        Upper poles of the modes, shape (m,) [rad/s].
    actuator
        The actuator; superposed steps.

    Returns
    -------
    ComplexArray
        ``sum A_i G_i(s)/G_accel(s) exp(s (t_n - t_i))``, shape (m,) [-]; its magnitude is the
        residual vibration.
    """
    until_last = impulses.times_s[-1] - impulses.times_s
    swings = np.exp(np.multiply.outer(poles_rad_s, until_last))
    return _joined(swings @ _amplitudes_by_set(impulses), poles_rad_s, actuator)


def residuals_of_many(
    times_s: FloatArray, amplitudes: FloatArray, poles_rad_s: ComplexArray, actuator: Actuator
) -> FloatArray:
    """Return the residual vibration of many commands, each at a pole of its own.

    Parameters
    ----------
    times_s
        Times of the steps, shape (m, n) [s].
    amplitudes
        Their heights, the same for all, shape (n,) [-].
    poles_rad_s
        A pole for each command, shape (m,) [rad/s].
    actuator
        The actuator.

    Returns
    -------
    FloatArray
        Residual vibration, shape (m,) [-].
    """
    by_set = _amplitudes_by_set(Impulses(times_s=np.zeros(amplitudes.size), amplitudes=amplitudes))
    swings = np.exp(poles_rad_s[:, None] * (times_s[:, -1:] - times_s))
    return np.abs(_joined(swings @ by_set, poles_rad_s, actuator))


def evenly_spaced_vectors(
    impulses: Impulses, first_rad_s: complex, last_rad_s: complex, points: int, actuator: Actuator
) -> ComplexArray:
    """Return `residual_vectors` at ``points`` poles, evenly spaced on a line.

    The exponentials of an even spacing are products of two short lists, coarse and fine, so that
    ``2 sqrt(points)`` of them do and a matrix product does the rest.
    """
    step = (last_rad_s - first_rad_s) / (points - 1)
    block = math.isqrt(points - 1) + 1
    until_last = impulses.times_s[-1] - impulses.times_s
    coarse = np.exp(np.multiply.outer(until_last, first_rad_s + step * np.arange(0, points, block)))
    fine = np.exp(np.multiply.outer(np.arange(block) * step, until_last))
    by_set = _amplitudes_by_set(impulses)
    summed = fine @ (by_set.T[:, :, None] * coarse)  # (2, block, blocks)
    vectors = summed.transpose(2, 1, 0).reshape(-1, 2)[:points]
    return _joined(vectors, first_rad_s + step * np.arange(points), actuator)


def _amplitudes_by_set(impulses: Impulses) -> FloatArray:
    """Amplitudes as columns, shape (n, 2): of the steps that accelerate, of those that do not."""
    speeding = impulses.accelerates
    columns = np.zeros((speeding.size, 2))
    columns[:, 0] = np.where(speeding, impulses.amplitudes, 0.0)
    columns[:, 1] = impulses.amplitudes - columns[:, 0]
    return columns


def _joined(by_set: ComplexArray, poles_rad_s: ComplexArray, actuator: Actuator) -> ComplexArray:
    """Vectors of both sets, shape (m, 2), summed in units of the acceleration set's step."""
    below = actuator.decel_lag.denominator(poles_rad_s)
    # On the pole of the deceleration set itself the vibration grows without bound: cut, finite.
    below = np.where(np.abs(below) < SMALLEST_DENOMINATOR, SMALLEST_DENOMINATOR, below)
    ratio = actuator.accel_lag.denominator(poles_rad_s) / below
    joined: ComplexArray = by_set[:, 0] + ratio * by_set[:, 1]
    return joined


def residual_vibration(impulses: Impulses, mode: Mode, actuator: Actuator) -> float:
    """Return the residual vibration of a command, a share of one unshaped step [-].

    The amplitude of free vibration, extrapolated back to the last step, over the amplitude that
    an unshaped unit step leaves through the acceleration set. The actuator's own transient is
    not part of it. A whole move (amplitudes sum to 0) is measured by the same unit.

    Examples
    --------
    >>> import numpy as np
    >>> from design.actuators import Ideal
    >>> half_period = Impulses(times_s=np.array([0.0, np.pi]), amplitudes=np.array([0.5, 0.5]))
    >>> residual_vibration(half_period, Mode(natural_frequency_rad_s=1.0), Ideal()) < 1e-15
    True
    """
    return float(residual_curve(impulses, mode, actuator, np.ones(1))[0])


def residual_curve(
    impulses: Impulses, mode: Mode, actuator: Actuator, frequency_ratios: FloatArray
) -> FloatArray:
    """Return the residual vibration with the natural frequency scaled by each ratio.

    Damping ratio and times stay; the pole and the normalising step move along.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The nominal mode and its actuator.
    frequency_ratios
        True frequency over the nominal one, shape (m,), > 0 [-].

    Returns
    -------
    FloatArray
        Residual vibration, shape (m,) [-].
    """
    return np.abs(residual_vectors(impulses, mode.pole_rad_s * frequency_ratios, actuator))
