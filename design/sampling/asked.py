"""What is asked of amplitudes on samples, as vectors that are sums of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from design.analysis.residual import residual_vectors
from design.claims import ZERO_LIMITS, Promise, Quantity
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.left import FREQUENCY_ERROR
from design.sampling.sample_grid import AnyIntArray
from design.types import ComplexArray, FloatArray

ORDERS: dict[Quantity, int] = {
    "residual": 0,
    "slope": 1,
    "second_derivative": 2,
    "third_derivative": 3,
}
"""Derivatives of V by what they are called."""

CIRCLE, RADIUS = 16, 0.02
"""Points of a circle around the pole, and its radius over the frequency, from which derivatives are
taken: the next power of it, 1e-27, counts for nothing [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Asked:
    """What is asked in one mode.

    Attributes
    ----------
    mode
        The mode.
    zeros
        How many Taylor coefficients of V over the frequency are to be zero, from the first on.
    nominal
        Limit of the residual at the nominal frequency, where it is not zero; None if there is none.
    bands
        Ends of each band with its tolerance.
    """

    mode: Mode
    zeros: int
    nominal: float | None
    bands: tuple[tuple[tuple[float, float], float], ...]

    @property
    def zero_limits(self) -> FloatArray:
        """What counts as zero, in the scale of `Drive.zero_rows`, shape (zeros,)."""
        return np.array([
            ZERO_LIMITS[quantity] * FREQUENCY_ERROR**order / math.factorial(order)
            for quantity, order in ORDERS.items()
            if order < self.zeros
        ])


def asked_of(promises: Sequence[Promise], modes: tuple[Mode, ...]) -> tuple[Asked, ...]:
    """Return what promises ask in each mode.

    Parameters
    ----------
    promises
        Those of the shaper between the samples.
    modes
        The plant's modes, by their numbers.

    Returns
    -------
    tuple of Asked
        One for each mode, in their order.
    """
    asked = []
    for number, mode in enumerate(modes):
        own = [promise for promise in promises if promise.mode == number]
        bands = tuple((one.band, one.limit) for one in own if one.band is not None)
        here = [one for one in own if one.band is None]
        zero = [one.limit <= ZERO_LIMITS.get(one.quantity, 0.0) for one in here]
        orders = [ORDERS[one.quantity] for one, is_zero in zip(here, zero, strict=True) if is_zero]
        nominal = [one.limit for one, is_zero in zip(here, zero, strict=True) if not is_zero]
        asked.append(Asked(mode, max(orders, default=-1) + 1, min(nominal, default=None), bands))
    return tuple(asked)


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """The drive that amplitudes on samples go through, and the sample time."""

    actuator: Actuator
    sample_time_s: float

    @property
    def passes_state_on(self) -> bool:
        """Whether a set takes over the state of the one before."""
        return self.actuator.model == "switched" and not self.has_one_set

    @property
    def has_one_set(self) -> bool:
        """Whether steps up and down act alike."""
        return self.actuator.accel_lag == self.actuator.decel_lag

    def vectors(
        self, mode: Mode, ratios: ComplexArray, samples: AnyIntArray, signs: FloatArray | None
    ) -> ComplexArray:
        """Return what a step of each sample adds to V.

        Over V of an unshaped step.

        Parameters
        ----------
        mode
            The mode.
        ratios
            Ratios of its frequency, shape (r,); complex ones are points beside it.
        samples
            Numbers of the samples, shape (k,).
        signs
            Signs of the steps where they count, shape (k,); None where all steps act alike.

        Returns
        -------
        ComplexArray
            Shape (r, k), at the last sample.
        """
        poles = mode.pole_rad_s * ratios
        until = self.sample_time_s * (samples[-1] - samples)
        swings: ComplexArray = np.exp(np.multiply.outer(poles, until))
        accel, decel = self.actuator.accel_lag, self.actuator.decel_lag
        if signs is None or accel == decel:
            return swings
        if self.actuator.model == "superposed":
            over = accel.denominator(poles) / decel.denominator(poles)
            return np.where(signs > 0, swings, over[:, None] * swings)
        # A switched drive passes its state on: V is linear for as long as steps keep their signs.
        base = np.where(signs > 0, 2.0 * samples.size, -1.0)
        times = self.sample_time_s * samples
        whole = residual_vectors(Impulses(times_s=times, amplitudes=base), poles, self.actuator)
        columns = np.empty((poles.size, samples.size), dtype=np.complex128)
        for index in range(samples.size):
            more = base.copy()
            more[index] *= 2
            command = Impulses(times_s=times, amplitudes=more)
            changed = residual_vectors(command, poles, self.actuator)
            columns[:, index] = (changed - whole) / base[index]
        return columns

    def zero_rows(
        self, asked: Asked, samples: AnyIntArray, signs: FloatArray | None
    ) -> ComplexArray:
        """Return what a step of each sample adds to the zeros.

        Those are Taylor coefficients of V over the frequency.

        Parameters
        ----------
        asked, samples, signs
            What is asked of one mode, and as of `vectors`.

        Returns
        -------
        ComplexArray
            Each times its power of `FREQUENCY_ERROR`, shape (m, k).
        """
        if asked.zeros == 0:
            return np.zeros((0, samples.size), dtype=np.complex128)
        if asked.zeros == 1:
            return self.vectors(asked.mode, np.ones(1, dtype=complex), samples, signs)
        if signs is None or self.actuator.accel_lag == self.actuator.decel_lag:
            turns = asked.mode.pole_rad_s * self.sample_time_s * (samples[-1] - samples)
            orders = range(asked.zeros)
            return np.array([
                (FREQUENCY_ERROR * turns) ** order / math.factorial(order) * np.exp(turns)
                for order in orders
            ])
        around = np.exp(2j * math.pi * np.arange(CIRCLE) / CIRCLE)
        values = self.vectors(asked.mode, 1 + RADIUS * around, samples, signs)
        scales = (FREQUENCY_ERROR / RADIUS) ** np.arange(asked.zeros)
        rows: ComplexArray = np.fft.fft(values, axis=0)[: asked.zeros] / CIRCLE * scales[:, None]
        return rows
