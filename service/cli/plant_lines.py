"""Plant and drive of a request in the words of those who measure them: hertz, periods, lengths."""

from math import degrees, tau

from pydantic import TypeAdapter

from design.model.actuators.in_words import drive_line, has_sets
from design.model.plants.free_body import FreeBody
from schemas.actuators import ActuatorIn
from schemas.large_swings import LargeSwingOut
from schemas.plants import (
    DoublePendulumIn,
    FreeBodyIn,
    HoistingIn,
    ModesIn,
    PendulumIn,
    PlantIn,
    ScheduledIn,
    SpringMassIn,
)

PLANTS: TypeAdapter[PlantIn] = TypeAdapter(PlantIn)
DRIVES: TypeAdapter[ActuatorIn] = TypeAdapter(ActuatorIn)

ASK_FOR_MODEL = 'no model was given; a drive with one speed is better described by "switched"'


def large_swing_lines(swing: LargeSwingOut | None) -> list[str]:
    """Return of which swing a design is, where it is a large one."""
    if swing is None:
        return []
    angle = degrees(swing.largest_angle_rad)
    return [f"swing       up to {angle:.4g} degrees, nonlinear, exact at {swing.speed_m_s:g} m/s"]


def plant_lines(plant: PlantIn) -> list[str]:
    """Return a line for the plant, or one for each of its modes.

    Returns
    -------
    list of str
        With hertz and periods; a range of a scheduled plant is one line.

    Examples
    --------
    >>> crane = PLANTS.validate_python({"kind": "pendulum", "cable_length_m": 0.8})
    >>> plant_lines(crane)
    ['plant       pendulum, cable 0.8 m, 0.55723 Hz, period 1.7946 s']
    """
    if isinstance(plant, ModesIn | DoublePendulumIn | FreeBodyIn):
        made = plant.to_design()
        modes = made.excited if isinstance(made, FreeBody) else made.modes
        return [
            f"mode {number:<7}{_swing(one.natural_frequency_rad_s, one.damping_ratio)}"
            for number, one in enumerate(modes, start=1)
        ]
    if isinstance(plant, ScheduledIn):
        range_ = plant.to_design()
        ends = sorted(end.mode.natural_frequency_rad_s / tau for end in (range_.first, range_.last))
        return [
            f"plant       {plant.plant.kind}, {plant.over} from {plant.from_:g} to {plant.to:g}, "
            f"{ends[0]:.5g} to {ends[1]:.5g} Hz, period {1 / ends[1]:.5g} to {1 / ends[0]:.5g} s"
        ]
    if isinstance(plant, HoistingIn):
        course, moved = plant.cable_length_m, plant.to_design()
        ends = [
            moved.at(time_s).mode.natural_frequency_rad_s / tau for time_s in (0.0, moved.end_s)
        ]
        return [
            f"plant       cable hoisted from {course.values[0]:g} to {course.values[-1]:g} m until "
            f"{course.times_s[-1]:g} s, {ends[0]:.5g} to {ends[1]:.5g} Hz"
        ]
    what = ""
    if isinstance(plant, PendulumIn):
        what = f"cable {plant.cable_length_m:g} m, "
    elif isinstance(plant, SpringMassIn):
        what = f"{plant.mass_kg:g} kg, {plant.stiffness_n_m:g} N/m, "
    mode = plant.to_design().mode
    swing = _swing(mode.natural_frequency_rad_s, mode.damping_ratio)
    return [f"plant       {plant.kind}, {what}{swing}"]


def drive_lines(actuator: ActuatorIn) -> list[str]:
    r"""Return a line for the drive, and one that asks for its model.

    Parameters
    ----------
    actuator
        The drive.

    Returns
    -------
    list of str
        The second line only where none was given and the two sets differ.

    Examples
    --------
    >>> lag = {"kind": "first_order", "accel_time_constant_s": 0.1, "decel_time_constant_s": 0.05}
    >>> print("\n".join(drive_lines(DRIVES.validate_python(lag))))
    drive       first order, accel time constant 0.1 s, decel time constant 0.05 s, superposed
                no model was given; a drive with one speed is better described by "switched"
    """
    drive = actuator.to_design()
    lines = [f"drive       {drive_line(drive)}"]
    given = {*actuator.model_fields_set, *getattr(actuator, "then", actuator).model_fields_set}
    if has_sets(drive) and "model" not in given and drive.accel_lag != drive.decel_lag:
        lines.append(f"            {ASK_FOR_MODEL}")
    return lines


def only_hertz(plant: PlantIn) -> float | None:
    """Return the natural frequency of a plant that has only one [Hz]."""
    if isinstance(plant, ModesIn | DoublePendulumIn | FreeBodyIn | ScheduledIn | HoistingIn):
        return None
    return plant.to_design().mode.natural_frequency_rad_s / tau


def _swing(frequency_rad_s: float, damping_ratio: float) -> str:
    damped = f", damping ratio {damping_ratio:g}" if damping_ratio else ""
    return f"{frequency_rad_s / tau:.5g} Hz, period {tau / frequency_rad_s:.5g} s{damped}"
