"""SNA-ZV, SNA-ZVD: negative impulses of given amplitude, from none to those of unity magnitude.

A larger negative impulse makes a shaper faster and swings the drive more.
"""

import cmath
import math
from dataclasses import dataclass, field

import numpy as np

from design.errors import InfeasibleDesignError, InvalidInputError
from design.formulations.formulation import ClosedForm, Formulation
from design.formulations.lag_parameters import decel_over_accel
from design.formulations.seeds import Seed
from design.formulations.unity_magnitude import ZERO_VIBRATION, ZERO_VIBRATION_DERIVATIVE
from design.formulations.unity_magnitude_problem import unity_magnitude_problem
from design.model.impulses import Impulses
from design.shapers.actuators import UNLIMITED_ACTUATORS
from design.shapers.damping import LAST_PULSE_VANISHES, DampingBound, damped_periods
from design.shapers.kind import DesignCase, KindOf
from design.shapers.options import ShaperOptions
from design.types import FloatArray

SOURCE = (
    'W. Singhose, W. Seering, N. Singer, "Time-optimal negative input shapers", '
    "J. Dyn. Sys., Meas., Control 119 (1997)"
)

MAX_PERIODS = 3.0
"""Longest of these shapers that is searched, in damped periods [-]."""

HALVINGS = 60
"""Of an interval of a quarter turn: to the last digit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NegativeOptions(ShaperOptions):
    """Parameters of the shapers of given negative amplitude.

    Attributes
    ----------
    negative_amplitude
        Size of the negative impulse [-].
    """

    negative_amplitude: float = field(
        default=0.5,
        metadata={
            "description": "Size of the negative impulse: 1 for unity magnitude, towards 0 the "
            "shaper tends to zv.",
            "gt": 0,
            "le": 1,
        },
    )

    def __post_init__(self) -> None:
        if not 0 < self.negative_amplitude <= 1:
            raise InvalidInputError(
                "negative_amplitude",
                self.negative_amplitude,
                "greater than 0 and at most 1",
                code="out_of_range",
            )


def sna_zv(case: DesignCase[NegativeOptions]) -> Formulation:
    """Formulate three impulses of which the second is given.

    None is above 1.

    The first and third swing alike at the end: undamped the fastest of all their shares, damped by
    less than 0.05 % slower up to z = 0.1, 0.6 % at 0.5. Where the first would be above 1 it is 1,
    and the third as large as the second. A switched actuator gets the amplitudes of a superposed
    one, and other times.
    """
    mode, actuator, options = case.mode, case.actuator, case.options
    b, z = options.negative_amplitude, mode.damping_ratio
    ratio = decel_over_accel(mode, actuator)
    turn = _isosceles(b, z, ratio)
    first = (1 + b) / (1 + math.exp(-2 * turn * z / math.sqrt(1 - z * z)))
    amplitudes = np.array([min(first, 1.0), -b, 1 + b - min(first, 1.0)])
    if first <= 1 and actuator.model == "superposed":
        damped = math.sqrt(1 - z * z) * mode.natural_frequency_rad_s
        times = np.array([0.0, turn + cmath.phase(ratio), 2 * turn]) / damped
        if 0 < times[1] < times[2]:
            return ClosedForm(
                impulses=Impulses(times_s=times, amplitudes=amplitudes), designed_for=actuator
            )
    return unity_magnitude_problem(
        ZERO_VIBRATION,
        mode,
        actuator,
        settle=False,
        max_duration_periods=damped_periods(mode, MAX_PERIODS),
        amplitudes=amplitudes,
    )


def _isosceles(b: float, damping_ratio: float, ratio: complex) -> float:
    """Return half the damped phase of a shaper whose outer impulses swing alike [rad].

    With c the first amplitude, ``k = z / sqrt(1 - z^2)`` and ``a exp(j p) = G_decel / G_accel``,
    ``V = 0`` for impulses c, -b, 1 + b - c at 0, x + p and 2 x is::

        c = (1 + b) / (1 + exp(-2 k x)),    (1 + b) cos x = b a exp(k p) cosh(k x)

    whose left side falls from x = 0 to a quarter turn while its right side does not.

    Raises
    ------
    InfeasibleDesignError
        If there is no such x within a quarter turn.
    """
    k = damping_ratio / math.sqrt(1 - damping_ratio**2)
    pull = b * abs(ratio) * math.exp(k * cmath.phase(ratio))
    if pull >= 1 + b:
        raise InfeasibleDesignError(
            f"the vector diagram does not close: behind the deceleration set an impulse of {b:g} "
            f"acts as one of {pull:.6g}, more than the other two together, {1 + b:g}",
            code="negative_impulse_too_strong",
        )
    low, high = 0.0, math.pi / 2
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if (1 + b) * math.cos(middle) > pull * math.cosh(k * middle):
            low = middle
        else:
            high = middle
    return high


def sna_zvd(case: DesignCase[NegativeOptions]) -> Formulation:
    """Formulate five impulses, the second and fourth given.

    The residual is flat in frequency.

    Undamped and behind an actuator that follows its command it is its own mirror image: amplitudes
    a, -b, c, -b, a at 0, y - x, y, y + x, 2 y. The conditions ``V = dV/dw = 0`` leave one of a, c,
    x, y free; here, on the line from ZVD at b = 0 to UMZVD at b = 1::

        a = (1 + 3 b) / 4,    c = (1 + b) / 2

    within 0.7 % of the fastest of all shares. Damped, the positive impulses decay as those of ZVD
    do, by ``exp(-k y)`` from one to the next with ``k = z / sqrt(1 - z^2)``; where the command
    would leave 0 to 1, the first is 1 or the last b. Behind an asymmetric actuator the amplitudes
    are the same. In each case the four times solve the four equations.
    """
    mode, actuator, options = case.mode, case.actuator, case.options
    b, z = options.negative_amplitude, mode.damping_ratio
    x, y = _solve_mirrored(b)
    damped = math.sqrt(1 - z * z)
    shift = cmath.phase(decel_over_accel(mode, actuator))
    near = np.array([0.0, y - x + shift, y, y + x + shift, 2 * y]) / damped
    return unity_magnitude_problem(
        ZERO_VIBRATION_DERIVATIVE,
        mode,
        actuator,
        settle=False,
        max_duration_periods=damped_periods(mode, MAX_PERIODS),
        amplitudes=_decaying(b, math.exp(y * z / damped)),
        seeds=(Seed(name="undamped_mirror_image", gaps_rad=np.diff(near)),),
    )


def _solve_mirrored(b: float) -> tuple[float, float]:
    """Return x and y of the undamped shaper a, -b, c, -b, a, each from its middle [rad].

    V and dV/dw vanish if::

        c - 2 b cos x + 2 a cos y = 0,    a y sin y = b x sin x

    The first gives y of x; with it the second changes sign between x = pi/2 and 2 pi/3.
    """
    a, c = (1 + 3 * b) / 4, (1 + b) / 2

    def outer(x: float) -> float:
        return math.acos(max(-1.0, (2 * b * math.cos(x) - c) / (2 * a)))

    low, high = math.pi / 2, 2 * math.pi / 3
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        y = outer(middle)
        if a * y * math.sin(y) > b * middle * math.sin(middle):
            low = middle
        else:
            high = middle
    return high, outer(high)


def _decaying(b: float, decay: float) -> FloatArray:
    """Return the amplitudes of SNA-ZVD, shape (5,): they sum to 1, the command is within 0 to 1."""
    shares = np.array([(1 + 3 * b) / 4 * decay, (1 + b) / 2, (1 + 3 * b) / 4 / decay])
    last = max(float(shares[2] / shares.sum()) * (1 + 2 * b), b)
    first = min(float(shares[0] / shares[:2].sum()) * (1 + 2 * b - last), 1.0)
    return np.array([first, -b, 1 + 2 * b - first - last, -b, last])


SNA_ZV = KindOf(
    name="sna_zv",
    summary="Three impulses, the negative one of given amplitude, zero vibration, behind an "
    "asymmetric actuator.",
    source=f"{SOURCE}; asymmetric actuator: its vector diagram at the pole, closed",
    claims=("residual",),
    options=NegativeOptions,
    actuators=UNLIMITED_ACTUATORS,
    formulation=sna_zv,
    damping=DampingBound(most=0.97, beyond=LAST_PULSE_VANISHES),
)

SNA_ZVD = KindOf(
    name="sna_zvd",
    summary="Five impulses, the negative ones of given amplitude, zero vibration and slope, behind "
    "an asymmetric actuator.",
    source=f"{SOURCE}; positive amplitudes: a mirror image between ZVD and UMZVD",
    claims=("residual", "slope"),
    options=NegativeOptions,
    actuators=UNLIMITED_ACTUATORS,
    formulation=sna_zvd,
    damping=DampingBound(most=0.9, beyond=LAST_PULSE_VANISHES),
)
