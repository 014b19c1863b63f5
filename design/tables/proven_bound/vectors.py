"""The residual's vector as one formula, of balls or of plain numbers.

Everything is counted in radians of the plant, ``x = w t``: the pole is ``sigma = s / w``, a lag
``1 / (1 + a p + b p^2)`` with ``a = w first`` and ``b = w^2 second``. Sections 1 and 2 of
``docs/theory.md`` have the formula: a superposed step adds ``A G(sigma) exp(-sigma x)``, a switched
state is carried by the free motion of its set and handed over where the set changes.

It shares no code with `design.response`, by which residuals are found elsewhere.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import Unlimited
from design.tables.proven_bound.balls import Number, either_root, exp, mean_decay, sqrt
from design.tables.proven_bound.ramps import PhaseRamp
from design.types import BoolArray, FloatArray

Coordinates = Callable[[str], Number]
"""The coordinate of a field, as ``plant.damping_ratio``: see `design.tables.coordinates`."""


CRITICAL = 0.01
"""Distance of a squared damping ratio from 1 below which two poles are not taken apart [-]."""


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
            if is_zero(self.first):
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

    def pulled(self, ramp: Number) -> tuple[Number, Number]:
        """Return error and rate at the end of a ramp, from 1 below to 0.

        They are the mean of the free motion of an error of 1: of its two exponentials, or, where
        the poles may coincide, by ``e + a e' + b e'' = 0`` integrated over the ramp.
        """
        if is_zero(self.first):
            return 0.0, 0.0
        if self.slowness is None:
            return mean_decay(ramp / self.first), 0.0
        if isinstance(self.damping, float) and abs(self.damping**2 - 1) > CRITICAL:
            root = either_root((self.damping - 1) * (self.damping + 1))
            fast = complex(self.damping + root)
            slow = 1 / fast
            phase = ramp / self.slowness
            late, early = mean_decay(slow * phase), mean_decay(fast * phase)
            apart = fast - slow
            mean = late * (fast / apart) - early * (slow / apart)
            return mean, (early - late) * (1 / apart) / self.slowness
        error, rate = self.moved(1.0, 0.0, ramp)
        lost = 1 - error
        return (self.first * lost - self.second * rate) / ramp, -lost / ramp


def is_zero(value: Number) -> bool:
    """Return whether a number is a 0 that nothing varies."""
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
    actuator: Unlimited, part: str, frequency: Number, coordinate: Coordinates
) -> tuple[PhaseLag, PhaseLag]:
    """Return the lags of both sets, accel and decel.

    Parameters
    ----------
    actuator
        What the fields are varied in, without limits.
    part
        Its path, as ``actuator`` or, behind limits, ``actuator.then``.
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
        constants = [coordinate(f"{part}.{one}_time_constant_s") for one in ("accel", "decel")]
        firsts = [0.0 if is_zero(one) else frequency * one for one in constants]
        return PhaseLag(firsts[0], 0.0), PhaseLag(firsts[1], 0.0)
    accel, decel = (
        _second_order(f"{part}.{name}", frequency, coordinate) for name in ("accel", "decel")
    )
    return accel, decel


def _second_order(name: str, frequency: Number, coordinate: Coordinates) -> PhaseLag:
    slowness = frequency * coordinate(f"{name}.natural_frequency_rad_s")
    damping = coordinate(f"{name}.damping_ratio")
    return PhaseLag(2 * damping * slowness, slowness * slowness, slowness, damping)


def steps_of(
    phases: Sequence[Number], amplitudes: FloatArray, accelerates: BoolArray
) -> list[PhaseRamp]:
    """Return steps as ramps of no duration.

    Parameters
    ----------
    phases
        ``w t`` of each, in order [rad].
    amplitudes, accelerates
        Heights [-], and which are answered by the acceleration set, shape (n,).

    Returns
    -------
    list of PhaseRamp
        n of them.
    """
    each = zip(phases, amplitudes.tolist(), accelerates.tolist(), strict=True)
    return [PhaseRamp(phase, 0.0, height, grows) for phase, height, grows in each]


def vector_of(
    ramps: Sequence[PhaseRamp],
    pole: Number,
    lags: tuple[PhaseLag, PhaseLag],
    *,
    switched: bool,
) -> Number:
    """Return the vibration vector of a reference over the unshaped step's.

    Parameters
    ----------
    ramps
        Changes of the reference, in order; steps are ramps of no duration.
    pole
        Of the plant over its frequency [-].
    lags
        Of both sets.
    switched
        Whether both sets share one state.

    Returns
    -------
    Number
        ``V exp(s t_e) / G_accel(s)``, t_e the end of the last change [-]; the residual is its
        magnitude.
    """
    below = [lag.below(pole) for lag in lags]
    sums: list[Number] = [0.0, 0.0]
    state: tuple[Number, Number] = (0.0, 0.0)
    for number, ramp in enumerate(ramps):
        which = 0 if ramp.grows else 1
        turned = exp(-pole * ramp.start)
        left = 1.0 if is_zero(ramp.duration) else mean_decay(pole * ramp.duration)
        sums[which] = sums[which] + ramp.change * turned * left
        if switched and number:
            last = ramps[number - 1]
            before = 0 if last.grows else 1
            state = _after(lags[before], state, last, ramp.start - last.start)
            if before != which:
                for one, sign in ((which, 1.0), (before, -1.0)):
                    handed = lags[one].second * pole * state[1] - state[0]
                    sums[one] = sums[one] + sign * (handed * turned)
    total = sums[0] + below[0] / below[1] * sums[1]
    return total * exp(pole * (ramps[-1].start + ramps[-1].duration))


def _after(
    lag: PhaseLag, state: tuple[Number, Number], ramp: PhaseRamp, gap: Number
) -> tuple[Number, Number]:
    """Return the state of a lag after a ramp and the rest of a gap, from just before it."""
    if is_zero(ramp.duration):
        return lag.moved(state[0] - ramp.change, state[1], gap)
    error, rate = lag.moved(*state, gap)
    pulled = lag.moved(*lag.pulled(ramp.duration), gap - ramp.duration)
    return error - ramp.change * pulled[0], rate - ramp.change * pulled[1]
