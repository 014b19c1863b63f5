"""The residual, the times or the gains over one or two fields of plant, actuator and move."""

import numpy as np

from design.analysis.unshaped import unshaped_deflection_s
from design.checks import require_scale
from design.errors import InvalidInputError
from design.fields import Axis, vary
from design.formulations.lag_parameters import decel_over_accel
from design.maps.branch import BRANCHED
from design.maps.commands import drive_designed_for
from design.maps.held import residuals_of_held, residuals_of_re_timed
from design.maps.map_case import OF_ACTUATORS, OF_DESIGNS, Cell, Map, MapCase, Recipe
from design.maps.of_designs import quantities_of_designs
from design.shapers.refusals import require_small_swings
from design.types import FloatArray

MAX_CELLS = 20_000
"""Largest map of a command that is held, or of gains [cells]."""

MAX_DESIGNS = 2_000
"""Largest map whose every cell is designed [cells]."""

MAX_MOVES = 500
"""Largest map in whose every cell a whole move is solved, up to 50 ms each [cells]."""


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

    Returns
    -------
    Map
        Values of shape (rows, columns, k); not a number where a cell has none.

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
    >>> from design.maps.map_case import Recipe
    >>> from design.model.actuators.ideal import Ideal
    >>> from design.model.plants.pendulum import Pendulum
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


def _require_consistent(case: MapCase) -> None:
    """Refuse a quantity that does not go with the rest, naming the field at fault."""
    recipe = case.shaper if isinstance(case.shaper, Recipe) else None
    quantity = case.quantity
    if recipe is not None:
        require_small_swings(recipe.kind, "maps")
    if quantity in OF_ACTUATORS:
        for name, given in (("shaper", case.shaper), ("move", case.move)):
            if given is not None:
                raise InvalidInputError(
                    name,
                    "given",
                    f"left out: {quantity} is of plant and actuator alone",
                    code="quantity_of_plant_alone",
                )
    if quantity in OF_DESIGNS and (recipe is None or not recipe.each):
        raise InvalidInputError(
            "design",
            "once",
            f"each, for a map of {quantity}: a held command is the same in every cell",
            code="design_per_cell_only",
        )
    if quantity == "branch" and (
        recipe is None or not recipe.kind.has_branches or case.move is not None
    ):
        raise InvalidInputError(
            "quantity", "branch", f"asked of {BRANCHED} alone", code="branch_of_other_kind"
        )
    if case.move is not None and recipe is None and case.shaper is not None:
        raise InvalidInputError(
            "move", "given", "left out, or impulses replaced by a shaper", code="move_of_impulses"
        )
    if (case.speed_m_s is not None) != (quantity == "deflection_m"):
        raise InvalidInputError(
            "speed_m_s",
            case.speed_m_s,
            "given for a map of deflection_m, and for no other",
            code="speed_without_deflection",
        )
    if case.speed_m_s is not None:
        require_scale("speed_m_s", case.speed_m_s)
    if recipe is not None and recipe.designed_for is not None:
        drive_designed_for(recipe, case.actuator)


def _require_bounded(case: MapCase, x: Axis, y: Axis | None) -> None:
    if y is not None and x.path == y.path:
        raise InvalidInputError(
            "y.field", "/".join(y.path), "another field than that of x", code="axes_alike"
        )
    cells = x.values.size * (1 if y is None else y.values.size)
    most = MAX_CELLS
    if isinstance(case.shaper, Recipe) and case.shaper.each:
        most = MAX_DESIGNS if case.move is None else MAX_MOVES
    if cells > most:
        raise InvalidInputError(
            "x.points", f"{cells} cells", f"of a map of at most {most} cells", code="too_many_cells"
        )


def _with(whole: Cell, axis: Axis, name: str, value: float) -> Cell:
    part, *path = axis.path
    if part not in whole or not path:
        raise InvalidInputError(
            f"{name}.field",
            "/".join(axis.path),
            f"a number of {' or '.join(whole)} as given",
            code="not_a_number_of_map",
        )
    try:
        return {**whole, part: vary(whole[part], path, value)}
    except InvalidInputError as error:
        if error.name == "field":
            raise error.within(name) from None
        raise error.at(f"{name}.values", value) from None


def _values(case: MapCase, cells: list[list[Cell]], x: Axis, y: Axis | None) -> FloatArray:
    """Return the values of all cells, shape (rows, columns, k)."""
    if case.quantity in OF_ACTUATORS:
        ratios = np.array([
            [decel_over_accel(cell["plant"].mode, cell["actuator"]) for cell in row]
            for row in cells
        ])
        gains: FloatArray = np.abs(ratios) if case.quantity == "alpha" else -np.angle(ratios)
        return gains[..., None]
    values = _of_commands(case, cells, x, y)
    if case.quantity == "deflection_m":
        values *= np.array([[_unshaped_m(case, cell) for cell in row] for row in cells])[..., None]
    return values


def _of_commands(case: MapCase, cells: list[list[Cell]], x: Axis, y: Axis | None) -> FloatArray:
    """Return what is asked of the commands, or their residuals, shape (rows, columns, k)."""
    if isinstance(case.shaper, Recipe) and case.shaper.each:
        return quantities_of_designs(case.quantity, case.shaper, cells)
    over_pulses = any(axis is not None and axis.path[0] == "move" for axis in (x, y))
    if case.move is not None and over_pulses:
        along_x = x.path[0] == "move"
        return residuals_of_re_timed(case, case.move, cells, along_x=along_x)[..., None]
    return residuals_of_held(case, cells)[..., None]


def _unshaped_m(case: MapCase, cell: Cell) -> float:
    """Return the residual amplitude of the unshaped step at the payload [m]."""
    return (case.speed_m_s or 0.0) * unshaped_deflection_s(cell["plant"].mode, cell["actuator"])
