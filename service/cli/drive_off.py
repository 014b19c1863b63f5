"""The residual behind a drive that is off, as a line of text."""

from collections.abc import Mapping

from design.analysis.drive_sensitivity import DriveRange, drive_sensitivity, parameters_of
from schemas.actuators import ActuatorIn
from schemas.drive_sensitivity import DriveOut
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn

USUAL = DriveRange(most=0.1, points=2)
"""By how much a drive is off where a request does not say it: measured, few are better known."""

BEHIND_LIMITS = "then."
"""Start of the names of parameters of what follows limits."""

NO_MORE = 1e-9
"""Residual above that with the drive as given which is rounding [-]."""


def usual_drive_off(
    impulses: ImpulsesWire, plant: PlantIn | None, actuator: ActuatorIn | None
) -> DriveOut | None:
    """Return the residual of a shaper whose drive is off by the usual share.

    Parameters
    ----------
    impulses, plant, actuator
        The shaper, and for what it is; None where that is not known.

    Returns
    -------
    DriveOut or None
        As an answer has it on request; None of a drive without parameters.
    """
    if plant is None or actuator is None or not parameters_of(actuator.to_design()):
        return None
    found = impulses.to_design(), plant.to_design().modes, actuator.to_design()
    return DriveOut.from_design(drive_sensitivity(*found, USUAL))


def drive_off_lines(found: DriveOut | None) -> list[str]:
    """Return a line on the residual at the largest share, if there is one.

    Parameters
    ----------
    found
        Residuals of a drive that is off; None where there are none.

    Returns
    -------
    list of str
        One line, or none.

    Examples
    --------
    >>> worst = {"accel_time_constant_s": 1.1, "decel_time_constant_s": 0.9}
    >>> drive_off_lines(DriveOut(off_by=[0, 0.1], residual=[0, 0.0303], worst_drive=worst))
    ['drive off   by 10 %: 3.03 % at worst (accel_time_constant_s larger, others smaller)']
    """
    if found is None:
        return []
    off = f"by {100 * found.off_by[-1]:g} %"
    if any(name.startswith(BEHIND_LIMITS) for name in found.worst_drive):
        off += " behind its limits"
    if found.residual[-1] - found.residual[0] <= NO_MORE:
        return [f"drive off   {off}: no more residual"]
    worst = _in_words(found.worst_drive)
    return [f"drive off   {off}: {100 * found.residual[-1]:.3g} % at worst ({worst})"]


def _in_words(worst: Mapping[str, float]) -> str:
    """Name the parameters that are larger: the others are smaller."""
    larger = [name.removeprefix(BEHIND_LIMITS) for name, factor in worst.items() if factor > 1]
    if not larger:
        return "all smaller"
    names = ", ".join(larger)
    return "all larger" if len(larger) == len(worst) else f"{names} larger, others smaller"
