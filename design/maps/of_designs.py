"""Quantities of a command that is designed anew in every cell."""

import numpy as np

from design.analysis.residual import residual_vibration
from design.errors import InfeasibleDesignError
from design.maps.branch import closed_form_branch
from design.maps.commands import design_command, drive_designed_for
from design.maps.map_case import Cell, Quantity, Recipe
from design.types import FloatArray


def quantities_of_designs(
    quantity: Quantity, recipe: Recipe, cells: list[list[Cell]]
) -> FloatArray:
    """Return a quantity of the command designed anew in each cell.

    Parameters
    ----------
    quantity
        What is mapped.
    recipe
        How commands are designed.
    cells
        Plant, actuator and move of each cell, rows of columns.

    Returns
    -------
    FloatArray
        Shape (rows, columns, k), as `design.maps.map_case.Map.values`; for ``deflection_m`` the
        residual, which is yet to be scaled.
    """
    found = [[_quantity_of_cell(quantity, recipe, cell) for cell in row] for row in cells]
    width = max(values.size for row in found for values in row)
    padded: FloatArray = np.full((len(found), len(found[0]), width), np.nan)
    for row, of_row in zip(padded, found, strict=True):
        for at, values in zip(row, of_row, strict=True):
            at[: values.size] = values
    return padded


def _quantity_of_cell(quantity: Quantity, recipe: Recipe, cell: Cell) -> FloatArray:
    """Return the values of one cell, shape (k,); not a number where it has no such command."""
    plant, actuator = cell["plant"], cell["actuator"]
    try:
        command = design_command(recipe, cell)
    except InfeasibleDesignError:
        return np.array([np.nan])
    match quantity:
        case "times_s":
            return command.times_s
        case "duration_s":
            return np.array([command.duration_s])
        case "branch":
            return closed_form_branch(command, plant, drive_designed_for(recipe, actuator))
    return np.array([residual_vibration(command, plant.mode, actuator)])
