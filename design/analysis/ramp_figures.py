"""What limits to acceleration make of a command, in figures: when its last ramp ends."""

from dataclasses import dataclass

from design.analysis.unshaped import unshaped_ramp_residual
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.reference_ramps import reference


@dataclass(frozen=True, slots=True, kw_only=True)
class RampFigures:
    """Figures of a command behind limits.

    Attributes
    ----------
    end_s
        When the last ramp ends, after the first step [s].
    unshaped_residual
        Residual of the ramp of an unshaped step, a share of the step without limits; of several
        modes the largest [-].
    """

    end_s: float
    unshaped_residual: float


def ramp_figures(impulses: Impulses, modes: tuple[Mode, ...], actuator: RateLimited) -> RampFigures:
    """Return the figures of a command behind limits.

    Parameters
    ----------
    impulses
        The command.
    modes, actuator
        The plant's modes, and the limits.

    Returns
    -------
    RampFigures
        End of the last ramp, and the residual of an unshaped one.
    """
    return RampFigures(
        end_s=moving_time_s(impulses, actuator),
        unshaped_residual=max(unshaped_ramp_residual(mode, actuator) for mode in modes),
    )


def end_of_reference(command: Impulses, actuator: Actuator) -> float:
    """Return when the reference has come to rest.

    Parameters
    ----------
    command, actuator
        The command, and what follows it.

    Returns
    -------
    float
        On the command's clock [s].
    """
    changes = reference(command, actuator)
    return float(changes.times_s[-1] + changes.ramps_s[-1])


def moving_time_s(command: Impulses, actuator: Actuator) -> float:
    """Return how long a command moves the reference.

    Parameters
    ----------
    command, actuator
        The command, and what follows it.

    Returns
    -------
    float
        From the first step to the last, or to the end of the last ramp [s].
    """
    return end_of_reference(command, actuator) - float(command.times_s[0])
