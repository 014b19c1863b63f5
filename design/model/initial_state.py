"""A swing that the payload already makes when a command begins."""

import cmath
import math
from dataclasses import dataclass, replace

from design.checks import MAX_VALUE, require_between
from design.errors import InvalidInputError
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant


def _require_sizes(record: object, *names: str) -> None:
    for name in names:
        require_between(name, getattr(record, name), -MAX_VALUE, MAX_VALUE)


@dataclass(frozen=True, slots=True, kw_only=True)
class AngleSwing:
    """State of a pendulum at the first step, the trolley at rest.

    Attributes
    ----------
    angle_rad
        From the vertical, positive where the load is ahead of the trolley in +x [rad].
    angle_rate_rad_s
        Its rate [rad/s].
    """

    angle_rad: float
    angle_rate_rad_s: float

    def __post_init__(self) -> None:
        _require_sizes(self, "angle_rad", "angle_rate_rad_s")


@dataclass(frozen=True, slots=True, kw_only=True)
class DeflectionSwing:
    """State of a mode at the first step, its support at rest.

    Attributes
    ----------
    deflection_m
        Of the payload against its support, positive in +x [m].
    deflection_rate_m_s
        Its rate [m/s].
    """

    deflection_m: float
    deflection_rate_m_s: float

    def __post_init__(self) -> None:
        _require_sizes(self, "deflection_m", "deflection_rate_m_s")


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeSwing:
    """A swing per unit of full speed, seen in the direction of travel.

    With ``d'' + 2 z w d' + w^2 d = -v'`` and the command's first step at time 0, it adds
    ``-(d' - conj(s) d)`` to the vibration ``V(w)`` of the command (docs/theory.md).

    Attributes
    ----------
    deflection_s
        Deflection over the speed [s].
    rate
        Its rate over the speed [-].
    frequency_power
        How both go with the plant's frequency: 0 for a deflection measured; -2 for the angle of a
        pendulum, whose cable of length g/w^2 turns it into the deflection.
    delay_s
        Dead time of the actuator: so long it swings freely after the first step [s].
    """

    deflection_s: float
    rate: float
    frequency_power: int
    delay_s: float = 0.0

    def vector(self, mode: Mode) -> complex:
        """Return what the swing adds to the residual vibration of a command.

        Parameters
        ----------
        mode
            The mode that swings.

        Returns
        -------
        complex
            Seen when the actuator answers the first step [-].
        """
        pole = mode.pole_rad_s
        return (pole.conjugate() * self.deflection_s - self.rate) * cmath.exp(pole * self.delay_s)

    def scaled(self, factor: float) -> "FreeSwing":
        """Return the swing a number of times as large."""
        return replace(self, deflection_s=factor * self.deflection_s, rate=factor * self.rate)


InitialSwing = AngleSwing | DeflectionSwing


def free_swing(
    plant: Plant, initial: InitialSwing | None, velocity_m_s: float, delay_s: float = 0.0
) -> FreeSwing | None:
    """Return a swing in units of the speed; None where there is none.

    Parameters
    ----------
    plant
        What swings: a pendulum by its angle, a mode by its deflection.
    initial
        Its state at the first step.
    velocity_m_s
        Full speed, signed by the direction of travel [m/s].
    delay_s
        Dead time of the actuator [s].

    Returns
    -------
    FreeSwing or None
        The swing over the speed; None if no state is given, or one at rest.

    Raises
    ------
    InvalidInputError
        If the state is not of the plant's form, or the swing is too large to compute with.

    Examples
    --------
    >>> crane = Pendulum(cable_length_m=0.8)
    >>> swing = free_swing(crane, AngleSwing(angle_rad=0.1, angle_rate_rad_s=0.0), -0.2)
    >>> round(swing.deflection_s, 12), swing.frequency_power
    (-0.4, -2)
    """
    if initial is None:
        return None
    if isinstance(plant, Pendulum) != isinstance(initial, AngleSwing):
        wanted = (
            "angle_rad and angle_rate_rad_s for a pendulum"
            if isinstance(plant, Pendulum)
            else "deflection_m and deflection_rate_m_s for a mode"
        )
        given = "an angle" if isinstance(initial, AngleSwing) else "a deflection"
        raise InvalidInputError("initial", given, wanted, code="state_of_other_plant")
    if isinstance(plant, Pendulum) and isinstance(initial, AngleSwing):
        per_speed, power = plant.cable_length_m / velocity_m_s, -2
        state = (initial.angle_rad, initial.angle_rate_rad_s)
    elif isinstance(initial, DeflectionSwing):
        per_speed, power = 1 / velocity_m_s, 0
        state = (initial.deflection_m, initial.deflection_rate_m_s)
    if state == (0.0, 0.0):
        return None
    deflection, rate = (per_speed * one for one in state)
    if not math.hypot(deflection, rate) <= MAX_VALUE:
        raise InvalidInputError(
            "initial", state, f"at most {MAX_VALUE:g} times the speed", code="swing_too_large"
        )
    return FreeSwing(deflection_s=deflection, rate=rate, frequency_power=power, delay_s=delay_s)
