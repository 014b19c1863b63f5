"""Residuals of a command that is held while plant, actuator or pulse change."""

import math

import numpy as np

from design.analysis.residual import residual_vibration
from design.analysis.residuals_of_many import residuals_of_cases, residuals_of_many
from design.errors import InvalidInputError
from design.maps.commands import design_command
from design.maps.map_case import Cell, MapCase, Move, Recipe
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.types import FloatArray


def residuals_of_held(case: MapCase, cells: list[list[Cell]]) -> FloatArray:
    """Return the residuals of one command over all cells.

    Parameters
    ----------
    case
        What is mapped, and the command that is held.
    cells
        Plant and actuator of each cell, rows of columns.

    Returns
    -------
    FloatArray
        Shape (rows, columns) [-].
    """
    command = _held_command(case)
    return np.array([_residuals_of_row(command, row) for row in cells])


def _held_command(case: MapCase) -> Impulses:
    """Return the command that is held: as given, or designed for plant and actuator as given."""
    if isinstance(case.shaper, Recipe):
        cell = {"plant": case.plant, "actuator": case.actuator, "move": case.move}
        return design_command(case.shaper, cell)
    if case.shaper is None:
        raise InvalidInputError(
            "shaper", None, f"given, for a map of {case.quantity}", code="shaper_missing"
        )
    return case.shaper


def residuals_of_re_timed(
    case: MapCase, move: Move, cells: list[list[Cell]], *, along_x: bool
) -> FloatArray:
    """Return the residuals of a held move with its stop re-timed.

    The stop follows the pulses of one axis.

    Parameters
    ----------
    case, move
        What is mapped, and its move as given.
    cells
        Rows of cells; along one axis only the pulse changes.
    along_x
        Whether that axis is x.

    Returns
    -------
    FloatArray
        Shape (rows, columns) [-]; not a number where the stop would begin before the start ends.

    Raises
    ------
    InvalidInputError
        If start and stop of the move as given overlap.
    """
    command = _held_command(case)
    half = command.times_s.size // 2
    if not math.isclose(command.times_s[half], move.pulse_s):
        raise InvalidInputError(
            "move.pulse_s",
            move.pulse_s,
            "so long that start and stop do not overlap",
            code="start_and_stop_overlap",
        )
    lines = cells if along_x else [list(line) for line in zip(*cells, strict=True)]
    pulses = np.array([cell["move"].pulse_s for cell in lines[0]])
    apart = pulses >= command.times_s[half - 1]
    times = np.tile(command.times_s, (int(np.count_nonzero(apart)), 1))
    times[:, half:] += (pulses[apart] - move.pulse_s)[:, None]
    residuals: FloatArray = np.full((len(lines), pulses.size), np.nan)
    for row, (cell, *_) in zip(residuals, lines, strict=True):
        poles = np.full(len(times), cell["plant"].mode.pole_rad_s)
        row[apart] = residuals_of_many(times, command.amplitudes, poles, cell["actuator"])
    return residuals if along_x else residuals.T


def _residuals_of_row(command: Impulses, cells: list[Cell]) -> FloatArray:
    """Return the residuals of one command for the plants and actuators of a row."""
    modes = [cell["plant"].mode for cell in cells]
    drives = [cell["actuator"] for cell in cells]
    if isinstance(drives[0], RateLimited):
        pairs = zip(modes, drives, strict=True)
        return np.array([residual_vibration(command, mode, drive) for mode, drive in pairs])
    lags = [(drive.accel_lag, drive.decel_lag) for drive in drives]
    return residuals_of_cases(
        command,
        np.array([mode.pole_rad_s for mode in modes]),
        np.array([[lag.first_s for lag in both] for both in lags]),
        np.array([[lag.second_s2 for lag in both] for both in lags]),
        drives[0].model,
    )
