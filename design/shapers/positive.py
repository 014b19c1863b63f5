"""ZV, ZVD, ZVDD, ZVDDD and MZV: positive impulses, evenly spaced, in closed form.

All their steps increase the command, so behind an actuator they share its acceleration set's G:
one factor, which changes no zero. They are exact for superposed and for switched steps. Behind
limits a lower step has a shorter ramp, G is no common factor: there they are for an ideal one.
"""

import cmath
import math
from dataclasses import dataclass, field
from functools import lru_cache, partial

import numpy as np

from design.checks import require_between
from design.claims import Quantity
from design.errors import InvalidInputError
from design.formulations.formulation import ClosedForm, Formulation
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import ROUNDING, Impulses
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode
from design.shapers.actuators import EVERY_ACTUATOR_BY_ITS_LAG
from design.shapers.damping import DampingBound, require_damping
from design.shapers.kind import DesignCase, KindOf, ShaperKind
from design.shapers.options import NoOptions, ShaperOptions

DERIVATIVES: tuple[Quantity, ...] = (
    "residual",
    "slope",
    "second_derivative",
    "third_derivative",
)

LAST_IS_ROUNDING = f"its last impulse is less than {ROUNDING:g} of the command, and so rounding"

BINOMIALS = ((1.0, 1.0), (1.0, 2.0, 1.0), (1.0, 3.0, 3.0, 1.0), (1.0, 4.0, 6.0, 4.0, 1.0))

MIN_MZV, MAX_MZV = 3, 12
"""Impulses of an MZV: from twelve on its zeros lie so close that a wide band costs little more."""

MZV_DURATION = 0.75
"""Duration of an MZV in damped periods if neither t nor tau is given [-]."""


def exact_actuator(actuator: Actuator) -> Actuator:
    """Return the actuator for which a positive shaper is exact.

    It is the one given, or an ideal one in place of a rate-limited one.
    """
    return Ideal() if isinstance(actuator, RateLimited) else actuator


def evenly(
    mode: Mode, actuator: Actuator, weights: tuple[float, ...], spacing_rad: float
) -> ClosedForm:
    """Return impulses a damped phase apart, of undamped weights.

    Their swings at the last impulse are to each other as the weights: impulse i is smaller by
    ``exp(-z spacing i / sqrt(1 - z^2))``, as a swing that began with the first has decayed by then.

    Parameters
    ----------
    mode
        The mode.
    actuator
        What it is designed for.
    weights
        Of the undamped shaper, n of them [-].
    spacing_rad
        Damped phase from one impulse to the next [rad].

    Returns
    -------
    ClosedForm
        Of n impulses, of sum 1.
    """
    z = mode.damping_ratio
    damped = math.sqrt(1 - z * z)
    decay = math.exp(-z * spacing_rad / damped)
    amplitudes = [weight * decay**number for number, weight in enumerate(weights)]
    total = math.fsum(amplitudes)
    gap = spacing_rad / (damped * mode.natural_frequency_rad_s)
    return ClosedForm(
        impulses=Impulses(
            times_s=gap * np.arange(len(weights)),
            amplitudes=np.array([amplitude / total for amplitude in amplitudes]),
        ),
        designed_for=exact_actuator(actuator),
    )


def damping_bound(weights: tuple[float, ...], spacing_rad: float) -> DampingBound:
    """Return the largest damping ratio that `evenly` serves.

    Beyond it the last impulse is only rounding.

    Parameters
    ----------
    weights
        Of the undamped shaper [-].
    spacing_rad
        Damped phase from one impulse to the next [rad].

    Returns
    -------
    DampingBound
        With the reason.
    """
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        z = (low + high) / 2
        if _last_is_rounding(weights, spacing_rad, z):
            high = z
        else:
            low = z
    rounded = math.floor(low / DAMPING_STEP) * DAMPING_STEP
    return DampingBound(most=min(round(rounded, 2), MAX_DAMPING_RATIO), beyond=LAST_IS_ROUNDING)


def _last_is_rounding(weights: tuple[float, ...], spacing_rad: float, damping_ratio: float) -> bool:
    decay = math.exp(-damping_ratio * spacing_rad / math.sqrt(1 - damping_ratio**2))
    shares = [weight * decay**number for number, weight in enumerate(weights)]
    return shares[-1] <= ROUNDING * math.fsum(shares)


HALVINGS = 40
"""Of the interval from 0 to 1: to far below the step of the bound."""

DAMPING_STEP = 0.01
"""To which bounds of damping are rounded down [-]."""


def _zero_vibration(order: int, case: DesignCase[NoOptions]) -> Formulation:
    return evenly(case.mode, case.actuator, BINOMIALS[order], math.pi)


def _zv_kind(name: str, order: int, summary: str, source: str) -> ShaperKind:
    return KindOf(
        name=name,
        summary=summary,
        source=source,
        claims=DERIVATIVES[: order + 1],
        options=NoOptions,
        actuators=EVERY_ACTUATOR_BY_ITS_LAG,
        formulation=partial(_zero_vibration, order),
        damping=damping_bound(BINOMIALS[order], math.pi),
    )


SINGER = (
    'N. C. Singer, W. P. Seering, "Preshaping command inputs to reduce system vibration", '
    "J. Dyn. Sys., Meas., Control 112 (1990)"
)

