"""Steps up and down that settle: as many as it takes."""

from dataclasses import replace

from design.formulations.equations import GapProblem
from design.formulations.gaps import PERIOD_RAD, settling_gaps_rad
from design.formulations.unity_magnitude import UnityMagnitude
from design.formulations.unity_magnitude_problem import unity_magnitude_problem
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode

MORE_STEPS = (2, 4, 6)
"""Steps beside those of the kind."""


def settled_steps(
    model: UnityMagnitude, mode: Mode, actuator: Actuator, *, max_duration_periods: float
) -> GapProblem:
    """Formulate a shaper whose steps settle.

    Where those of the kind do not do, it has more.

    A damped payload forgets the early steps, and a step that waits for the one before may come too
    late to be cancelled by as few as the kind has.

    Parameters
    ----------
    model, mode, actuator
        Steps and order of the kind; the plant's mode and its drive.
    max_duration_periods
        Longest shaper in undamped periods [-].

    Returns
    -------
    GapProblem
        Of the kind's steps, the longer ones with it.

    Raises
    ------
    InfeasibleDesignError
        If settling before each of the kind's switches takes longer than the longest shaper.
    """
    horizon = max_duration_periods * PERIOD_RAD
    problems = [
        unity_magnitude_problem(
            replace(model, impulses=count),
            mode,
            actuator,
            settle=True,
            max_duration_periods=max_duration_periods,
        )
        for count in (model.impulses, *(model.impulses + more for more in MORE_STEPS))
        if count == model.impulses
        or settling_gaps_rad(mode, actuator, count, settle=True).sum() <= horizon
    ]
    return replace(problems[0], longer=tuple(problems[1:]))
