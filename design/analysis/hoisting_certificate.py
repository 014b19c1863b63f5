"""A second opinion on moves with a cable that is hoisted, step by step through time."""

import math

from design.analysis.certificate import STEP_PHASE_RAD, Certificate, Claim
from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting
from design.response.hoisting_simulation import simulated_vibration

METHOD = (
    "state of actuator and load carried through time by collocation at nodes of Radau with the "
    "length of each moment; derivatives from the same at frequencies beside its own"
)


def certify_hoisting(
    command: Impulses, plant: Hoisting, actuator: Actuator, promises: tuple[Promise, ...]
) -> Certificate:
    """Recompute what a command claims on a cable that is hoisted.

    Parameters
    ----------
    command
        The whole move; its times count from the moment that those of the hoisting do [s].
    plant, actuator
        The load on its cable, and a drive without limits to acceleration.
    promises
        A residual and a slope at most. The slope is the change of the vibration vector per
        relative one of all frequencies.

    Returns
    -------
    Certificate
        A claim for each promise, in their order; one that fails is in it, no error.
    """
    values = {}
    for promise in promises:
        if promise.quantity == "residual":
            values["residual"] = abs(simulated_vibration(command, plant, actuator))
        else:
            step = STEP_PHASE_RAD / max(1.0, turn_rad(command, plant))
            beside = [
                simulated_vibration(command, plant, actuator, math.exp(sign * step))
                for sign in (1.0, -1.0)
            ]
            values["slope"] = abs(beside[0] - beside[1]) / (2 * step)
    return Certificate(
        claims=tuple(
            Claim(quantity=one.quantity, value=values[one.quantity], limit=one.limit)
            for one in promises
        ),
        method=METHOD,
    )


def turn_rad(command: Impulses, plant: Hoisting) -> float:
    """Return the turn of the swing until command and hoisting are over.

    Parameters
    ----------
    command, plant
        As of `certify_hoisting`.

    Returns
    -------
    float
        From time 0 on, at least that much [rad].
    """
    later_s = max(0.0, float(command.times_s[-1]) - plant.end_s)
    return plant.hoisting_turn_rad + later_s * plant.last.mode.natural_frequency_rad_s
