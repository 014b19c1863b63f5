"""Plant, drive and figures in the words of a picture's head."""

from collections.abc import Sequence

from design.claims import ZERO_LIMITS
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.free_body import FreeBody
from design.model.plants.hoisting import Hoisting
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.pictures.style import percent

LONG_NAMES = 3
"""Modes up to which a legend has room for the word [-]."""


def frequency_hz(mode: Mode) -> float:
    """Return the natural frequency of a mode [Hz]."""
    return 1 / mode.period_s


def plant_in_words(plant: Plant) -> tuple[str, str]:
    r"""Return a plant's frequency, and on two lines what else is known of it.

    Returns
    -------
    tuple of str
        The natural frequency in Hz; then the period and the cable length, or of several modes the
        range of their frequencies, and the damping ratio.

    Examples
    --------
    >>> plant_in_words(Pendulum(cable_length_m=0.8, gravity_m_s2=9.81))
    ('0.5573 Hz, period 1.794 s', '3.502 rad/s, cable 0.8 m\ndamping ratio 0')
    """
    if isinstance(plant, FreeBody):
        each = ", ".join(f"{frequency_hz(mode):.4g}" for mode in plant.excited)
        return f"{plant.mass_kg:.4g} kg, free", f"modes at {each} Hz"
    if isinstance(plant, Hoisting):
        course = plant.cable_length_m
        ends = [frequency_hz(plant.at(time_s).mode) for time_s in (0.0, plant.end_s)]
        return (
            f"{ends[0]:.4g} to {ends[1]:.4g} Hz",
            f"cable {course.values[0]:.4g} to {course.values[-1]:.4g} m until {plant.end_s:.4g} s"
            f"\ndamping ratio {plant.damping_ratio:.3g}",
        )
    modes = plant.modes
    if len(modes) > 1:
        frequencies = [frequency_hz(mode) for mode in modes]
        ratios = [mode.damping_ratio for mode in modes]
        spread = f"{min(ratios):.3g} to {max(ratios):.3g}"
        return (
            f"{len(modes)} modes",
            f"{min(frequencies):.4g} to {max(frequencies):.4g} Hz\ndamping ratio "
            + (spread if min(ratios) < max(ratios) else f"{ratios[0]:.3g}"),
        )
    (mode,) = modes
    value = f"{frequency_hz(mode):.4g} Hz, period {mode.period_s:.4g} s"
    if isinstance(plant, Scheduled):
        lowest, highest = (frequency_hz(mode) * ratio for ratio in plant.band)
        value = f"{lowest:.4g} to {highest:.4g} Hz"
        first = f"middle {mode.natural_frequency_rad_s:.4g} rad/s{_cable(plant)}"
    else:
        first = f"{mode.natural_frequency_rad_s:.4g} rad/s{_cable(plant)}"
    return value, f"{first}\ndamping ratio {mode.damping_ratio:.3g}"


def _cable(plant: Plant) -> str:
    """Return the length of the cable, where there is one."""
    if isinstance(plant, Pendulum):
        return f", cable {plant.cable_length_m:.4g} m"
    if isinstance(plant, Scheduled) and isinstance(plant.first, Pendulum):
        ends = [
            end.cable_length_m for end in (plant.first, plant.last) if isinstance(end, Pendulum)
        ]
        return f", cable {min(ends):.4g} to {max(ends):.4g} m"
    return ""


def actuator_in_words(actuator: Actuator) -> tuple[str, str]:
    """Return an actuator's name with its model, and its parameters.

    Returns
    -------
    tuple of str
        The parameters on lines. An ideal actuator has no model: its sets are alike.
    """
    name, parameters = actuator.in_words
    if isinstance(actuator, RateLimited):
        ideal = isinstance(actuator.then, Ideal)
        return name, parameters if ideal else f"{parameters}\n{actuator.model}"
    return (name if isinstance(actuator, Ideal) else f"{name}, {actuator.model}"), parameters


def modes_in_words(modes: Sequence[Mode]) -> list[str]:
    """Return the names of several modes, numbered as in a request."""
    name = "mode {}, {:.3g} Hz" if len(modes) <= LONG_NAMES else "{}: {:.3g} Hz"
    return [name.format(number, frequency_hz(mode)) for number, mode in enumerate(modes)]


def residual_in_words(residual: float) -> str:
    """Return a residual as a percentage, or below which one it is zero."""
    limit = ZERO_LIMITS["residual"]
    return f"below {percent(limit)}" if residual <= limit else percent(residual)
