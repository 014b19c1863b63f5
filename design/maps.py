"""Residual vibration over any two fields of plant and actuator."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np

from design.actuators import Actuator, RateLimited
from design.analysis.residual import residual_vibration, residuals_of_cases
from design.errors import InfeasibleDesignError, InvalidInputError
from design.impulses import Impulses
from design.pipeline import design
from design.plants import Plant
from design.shapers.kind import ShaperKind
from design.types import FloatArray

MOST_CELLS = 20_000
"""Largest map of a shaper that is held [cells]."""

MOST_DESIGNS = 2_000
"""Largest map whose every cell is designed [cells]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Axis:
    """One field and the values that it takes.

    Attributes
    ----------
    path
        From the request down: ``plant`` or ``actuator``, then names of fields.
    values
        Values, shape (m,), each in the field's own unit.
    """

    path: tuple[str, ...]
    values: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResidualMap:
    """A map of residual vibration.

    Attributes
    ----------
    residuals
        Shape (len(y), len(x)); not a number where a cell has no such shaper [-].
    """

    residuals: FloatArray


def varied(record: Any, path: Sequence[str], value: float) -> Any:  # noqa: ANN401
    """Return a record with one number, named by its path, replaced.

    Raises
    ------
    InvalidInputError
        If there is no such number, or it breaks its rule.
    """
    name, *rest = path
    names = [field.name for field in fields(record) if field.init] if is_dataclass(record) else []
    if name not in names:
        raise InvalidInputError("field", "/".join(path), f"one of {', '.join(names) or 'none'}")
    inner = getattr(record, name)
    if rest:
        return replace(record, **{name: varied(inner, rest, value)})
    if not isinstance(inner, float | int) or isinstance(inner, bool):
        raise InvalidInputError("field", "/".join(path), "the name of a number")
    return replace(record, **{name: value})


def residual_map(
    plant: Plant,
    actuator: Actuator,
    shaper: Impulses | tuple[ShaperKind, Any],
    x: Axis,
    y: Axis,
) -> ResidualMap:
    """Return the residual of a shaper over two fields.

    Parameters
    ----------
    plant, actuator
        What the fields are varied in.
    shaper
        Impulses that are held, so that the map shows what errors of the two fields cost; or a kind
        with its options, designed anew in each cell.
    x, y
        The axes.

    Raises
    ------
    InvalidInputError
        If both axes are one field, a value breaks its rule, or the map is too large.
    """
    if x.path == y.path:
        raise InvalidInputError("y.field", "/".join(y.path), "another field than that of x")
    cells = x.values.size * y.values.size
    most = MOST_CELLS if isinstance(shaper, Impulses) else MOST_DESIGNS
    if cells > most:
        raise InvalidInputError("x.points", f"{cells} cells", f"of a map of at most {most} cells")
    whole = {"plant": plant, "actuator": actuator}
    rows = []
    for y_value in y.values.tolist():
        of_row = _with(whole, y, "y", y_value)
        row = [_with(of_row, x, "x", x_value) for x_value in x.values.tolist()]
        if isinstance(shaper, Impulses):
            rows.append(_held(shaper, row))
        else:
            rows.append(np.array([_designed(*shaper, **cell) for cell in row]))
    return ResidualMap(residuals=np.array(rows))


def _with(whole: dict[str, Any], axis: Axis, name: str, value: float) -> dict[str, Any]:
    part, *path = axis.path
    if part not in whole or not path:
        raise InvalidInputError(
            f"{name}.field", "/".join(axis.path), "a number of plant or actuator"
        )
    try:
        return {**whole, part: varied(whole[part], path, value)}
    except InvalidInputError as error:
        if error.name == "field":
            raise error.within(name) from None
        raise InvalidInputError(f"{name}.values", value, error.rule) from None


def _held(shaper: Impulses, cells: list[dict[str, Any]]) -> FloatArray:
    """Return the residuals of one shaper for many plants and actuators, at once."""
    modes = [cell["plant"].mode for cell in cells]
    drives = [cell["actuator"] for cell in cells]
    if isinstance(drives[0], RateLimited):
        pairs = zip(modes, drives, strict=True)
        return np.array([residual_vibration(shaper, mode, drive) for mode, drive in pairs])
    lags = [(drive.accel_lag, drive.decel_lag) for drive in drives]
    return residuals_of_cases(
        shaper,
        np.array([mode.pole_rad_s for mode in modes]),
        np.array([[lag.first_s for lag in both] for both in lags]),
        np.array([[lag.second_s2 for lag in both] for both in lags]),
        drives[0].model,
    )


def _designed(kind: ShaperKind, options: Any, plant: Plant, actuator: Actuator) -> float:  # noqa: ANN401
    try:
        return design(plant, actuator, kind, options).residual
    except InfeasibleDesignError:
        return float("nan")