ZV = _zv_kind(
    "zv",
    0,
    "Two positive impulses half a period apart, zero vibration; also known as posicast.",
    f'O. J. M. Smith, "Posicast control of damped oscillatory systems", Proc. IRE 45 (1957); '
    f"{SINGER}",
)
ZVD = _zv_kind("zvd", 1, "Three positive impulses, zero vibration and slope.", SINGER)
ZVDD = _zv_kind(
    "zvdd", 2, "Four positive impulses, zero vibration, slope and second derivative.", SINGER
)
ZVDDD = _zv_kind(
    "zvddd", 3, "Five positive impulses, zero vibration and its first three derivatives.", SINGER
)


@dataclass(frozen=True, slots=True, kw_only=True)
class MzvOptions(ShaperOptions):
    """Parameters of an MZV shaper.

    Attributes
    ----------
    n
        Number of impulses [-].
    t
        Duration in damped periods, below (n - 1)/2 [-].
    tau
        In place of t: the duration that it tends to with n, ``t = tau (n - 1)/(n + 2 tau - 2)``
        [-].
    """

    n: int = field(
        default=MIN_MZV,
        metadata={"description": "Number of impulses.", "ge": MIN_MZV, "le": MAX_MZV},
    )
    t: float | None = field(
        default=None,
        metadata={
            "description": "Duration in damped periods, below (n - 1)/2; 0.75 if neither t nor "
            "tau is given.",
            "ge": 0.1,
            "le": 5.5,
        },
    )
    tau: float | None = field(
        default=None,
        metadata={
            "description": "In place of t: the duration that it tends to as n grows, "
            "t = tau (n - 1)/(n + 2 tau - 2).",
            "ge": 0.1,
            "le": 100.0,
        },
    )

    def __post_init__(self) -> None:
        if not isinstance(self.n, int):
            raise InvalidInputError("n", self.n, "a whole number", code="not_whole")
        require_between("n", self.n, MIN_MZV, MAX_MZV)
        if self.t is not None and self.tau is not None:
            raise InvalidInputError(
                "tau", self.tau, "left out where t is given", code="duration_said_twice"
            )
        if self.t is not None and not 0 < self.t < (self.n - 1) / 2:
            raise InvalidInputError(
                "t",
                self.t,
                f"between 0 and (n - 1)/2 = {(self.n - 1) / 2:g}, both excluded",
                code="out_of_range",
            )
        if self.tau is not None and not 0 < self.tau < math.inf:
            raise InvalidInputError("tau", self.tau, "finite and > 0", code="not_positive")

    @property
    def duration_periods(self) -> float:
        """Duration in damped periods [-]."""
        if self.tau is not None:
            return self.tau * (self.n - 1) / (self.n + 2 * self.tau - 2)
        return MZV_DURATION if self.t is None else self.t


def mzv(case: DesignCase[MzvOptions]) -> Formulation:
    """Formulate a shaper faster than ZVD: impulses closer than half a period.

    With x the turn from one impulse to the next, ``V`` is a polynomial in x. Its n - 1 roots lie on
    the unit circle, evenly from the nominal phase ``p = 2 pi t / (n - 1)`` to ``2 pi - p``: so the
    zeros go on at equal distances in frequency, the first of them at the nominal one.

    Returns
    -------
    Formulation
        A closed form of n impulses.

    Raises
    ------
    InvalidInputError
        If the duration asked for makes an impulse negative, or the mode is damped too much.
    """
    mode, options = case.mode, case.options
    phase = 2 * math.pi * options.duration_periods / (options.n - 1)
    weights = mzv_weights(options.n, phase)
    if min(weights) < -ROUNDING * sum(weights):
        raise InvalidInputError(
            "shaper.t",
            options.duration_periods,
            f"longer: {options.n} impulses in as many damped periods would not all be positive",
            code="too_short_to_be_positive",
        )
    if _last_is_rounding(weights, phase, mode.damping_ratio):
        require_damping("mzv", damping_bound(weights, phase), mode)
    return evenly(mode, case.actuator, weights, phase)


@lru_cache(maxsize=256)
def mzv_weights(n: int, phase: float) -> tuple[float, ...]:
    """Return the coefficients of the polynomial whose roots `mzv` has.

    Parameters
    ----------
    n
        Number of impulses, >= 3.
    phase
        Phase of the first root [rad].

    Returns
    -------
    tuple of float
        n weights [-].
    """
    step = 2 * (math.pi - phase) / (n - 2)
    polynomial: list[complex] = [1.0]
    for number in range(n - 1):
        root = cmath.exp(1j * (phase + number * step))
        shifted = [*polynomial, 0j]
        for index, coefficient in enumerate(polynomial):
            shifted[index + 1] -= root * coefficient
        polynomial = shifted
    # Each root's conjugate is a root: what is left of imaginary parts is rounding.
    return tuple(coefficient.real for coefficient in polynomial)


MZV = KindOf(
    name="mzv",
    summary="Evenly spaced positive impulses, zero vibration; by default three in 3/4 of a period.",
    source="D. Butyugin, Klipper firmware, input shapers (2020), decay per impulse "
    "exp(-2 pi t z / ((n - 1) sqrt(1 - z^2)))",
    claims=("residual",),
    options=MzvOptions,
    actuators=EVERY_ACTUATOR_BY_ITS_LAG,
    formulation=mzv,
)
