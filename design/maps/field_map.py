"""What a shaper leaves, or what it is, over one or two fields of plant, actuator and move."""

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from design.analysis.residual import (
    residual_vibration,
    residuals_of_cases,
    residuals_of_many,
    unshaped_deflection_s,
)
from design.errors import InfeasibleDesignError, InvalidInputError
from design.fields import Axis, vary
from design.formulations.unity_magnitude import PERIOD_RAD, decel_over_accel
from design.model.actuators import Actuator, FirstOrder, Model, RateLimited, SecondOrder
from design.model.impulses import Impulses
from design.model.plants import Plant
from design.moves.maneuvers import maneuver, mirrored_stop
from design.pipeline import design
from design.shapers.kind import ShaperKind
from design.types import FloatArray, require_scale

MOST_CELLS = 20_000
"""Largest map of a command that is held, or of gains [cells]."""

MOST_DESIGNS = 2_000
"""Largest map whose every cell is designed [cells]."""

MOST_MOVES = 500
"""Largest map in whose every cell a whole move is solved, up to 50 ms each [cells]."""

WHOLE_TURN_MARGIN = 1e-6
"""How near to whole the turns of a closed form must come: its rounding, with room to spare [-]."""

Quantity = Literal[
    "residual", "deflection_m", "times_s", "duration_s", "branch", "alpha", "beta_rad"
]
"""What a map tells; `Map.values` says what each is."""

OF_DESIGNS = ("times_s", "duration_s", "branch")
"""Quantities of the shaper itself, which is designed in every cell."""

OF_ACTUATORS = ("alpha", "beta_rad")
"""Quantities of plant and actuator, without a shaper."""

