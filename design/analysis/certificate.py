"""A second opinion on what a shaper claims, by simulation and apart from what the solver saw."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from design.analysis.band import largest_in_band
from design.analysis.derivatives import POLYNOMIAL_FROM, polynomial_derivatives, polynomial_nodes
from design.claims import ZERO_LIMITS, Promise, Quantity
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.response.simulation import ringing_after
from design.response.swinging_state import swinging_state
from design.types import ComplexArray, FloatArray

TOLERANCE_MARGIN = 1e-9
"""Share by which a tolerance may be passed: an EI shaper lies on it except for rounding [-]."""

STEP_PHASE_RAD = 2e-5
"""Turn of the last impulse's phase over a step of the slope's central difference [rad].

Truncation is ``step^2 phase^3 / 6``, rounding 1e-16 / step: both stay below half the limit of the
slope up to a hundred periods.
"""

ORDERS: dict[Quantity, int] = {
    "residual": 0,
    "slope": 1,
    "second_derivative": 2,
    "third_derivative": 3,
}
"""What is taken at one frequency, and its order as a derivative."""

METHOD = (
    "state of actuator and mode carried from step to step by matrix exponential; "
    "derivatives from the same at frequencies beside its own"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """One promise of a shaper, with the value found for it."""

    # ``slope`` and the higher derivatives are its vector's change per relative one of frequency
    quantity: Quantity
    value: float  # As recomputed [-]
    limit: float  # The claim holds if ``value <= limit`` [-], a tolerance with a margin of rounding
    mode: int = 0  # Number of the plant's mode that it is about, from 0
    band: tuple[float, float] | None = None  # Its ends over the mode's frequency; None of others

    @property
    def is_zero(self) -> bool:
        """Whether the claim is that the quantity is zero, not a tolerance."""
        return self.limit <= ZERO_LIMITS.get(self.quantity, 0.0)

    @property
    def holds(self) -> bool:
        """Whether the value is within the limit (not a number is not)."""
        return self.value <= self.limit * (1.0 if self.is_zero else 1 + TOLERANCE_MARGIN)


@dataclass(frozen=True, slots=True, kw_only=True)
class Certificate:
    """Every claim of a shaper, recomputed."""

    claims: tuple[Claim, ...]
    method: str = METHOD

    @property
    def verified(self) -> bool:
        """Whether every claim holds."""
        return all(claim.holds for claim in self.claims)


def certify(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    promises: tuple[Promise, ...],
    swing: FreeSwing | None = None,
) -> Certificate:
    """Recompute the claims of a shaper for one mode and actuator.

    Parameters
    ----------
    impulses, mode, actuator
        The shaper, and what it was designed for.
    promises, swing
        What it claims; what the payload swings already at the first step, no part of a band.

    Returns
    -------
    Certificate
        A claim for each promise, in their order; one that fails is in it, no error.
    """
    quantities = {promise.quantity for promise in promises}
    lasting_s = impulses.duration_s + (0.0 if swing is None else swing.delay_s)
    phase = max(1.0, mode.natural_frequency_rad_s * lasting_s)
    step = STEP_PHASE_RAD / phase
    highest = max((ORDERS.get(name, 0) for name in quantities), default=0)
    reach = 0.0
    beside: FloatArray = step * np.array([-1.0, 1.0]) if highest else np.zeros(0)
    if highest >= POLYNOMIAL_FROM:
        reach, beside = polynomial_nodes(phase)
    logarithms = np.concatenate(([0.0], beside))
    ratios = np.exp(logarithms)
    denominators = _Denominators.of(impulses, mode, actuator)
    initial = None if swing is None else swinging_state(swing, mode, ratios)
    ringing, unit, moving_s = ringing_after(
        impulses, actuator, mode.natural_frequency_rad_s * ratios, mode.damping_ratio, initial
    )
    unshaped = abs(unit[0])
    # From the modal coordinate at the end back to V(w), whose origin is the first step.
    vectors = ringing * np.exp(-(mode.pole_rad_s * np.expm1(logarithms)) * moving_s)
    entire = vectors * denominators.at(ratios)
    derivatives = [entire[0]]
    if highest >= POLYNOMIAL_FROM:
        derivatives += polynomial_derivatives(entire[1:], reach, highest)
    elif highest:
        derivatives.append((entire[2] - entire[1]) / (2 * step))
    quotients = denominators.divide(derivatives)

    def value(promise: Promise) -> float:
        if promise.band is None:
            return float(abs(quotients[ORDERS[promise.quantity]]) / unshaped)
        return largest_in_band(impulses, mode, actuator, promise.band)

    return Certificate(
        claims=tuple(
            Claim(
                quantity=promise.quantity,
                value=value(promise),
                limit=promise.limit,
                mode=promise.mode,
                band=promise.band,
            )
            for promise in promises
        )
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Denominators:
    """The product D of the denominators of the sets in use, at the mode's pole.

    The vibration V has the poles of the sets. One near the mode's own bends V so much that no
    polynomial through some frequencies follows, nor does a difference; V D has none and is smooth.
    """

    coefficients: list[complex]  # of the powers of the frequency's ratio to its nominal [-]

    @classmethod
    def of(cls, impulses: Impulses, mode: Mode, actuator: Actuator) -> "_Denominators":
        """Return those of the sets that a command uses."""
        braking = () if impulses.accelerates.all() else (actuator.decel_lag,)
        pole = mode.pole_rad_s
        product = [1 + 0j]
        for lag in (actuator.accel_lag, *braking):
            padded = [0, 0, *product, 0, 0]
            first, second = pole * lag.first_s, pole**2 * lag.second_s2
            product = [
                padded[power + 2] + first * padded[power + 1] + second * padded[power]
                for power in range(len(product) + 2)
            ]
        return cls(product)

    def at(self, ratios: FloatArray) -> ComplexArray:
        """Return D at ratios of the frequency, shape (f,)."""
        value = np.zeros(ratios.shape, dtype=np.complex128)
        for coefficient in reversed(self.coefficients):
            value = value * ratios + coefficient
        return value

    def divide(self, derivatives: Sequence[complex]) -> list[complex]:
        """Return V and its derivatives by ln w from those of V D, by Leibniz's rule.

        A power m of the ratio is exp(m ln ratio): its derivative of order n is m^n times it.
        """
        own = [
            sum(power**order * one for power, one in enumerate(self.coefficients))
            for order in range(len(derivatives))
        ]
        quotients: list[complex] = []
        for order, derivative in enumerate(derivatives):
            known = sum(
                math.comb(order, k) * value * own[order - k] for k, value in enumerate(quotients)
            )
            quotients.append((complex(derivative) - known) / own[0])
        return quotients


def certify_modes(
    impulses: Impulses,
    modes: tuple[Mode, ...],
    actuator: Actuator,
    promises: tuple[Promise, ...],
    swing: FreeSwing | None = None,
) -> Certificate:
    """Recompute the claims of a shaper about several modes, each in its own.

    Parameters
    ----------
    impulses, modes, actuator
        The shaper, and what it was designed for; modes by the numbers that promises have.
    promises, swing
        As of `certify`.

    Returns
    -------
    Certificate
        The claims in the order of the modes.
    """
    claims: list[Claim] = []
    for number, mode in enumerate(modes):
        own = tuple(promise for promise in promises if promise.mode == number)
        claims += certify(impulses, mode, actuator, own, swing).claims
    return Certificate(claims=tuple(claims))
