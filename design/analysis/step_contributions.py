"""What each change of the reference adds to the vibration, apart from the plant."""

from dataclasses import dataclass

import numpy as np

from design.analysis.passed_on_state import pass_on_state
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.ramps import Reference
from design.model.reference_ramps import reference
from design.response.closed_form import states_of
from design.types import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class StepContributions:
    """What each change of the reference adds to the vibration, apart from the plant.

    ``V exp(s t_e) = sum (gain_i + s rate_i) G(s) exp(s (t_e - t_i))``, over both sets, t_e the
    last step or the end of the last ramp; a ramp's height counts `ramp_factors` times.
    """

    until_end_s: FloatArray  # Time from the start of each change to the end of all, shape (n,) [s]
    # Gains by the sets, accel before decel, then, if any, their rates, shape (n, 2) or (n, 4)
    columns: FloatArray
    ramps: Reference | None = None  # The changes, where they are ramps; None for steps
    # Gains that are a ramp's height and not in ``columns``, shape (n, 2); None for steps
    heights: FloatArray | None = None


def step_contributions(impulses: Impulses, actuator: Actuator) -> StepContributions:
    """Return what each change of the reference adds to the vibration.

    A superposed step adds its height by its own set. A switched actuator's state is taken from the
    old set and given to the new, and each would let it ring in its own way.

    Parameters
    ----------
    impulses, actuator
        The command, and the actuator, of either model, with limits or without.

    Returns
    -------
    StepContributions
        Of n changes, in closed form and for any plant.
    """
    changes = reference(impulses, actuator)
    until_end = changes.times_s[-1] + changes.ramps_s[-1] - changes.times_s
    heights = heights_by_set(changes)
    limited = isinstance(actuator, RateLimited)
    if actuator.model == "superposed":
        columns = np.zeros_like(heights) if limited else heights
    else:
        second = np.array([[lag.second_s2 for lag in (actuator.accel_lag, actuator.decel_lag)]])
        columns = pass_on_state(states_of(changes, actuator), changes, second)[0]
        if not limited:
            columns[:, :2] += heights
    if not limited:
        return StepContributions(until_end, columns)
    return StepContributions(until_end, columns, changes, heights)


def heights_by_set(changes: Reference) -> FloatArray:
    """Return the changes by set, shape (n, 2)."""
    heights = np.zeros((changes.changes.size, 2))
    heights[:, 0] = np.where(changes.accelerates, changes.changes, 0.0)
    heights[:, 1] = changes.changes - heights[:, 0]
    return heights
