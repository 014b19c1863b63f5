"""What a program on samples must do."""

from dataclasses import dataclass

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode

MAX_EVALUATIONS = 800
"""Commands judged at most in search of one program behind limits: a second of work or two [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramTask:
    """What a program must do.

    Attributes
    ----------
    command
        Steps as shares of the speed, of levels >= 0, the first at 0 and to rest.
    mode, actuator, swing
        The plant's mode, its drive, and what the payload swings at the first step.
    sample_time_s
        Time between samples [s].
    slope
        Whether the slope of the residual is to be zero too.
    travel_s
        Way of the command behind the drive, over the speed [s].
    evaluations
        Commands judged at most in a search behind limits [-].
    """

    command: Impulses
    mode: Mode
    actuator: Actuator
    swing: FreeSwing | None
    sample_time_s: float
    slope: bool
    travel_s: float
    evaluations: int = MAX_EVALUATIONS
