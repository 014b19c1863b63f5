"""The time history of a command by matrix exponential, the second route to it."""

import numpy as np

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.reference_ramps import reference
from design.response.closed_form import History
from design.response.matrix_exponential import exponentials
from design.response.ramp_flows import ramp_flows
from design.response.simulation import dynamics_of, states_at_changes
from design.types import FloatArray


def simulated_history(
    impulses: Impulses, mode: Mode, actuator: Actuator, times_s: FloatArray
) -> History:
    """Return the time history of a command by matrix exponential.

    The second route to what `design.response.closed_form.history` returns.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive.
    times_s
        Times, shape (n,) [s]; before the first step all is at rest.

    Returns
    -------
    History
        All of shape (n,).
    """
    dynamics = dynamics_of(actuator, np.array([mode.natural_frequency_rad_s]), mode.damping_ratio)
    changes = reference(impulses, actuator)
    before, after = (states[:, 0] for states in states_at_changes(changes, dynamics))
    segment = np.searchsorted(changes.times_s, times_s, side="right") - 1
    moving = segment >= 0
    started = np.maximum(segment, 0)
    ramps = changes.ramps_s[started]
    elapsed = np.where(moving, times_s - changes.times_s[started], 0.0)
    sets = changes.accelerates.astype(int)[started]
    matrices = dynamics.matrices[sets]
    held = np.maximum(elapsed - ramps, 0.0)
    flow = exponentials(matrices[:, 0] * held[:, None, None])
    states = (flow @ after[started][..., None])[..., 0]
    reached = np.cumsum(changes.changes)[started]
    (during,) = np.nonzero(elapsed < ramps)
    if during.size:
        share = elapsed[during] / ramps[during]
        whole, bends = (part[started[during]] for part in (changes.changes, changes.bends))
        begun, grown = share * (1 - bends) * whole, 2 * bends * share**2 * whole
        reached[during] += begun + grown / 2 - whole
        units = (dynamics.jumps * dynamics.kept)[sets[during]]
        flows, pulls = ramp_flows(
            matrices[during], elapsed[during], begun[:, None] * units, grown[:, None] * units
        )
        states[during] = (flows[:, 0] @ before[started[during]][..., None])[..., 0] + pulls[:, 0]
    states = np.where(moving[:, None], states, 0.0)
    command = np.concatenate(([0.0], np.cumsum(impulses.amplitudes)))
    return History(
        times_s=times_s,
        command=command[np.searchsorted(impulses.times_s, times_s, side="right")],
        velocity=np.where(moving, reached, 0.0) + states[:, dynamics.coupled].sum(axis=1),
        deflection=-states[:, -1],
    )