BRANCHED = ("numzv", "umzvc")
"""Kinds whose closed form has branches."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """A start and a stop.

    Attributes
    ----------
    pulse_s
        From the first step of the start to the first step of the stop, > 0 [s].
    stop
        ``solved`` for the actuator whose sets have changed places; ``mirrored``, the gaps of the
        start in reverse order (Kim 2011, 3.56-3.59).
    """

    pulse_s: float
    stop: Literal["solved", "mirrored"] = "solved"

    def __post_init__(self) -> None:
        require_scale("pulse_s", self.pulse_s)


@dataclass(frozen=True, slots=True, kw_only=True)
class Recipe:
    """A shaper that is yet to be designed.

    Attributes
    ----------
    kind, options
        Entry of the registry, and its parameters.
    each
        Whether it is designed anew in every cell; else once, for plant and actuator as given.
    designed_for
        Model of the actuator that it is designed for; None for the actuator's own, by which it is
        always judged.
    """

    kind: ShaperKind
    options: Any
    each: bool
    designed_for: Model | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class MapCase:
    """What is mapped.

    Attributes
    ----------
    plant, actuator
        What the fields are varied in.
    shaper
        A command that is held, a shaper to design, or None where the quantity needs none.
    move
        The move that the shaper starts and stops; None for the shaper alone.
    quantity
        What is told.
    speed_m_s
        Full speed, for a deflection [m/s].
    """

    plant: Plant
    actuator: Actuator
    shaper: Impulses | Recipe | None = None
    move: Move | None = None
    quantity: Quantity = "residual"
    speed_m_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Map:
    """A map.

    Attributes
    ----------
    quantity
        What is told.
    values
        Shape (len(y), len(x), k), one row without y; not a number where a cell has no such shaper
        or move. k is 1, but for ``times_s``, the times of all impulses, and ``branch``, n, m and
        the sign of `closed_form_branch`.
        ``residual``: share of an unshaped step [-]. ``deflection_m``: the same at the payload [m].
        ``duration_s``: first to last impulse [s]. ``alpha``, ``beta_rad``: magnitude and lag of
        G_decel/G_accel at the plant's pole [-], [rad].
    """

    quantity: Quantity
    values: FloatArray


Cell = dict[str, Any]
"""Plant, actuator and, in a move, ``move``, with the values of one cell."""


def field_map(case: MapCase, x: Axis, y: Axis | None = None) -> Map:
    """Return a quantity over one or two fields.

    A command that is held shows what errors of the fields cost. Over the pulse of a held move
    only the stop is re-timed; where it would begin before the start has ended there is no cell.

    Parameters
    ----------
    case
        What is mapped.
    x, y
        The axes; without y, a curve.

    Raises
    ------
    InvalidInputError
        If both axes are one field, a value breaks its rule, the map is too large, or the quantity
        does not go with the rest.
    InfeasibleDesignError
        If a shaper that is designed once does not exist.

    Examples
    --------
    >>> from design.fields import Axis
    >>> from design.model.actuators import Ideal
    >>> from design.model.plants import Pendulum
    >>> from design.shapers.registry import SHAPERS
    >>> umzv = SHAPERS["umzv"]
    >>> recipe = Recipe(kind=umzv, options=umzv.options(), each=True)
    >>> case = MapCase(
    ...     plant=Pendulum(cable_length_m=0.8), actuator=Ideal(), shaper=recipe,
    ...     quantity="duration_s",
    ... )
    >>> lengths = Axis(path=("plant", "cable_length_m"), values=np.array([0.2, 0.8]))
    >>> field_map(case, lengths).values[0, :, 0].round(3).tolist()
    [0.299, 0.598]
    """
    _require_consistent(case)
    _require_bounded(case, x, y)
    whole: Cell = {"plant": case.plant, "actuator": case.actuator}
    if case.move is not None:
        whole["move"] = case.move
    rows = [whole] if y is None else [_with(whole, y, "y", value) for value in y.values.tolist()]
    cells = [[_with(row, x, "x", value) for value in x.values.tolist()] for row in rows]
    return Map(quantity=case.quantity, values=_values(case, cells, x, y))


def closed_form_branch(impulses: Impulses, plant: Plant, actuator: Actuator) -> FloatArray:
    """Return n, m and the sign of an undamped three-impulse shaper's closed form, shape (3,).

    ``w t2 = sign acos(alpha / 2) - beta + 2 pi n``, ``w t3 = sign 2 acos(alpha / 2) + 2 pi m``
    (Kim 2011, 3.34-3.35, which has the sign + only).

    Raises
    ------
    InvalidInputError
        If the times are on no branch.
    """
    ratio = decel_over_accel(plant.mode, actuator)
    alpha, beta = abs(ratio), -math.atan2(ratio.imag, ratio.real)
    phases = plant.mode.natural_frequency_rad_s * impulses.times_s
    if impulses.times_s.size == 3 and alpha <= 2:  # noqa: PLR2004 - of the closed form
        for sign in (1.0, -1.0):
            half = sign * math.acos(alpha / 2)
            turns = (phases[1:] - [half - beta, 2 * half]) / PERIOD_RAD
            whole = np.round(turns)
            if np.abs(turns - whole).max() < WHOLE_TURN_MARGIN:
                return np.array([*whole, sign])
    raise InvalidInputError(
        "quantity",
        "branch",
        f"asked of {' or '.join(BRANCHED)}, of an undamped plant behind superposed steps",
    )


def _require_consistent(case: MapCase) -> None:
    """Refuse a quantity that does not go with the rest, naming the field at fault."""
    recipe = case.shaper if isinstance(case.shaper, Recipe) else None
    quantity = case.quantity
    if quantity in OF_ACTUATORS:
        for name, given in (("shaper", case.shaper), ("move", case.move)):
            if given is not None:
                raise InvalidInputError(
                    name, "given", f"left out: {quantity} is of plant and actuator"
                )
    if quantity in OF_DESIGNS and (recipe is None or not recipe.each):
        raise InvalidInputError(
            "design", "once", f"each, for a map of {quantity}: what is held is alike in every cell"
        )
    if quantity == "branch" and (
        recipe is None or recipe.kind.name not in BRANCHED or case.move is not None
    ):
        raise InvalidInputError("quantity", "branch", f"asked of {' or '.join(BRANCHED)} alone")
    if case.move is not None and recipe is None and case.shaper is not None:
        raise InvalidInputError("move", "given", "left out, or impulses replaced by a shaper")
    if (case.speed_m_s is not None) != (quantity == "deflection_m"):
        raise InvalidInputError(
            "speed_m_s", case.speed_m_s, "given for a map of deflection_m, and for no other"
        )
    if case.speed_m_s is not None:
        require_scale("speed_m_s", case.speed_m_s)
    if recipe is not None and recipe.designed_for is not None:
        _drive(recipe, case.actuator)


def _require_bounded(case: MapCase, x: Axis, y: Axis | None) -> None:
    if y is not None and x.path == y.path:
        raise InvalidInputError("y.field", "/".join(y.path), "another field than that of x")
    cells = x.values.size * (1 if y is None else y.values.size)
    most = MOST_CELLS
    if isinstance(case.shaper, Recipe) and case.shaper.each:
        most = MOST_DESIGNS if case.move is None else MOST_MOVES
    if cells > most:
        raise InvalidInputError("x.points", f"{cells} cells", f"of a map of at most {most} cells")


def _with(whole: Cell, axis: Axis, name: str, value: float) -> Cell:
    part, *path = axis.path
    if part not in whole or not path:
        raise InvalidInputError(
            f"{name}.field", "/".join(axis.path), f"a number of {' or '.join(whole)} as given"
        )
    try:
        return {**whole, part: vary(whole[part], path, value)}
    except InvalidInputError as error:
        if error.name == "field":
            raise error.within(name) from None
        raise InvalidInputError(f"{name}.values", value, error.rule) from None


def _values(case: MapCase, cells: list[list[Cell]], x: Axis, y: Axis | None) -> FloatArray:
    """Return the values of all cells, shape (rows, columns, k)."""
    if case.quantity in OF_ACTUATORS:
        ratios = np.array([
            [decel_over_accel(cell["plant"].mode, cell["actuator"]) for cell in row]
            for row in cells
        ])
        gains: FloatArray = np.abs(ratios) if case.quantity == "alpha" else -np.angle(ratios)
        return gains[..., None]
    if isinstance(case.shaper, Recipe) and case.shaper.each:
        return _of_designs(case, case.shaper, cells)
    over_pulses = any(axis is not None and axis.path[0] == "move" for axis in (x, y))
    if case.move is not None and over_pulses:
        residuals = _re_timed(case, case.move, cells, along_x=x.path[0] == "move")
    else:
        command = _held_command(case)
        residuals = np.array([_held(command, row) for row in cells])
    if case.quantity == "deflection_m":
        residuals *= [[_unshaped_m(case, cell) for cell in row] for row in cells]
    return residuals[..., None]


def _held_command(case: MapCase) -> Impulses:
    """Return the command that is held: as given, or designed for plant and actuator as given."""
    if isinstance(case.shaper, Recipe):
        cell = {"plant": case.plant, "actuator": case.actuator, "move": case.move}
        return _command(case.shaper, cell)
    if case.shaper is None:
        raise InvalidInputError("shaper", None, f"given, for a map of {case.quantity}")
    return case.shaper


def _of_designs(case: MapCase, recipe: Recipe, cells: list[list[Cell]]) -> FloatArray:
    """Return a quantity of the command that is designed anew in each cell."""
    found = [[_told(case, recipe, cell) for cell in row] for row in cells]
    width = max(values.size for row in found for values in row)
    told: FloatArray = np.full((len(found), len(found[0]), width), np.nan)
    for row, of_row in zip(told, found, strict=True):
        for at, values in zip(row, of_row, strict=True):
            at[: values.size] = values
    return told


def _told(case: MapCase, recipe: Recipe, cell: Cell) -> FloatArray:
    plant, actuator = cell["plant"], cell["actuator"]
    try:
        command = _command(recipe, cell)
    except InfeasibleDesignError:
        return np.array([np.nan])
    match case.quantity:
        case "times_s":
            return command.times_s
        case "duration_s":
            return np.array([command.duration_s])
        case "branch":
            return closed_form_branch(command, plant, _drive(recipe, actuator))
    residual = residual_vibration(command, plant.mode, actuator)
    unit = _unshaped_m(case, cell) if case.quantity == "deflection_m" else 1.0
    return np.array([unit * residual])


def _unshaped_m(case: MapCase, cell: Cell) -> float:
    """Return the amplitude that the unshaped step leaves at the payload [m]."""
    return (case.speed_m_s or 0.0) * unshaped_deflection_s(cell["plant"].mode, cell["actuator"])


def _drive(recipe: Recipe, actuator: Actuator) -> Actuator:
    """Return the actuator that the shaper is designed for."""
    if recipe.designed_for is None:
        return actuator
    if isinstance(actuator, FirstOrder | SecondOrder):
        return replace(actuator, model=recipe.designed_for)
    raise InvalidInputError(
        "designed_for", recipe.designed_for, f"left out: one of kind {actuator.kind} has no model"
    )


def _command(recipe: Recipe, cell: Cell) -> Impulses:
    """Design the shaper, or the whole move, of one cell."""
    move, drive = cell.get("move"), _drive(recipe, cell["actuator"])
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
            "mirror image would begin before it ends"
        )
    stop = mirrored_stop(start)
    return Impulses(
        times_s=np.concatenate((start.times_s, pulse_s + stop.times_s)),
        amplitudes=np.concatenate((start.amplitudes, stop.amplitudes)),
    )


def _re_timed(case: MapCase, move: Move, cells: list[list[Cell]], *, along_x: bool) -> FloatArray:
    """Return the residuals of a held move whose stop is re-timed over the pulses of one axis."""
    command = _held_command(case)
    half = command.times_s.size // 2
    if not math.isclose(command.times_s[half], move.pulse_s):
        raise InvalidInputError(
            "move.pulse_s", move.pulse_s, "so long that start and stop do not overlap"
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


def _held(command: Impulses, cells: list[Cell]) -> FloatArray:
    """Return the residuals of one command for many plants and actuators, at once."""
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
