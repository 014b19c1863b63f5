"""The residual's vector as one formula, of balls or of plain numbers.

Everything is counted in radians of the plant, ``x = w t``: the pole is ``sigma = s / w``, a lag
``1 / (1 + a p + b p^2)`` with ``a = w first`` and ``b = w^2 second``. Sections 1 and 2 of
``docs/theory.md`` have the formula: a superposed step adds ``A G(sigma) exp(-sigma x)``, a switched
state is carried by the free motion of its set and handed over where the set changes.

It shares no code with `design.response`, by which residuals are found elsewhere.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import Unlimited
from design.tables.proven_bound.balls import Number, either_root, exp, mean_decay, sqrt
from design.types import BoolArray, FloatArray

Coordinates = Callable[[str], Number]
"""The coordinate of a field, as ``plant.damping_ratio``: see `design.tables.coordinates`."""


@dataclass(frozen=True, slots=True, eq=False)
class PhaseLag:
    """A lag of unit gain over the plant's phase: a + b of the denominator, and its motion."""

    first: Number  # Coefficient a of p [-]
    second: Number  # Coefficient b of p^2 [-]
    # Turn of the lag over one radian of the plant, and its damping ratio; of second order only
    slowness: Number = None
    damping: Number = None

    def below(self, pole: Number) -> Number:
        """Return ``1 / G`` at a pole [-]."""
        return 1 + pole * (self.first + pole * self.second)

    def moved(self, error: Number, rate: Number, gap: Number) -> tuple[Number, Number]:
        """Return the state after a gap in which the command holds.

        Parameters
        ----------
        error, rate
            Velocity less command, and its rate over the plant's phase, at the start [-].
        gap
            Of the plant's phase [rad].

        Returns
        -------
        tuple of Number
            Error and rate at its end.
        """
        if self.slowness is None:
            if _is_zero(self.first):
                return 0.0, 0.0
            return error * exp(-gap / self.first), 0.0
        phase = gap / self.slowness
        root = either_root((self.damping - 1) * (self.damping + 1))
        fast = self.damping + root
        # The two poles multiply to 1: of the slow one no digit is lost.
        slow = exp(-phase / fast)
        turn = 2 * root * phase
        odd = slow * phase * mean_decay(turn)
        even = slow * (1 + exp(-turn)) * 0.5
        steep = self.damping * odd
        after = (even + steep) * error + odd * self.slowness * rate
        return after, (even - steep) * rate - odd * error / self.slowness


def _is_zero(value: Number) -> bool:
    return isinstance(value, int | float) and value == 0


def plant_of(coordinate: Coordinates, plant_fields: Sequence[str]) -> tuple[Number, Number]:
    """Return frequency and pole of the plant's mode.

    Parameters
    ----------
    coordinate
        Of each field.
    plant_fields
        Those whose coordinates multiply to the frequency.

    Returns
    -------
    tuple of Number
        Natural frequency [rad/s], and its pole over that [-].
    """
    frequency: Number = 1.0
    for field in plant_fields:
        frequency = frequency * coordinate(field)
    damping = coordinate("plant.damping_ratio")
    return frequency, 1j * sqrt((1 - damping) * (1 + damping)) - damping


def lags_of(
    actuator: Unlimited, frequency: Number, coordinate: Coordinates
) -> tuple[PhaseLag, PhaseLag]:
    """Return the lags of both sets, accel and decel.

    Parameters
    ----------
    actuator
        What the fields are varied in, without limits.
    frequency
        Of the plant [rad/s].
    coordinate
        Of each field.

    Returns
    -------
    tuple of PhaseLag
        Over the plant's phase.
    """
    if isinstance(actuator, Ideal):
        return PhaseLag(0.0, 0.0), PhaseLag(0.0, 0.0)
    if isinstance(actuator, FirstOrder):
        constants = [coordinate(f"actuator.{one}_time_constant_s") for one in ("accel", "decel")]
        firsts = [0.0 if _is_zero(one) else frequency * one for one in constants]
        return PhaseLag(firsts[0], 0.0), PhaseLag(firsts[1], 0.0)
    accel, decel = (_second_order(name, frequency, coordinate) for name in ("accel", "decel"))
    return accel, decel


def _second_order(name: str, frequency: Number, coordinate: Coordinates) -> PhaseLag:
    slowness = frequency * coordinate(f"actuator.{name}.natural_frequency_rad_s")
    damping = coordinate(f"actuator.{name}.damping_ratio")
    return PhaseLag(2 * damping * slowness, slowness * slowness, slowness, damping)


def vector_of(
    phases: Sequence[Number],
    amplitudes: FloatArray,
    accelerates: BoolArray,
    pole: Number,
    lags: tuple[PhaseLag, PhaseLag],
    *,
    switched: bool,
) -> Number:
    """Return the vibration vector of steps over that of the unshaped step.

    Parameters
    ----------
    phases
        ``w t`` of each step, in order, n of them [rad].
    amplitudes
        Heights, shape (n,) [-].
    accelerates
        Which are answered by the acceleration set, shape (n,).
    pole
        Of the plant over its frequency [-].
    lags
        Of both sets.
    switched
        Whether both sets share one state.

    Returns
    -------
    Number
        ``V exp(s t_n) / G_accel(s)`` [-]; the residual is its magnitude.
    """
    below = [lag.below(pole) for lag in lags]
    gains: list[Number] = [1.0, below[0] / below[1]]
    sums: list[Number] = [0.0, 0.0]
    error: Number = 0.0
    rate: Number = 0.0
    before = None
    steps = zip(phases, amplitudes.tolist(), np.where(accelerates, 0, 1).tolist(), strict=True)
    for number, (phase, height, which) in enumerate(steps):
        turned = exp(-pole * phase)
        sums[which] = sums[which] + height * turned
        if switched:
            if before is not None:
                gap = phase - phases[number - 1]
                error, rate = lags[before].moved(error, rate, gap)
                if before != which:
                    for one, sign in ((which, 1.0), (before, -1.0)):
                        left = lags[one].second * pole * rate - error
                        sums[one] = sums[one] + sign * (left * turned)
            error = error - height
            before = which
    total = gains[0] * sums[0] + gains[1] * sums[1]
    return total * exp(pole * phases[-1])
