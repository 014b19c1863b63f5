"""What is left of a large swing, and a second opinion on it, step by step through time."""

import numpy as np

from design.analysis.certificate import Certificate, Claim
from design.analysis.judge import Judgement
from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.large_swing import LargeSwing, SwingFigures
from design.response.large_swing import swing_ends
from design.response.large_swing_simulation import simulated_swing
from design.types import FloatArray

METHOD = (
    "nonlinear crane at {speed:g} m/s: lags and the cable's unit vector carried through time by "
    "the method of Dormand and Prince of order 8; derivatives from the same at lengths beside its "
    "own"
)

RATIO_STEP = 1e-3
RATIO_STEPS: FloatArray = RATIO_STEP * np.array([0.0, -2.0, -1.0, 1.0, 2.0])
RATIO_WEIGHTS: FloatArray = np.array([0.0, 1.0, -8.0, 8.0, -1.0]) / (12 * RATIO_STEP)
"""Central difference of order four in ln w: off by some 1e-9 of a step [-]."""

UNSHAPED = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))


def large_swing_residuals(
    command: Impulses, swing: LargeSwing, actuator: Actuator, ratios: FloatArray
) -> FloatArray:
    """Return the residual vibration of a command on a load that swings far.

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
    FloatArray
        Root of the energy of the free swing over that after an unshaped step on the same cable,
        shape (r,) [-]. Of a damped load both are referred back to their last step.

    Raises
    ------
    InvalidInputError
        If the load forgets the swing before the drive is at rest.
    """
    left, unshaped = (
        swing_ends(swing, actuator, one.times_s[None], one.amplitudes, ratios).vectors[0]
        for one in (command, UNSHAPED)
    )
    residuals: FloatArray = np.abs(left) / np.abs(unshaped)
    return residuals


def certify_large_swing(
    command: Impulses, swing: LargeSwing, actuator: Actuator, promises: tuple[Promise, ...]
) -> Certificate:
    """Recompute what a shaper claims of a load that swings far.

    Parameters
    ----------
    command, swing, actuator
        As of `large_swing_residuals`.
    promises
        A residual and a slope at most. The slope is the change of the vibration vector per
        relative one of the frequency, by the length of the cable.

    Returns
    -------
    Certificate
        A claim for each promise, in their order; one that fails is in it, no error.

    Raises
    ------
    InvalidInputError
        If the load forgets the swing before the drive is at rest.
    """
    slopes = any(promise.quantity == "slope" for promise in promises)
    ratios = np.exp(RATIO_STEPS if slopes else RATIO_STEPS[:1])
    unshaped = abs(simulated_swing(UNSHAPED, swing, actuator, ratios[:1])[0])
    vectors = simulated_swing(command, swing, actuator, ratios) / unshaped
    values = {"residual": abs(vectors[0])}
    if slopes:
        values["slope"] = abs(vectors @ RATIO_WEIGHTS)
    return Certificate(
        claims=tuple(
            Claim(quantity=one.quantity, value=float(values[one.quantity]), limit=one.limit)
            for one in promises
        ),
        method=METHOD.format(speed=swing.speed_m_s),
    )


def judge_large_swing(
    command: Impulses, swing: LargeSwing, actuator: Actuator, promises: tuple[Promise, ...]
) -> Judgement:
    """Hold a command against its promises on a load that swings far.

    Parameters
    ----------
    command, swing, actuator, promises
        As of `certify_large_swing`.

    Returns
    -------
    Judgement
        For the drive that is given.

    Raises
    ------
    InvalidInputError
        If the load forgets the swing before the drive is at rest.
    """
    nominal = np.ones(1)
    ends = swing_ends(swing, actuator, command.times_s[None], command.amplitudes, nominal)
    return Judgement(
        certificate=certify_large_swing(command, swing, actuator, promises),
        for_ideal=False,
        residuals=(float(large_swing_residuals(command, swing, actuator, nominal)[0]),),
        warnings=(),
        large_swing=SwingFigures(swing=swing, largest_rad=float(ends.largest_rad[0, 0])),
    )
