"""A command played on a plant, in physical units."""

from dataclasses import dataclass

import numpy as np

from design.analysis.residual import residual_vibration
from design.analysis.unshaped import unshaped_deflection_s
from design.analysis.workable import RESONANCE
from design.checks import require_scale
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.moves.speed import require_speed
from design.moves.while_hoisting import require_no_limits
from design.response.closed_form import history
from design.response.hoisting_simulation import hoisting_history
from design.response.hoisting_vibration import hoisting_residual
from design.response.simulated_history import simulated_history
from design.types import FloatArray

MAX_SWINGS_AFTER = 1000.0
"""How long a simulation may go on after a hoisting, in swings of the last length [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Swing:
    """A swing of the payload against its support.

    Attributes
    ----------
    deflection_m
        Largest deflection, or the amplitude of a free vibration [m].
    angle_rad
        The same as an angle; None except for a pendulum [rad].
    """

    deflection_m: float
    angle_rad: float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """What a command does, and its residual.

    Attributes
    ----------
    times_s
        Times, shape (n,) [s].
    command_m_s, velocity_m_s
        Velocity commanded, and that of the actuator, shape (n,) [m/s].
    deflection_m
        Of the payload against its support, shape (n,) [m].
    angle_rad
        The same as an angle, shape (n,); None except for a pendulum [rad].
    peak
        Largest swing at these times.
    peak_velocity_m_s
        Largest magnitude of the actuator's velocity at these times [m/s].
    residual
        Residual vibration after the last step or ramp, a share of one unshaped step; None where a
        set of the actuator has its own pole at the plant's and rings with it [-].
    remaining
        Amplitude of that free vibration, extrapolated back to the last step or the end of the last
        ramp (and the dead time after it), or to the end of the hoisting; None if that is.
    """

    times_s: FloatArray
    command_m_s: FloatArray
    velocity_m_s: FloatArray
    deflection_m: FloatArray
    angle_rad: FloatArray | None
    peak: Swing
    peak_velocity_m_s: float
    residual: float | None
    remaining: Swing | None


def motion(
    plant: Plant, actuator: Actuator, command: Impulses, speed_m_s: float, times_s: FloatArray
) -> Motion:
    """Play a command, exact at each of the times.

    Parameters
    ----------
    plant, actuator
        What moves, and what drives it.
    command
        Steps of velocity, as shares of the speed.
    speed_m_s
        Full speed, > 0 [m/s].
    times_s
        Times, shape (n,) [s].

    Returns
    -------
    Motion
        Arrays of shape (n,), in physical units.

    Raises
    ------
    InvalidInputError
        If the speed is not > 0, or the limits of the actuator are for another; while a cable is
        hoisted, if the actuator has limits or the times end too late.
    """
    require_scale("speed_m_s", speed_m_s)
    require_speed(actuator, speed_m_s)
    if isinstance(plant, Hoisting):
        return _hoisted_motion(plant, actuator, command, speed_m_s, times_s)
    mode = plant.mode
    length_m = plant.cable_length_m if isinstance(plant, Pendulum) else None
    lags = (actuator.accel_lag, actuator.decel_lag)
    distances = [abs(lag.denominator(mode.pole_rad_s)) for lag in lags]
    rings_along = min(distances) < RESONANCE
    route = simulated_history if rings_along else history
    delayed = route(command, mode, actuator, times_s - actuator.dead_time_s)
    levels = np.concatenate(([0.0], np.cumsum(command.amplitudes)))
    deflection = delayed.deflection * speed_m_s / mode.natural_frequency_rad_s
    residual = None if rings_along else residual_vibration(command, mode, actuator)
    remaining = None
    if residual is not None:
        left_s = residual * unshaped_deflection_s(mode, actuator)
        remaining = _swing(speed_m_s * left_s, length_m)
    return Motion(
        times_s=times_s,
        command_m_s=speed_m_s * levels[np.searchsorted(command.times_s, times_s, side="right")],
        velocity_m_s=speed_m_s * delayed.velocity,
        deflection_m=deflection,
        angle_rad=None if length_m is None else deflection / length_m,
        peak=_swing(float(np.abs(deflection).max()), length_m),
        peak_velocity_m_s=speed_m_s * float(np.abs(delayed.velocity).max()),
        residual=residual,
        remaining=remaining,
    )


def _hoisted_motion(
    plant: Hoisting, actuator: Actuator, command: Impulses, speed_m_s: float, times_s: FloatArray
) -> Motion:
    """Play a command while the cable is hoisted, from time 0 of its course on."""
    require_no_limits(actuator)
    after_s = float(max(times_s[-1], command.times_s[-1] + actuator.dead_time_s)) - plant.end_s
    if after_s > MAX_SWINGS_AFTER * plant.last.mode.period_s:
        raise InvalidInputError(
            "until_s",
            float(times_s[-1]),
            f"no later than {MAX_SWINGS_AFTER:g} swings after the end of the hoisting, as any step",
            code="too_long_after_hoisting",
        )
    played = hoisting_history(command, plant, actuator, times_s)
    course, last = plant.cable_length_m, plant.last
    deflection = speed_m_s * played.deflection
    angle = deflection / np.interp(times_s, course.times_s, course.values)
    rings_along = any(
        abs(lag.denominator(last.mode.pole_rad_s)) < RESONANCE
        for lag in (actuator.accel_lag, actuator.decel_lag)
    )
    residual = None if rings_along else hoisting_residual(command, plant, actuator)
    remaining = None
    if residual is not None:
        left_m = speed_m_s * residual / last.mode.pole_rad_s.imag
        remaining = _swing(left_m, last.cable_length_m)
    return Motion(
        times_s=times_s,
        command_m_s=speed_m_s * played.command,
        velocity_m_s=speed_m_s * played.velocity,
        deflection_m=deflection,
        angle_rad=angle,
        peak=Swing(
            deflection_m=float(np.abs(deflection).max()), angle_rad=float(np.abs(angle).max())
        ),
        peak_velocity_m_s=speed_m_s * float(np.abs(played.velocity).max()),
        residual=residual,
        remaining=remaining,
    )


def _swing(deflection_m: float, length_m: float | None) -> Swing:
    return Swing(
        deflection_m=deflection_m, angle_rad=None if length_m is None else deflection_m / length_m
    )
