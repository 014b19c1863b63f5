"""The command of one cell: a shaper or a whole move, designed."""

from dataclasses import replace

import numpy as np

from design.errors import InfeasibleDesignError, InvalidInputError
from design.maps.map_case import Cell, Recipe
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.impulses import Impulses
from design.moves.maneuvers import maneuver
from design.moves.parts import mirrored_stop
from design.pipeline import design


def drive_designed_for(recipe: Recipe, actuator: Actuator) -> Actuator:
    """Return the actuator that the shaper is designed for.

    Parameters
    ----------
    recipe
        How commands are designed.
    actuator
        The actuator of the cell.

    Returns
    -------
    Actuator
        The one given, of the model that the recipe asks for if it asks for one.

    Raises
    ------
    InvalidInputError
        If the recipe asks for a model and the actuator has none.
    """
    if recipe.designed_for is None:
        return actuator
    if isinstance(actuator, FirstOrder | SecondOrder):
        return replace(actuator, model=recipe.designed_for)
    raise InvalidInputError(
        "designed_for",
        recipe.designed_for,
        f"left out: one of kind {actuator.kind} has no model",
        code="no_model_to_design_for",
    )


def design_command(recipe: Recipe, cell: Cell) -> Impulses:
    """Design the shaper, or the whole move, of one cell.

    Parameters
    ----------
    recipe
        How commands are designed.
    cell
        Plant, actuator and, of a map of moves, the move.

    Returns
    -------
    Impulses
        A shaper of sum 1, or a whole move of sum 0.

    Raises
    ------
    InvalidInputError
        If a value of the cell breaks its rule.
    InfeasibleDesignError
        If the cell has no such shaper or move.
    """
    move, drive = cell.get("move"), drive_designed_for(recipe, cell["actuator"])
    if move is None or move.stop == "mirrored":
        start = design(cell["plant"], drive, recipe.kind, recipe.options).impulses
        return start if move is None else _with_mirrored_stop(start, move.pulse_s)
    return maneuver(
        cell["plant"],
        drive,
        recipe.kind,
        # The command is in shares of it.
        speed_m_s=drive.speed_m_s if isinstance(drive, RateLimited) else 1.0,
        pulse_s=move.pulse_s,
        options=recipe.options,
    ).command


def _with_mirrored_stop(start: Impulses, pulse_s: float) -> Impulses:
    if pulse_s < start.duration_s:
        raise InfeasibleDesignError(
            f"the pulse of {pulse_s:g} s is shorter than the start, {start.duration_s:g} s: its "
            "mirror image would begin before it ends",
            code="pulse_shorter_than_start",
        )
    stop = mirrored_stop(start)
    return Impulses(
        times_s=np.concatenate((start.times_s, pulse_s + stop.times_s)),
        amplitudes=np.concatenate((start.amplitudes, stop.amplitudes)),
    )
