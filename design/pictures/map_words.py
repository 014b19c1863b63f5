"""What a map shows, in words, and where on it the plant as given is."""

import textwrap
from typing import Any

import numpy as np

from design.fields import Axis, Path, name_in_words, unit_of
from design.maps.map_case import Map, MapCase, Quantity, Recipe

LINE_CHARACTERS = 92
"""Characters of a line of the subtitle, which a page of one panel has room for [-]."""

SUBJECTS: dict[Quantity, str] = {
    "residual": "Residual vibration of",
    "deflection_m": "Residual deflection of the payload with",
    "times_s": "Times of the impulses of",
    "duration_s": "Duration of",
    "branch": "Branch of the closed form of",
    "alpha": "Gain of the decelerating set over that of the accelerating one",
    "beta_rad": "Phase lag of the decelerating set behind the accelerating one",
}


def title_of(case: MapCase, quantity: Quantity) -> str:
    """Return what is mapped, of which shaper.

    Parameters
    ----------
    case
        What is mapped.
    quantity
        The quantity.

    Returns
    -------
    str
        Without a shaper the quantity alone.
    """
    if case.shaper is None:
        return SUBJECTS[quantity]
    if not isinstance(case.shaper, Recipe):
        return f"{SUBJECTS[quantity]} {case.shaper.times_s.size} impulses"
    move = "" if case.move is None else "a whole move by "
    return f"{SUBJECTS[quantity]} {move}{case.shaper.kind.name}"


def subtitle_of(case: MapCase, quantity: Quantity, *, marked: bool) -> list[str]:
    """Return when the shaper was designed, and what is marked.

    Parameters
    ----------
    case
        What is mapped.
    quantity
        The quantity.
    marked
        Whether plant and actuator as given are on the axes.

    Returns
    -------
    list of str
        Claims in words, one or two lines.
    """
    words = []
    shaper, where = case.shaper, "marked" if marked else "outside"
    if isinstance(shaper, Recipe):
        model = "" if shaper.designed_for is None else f" for the {shaper.designed_for} model"
        if shaper.each:
            words.append(f"designed anew in each cell{model}")
        else:
            words.append(f"designed once, for plant and actuator as given ({where}){model}")
    elif shaper is not None:
        words.append("held in each cell")
    if case.move is not None:
        words.append(f"start and {case.move.stop} stop, {case.move.pulse_s:.4g} s apart as given")
    if case.actuator.kind != "ideal" and quantity in {"residual", "deflection_m"}:
        words.append(f"judged by the {case.actuator.model} model")
    if not isinstance(shaper, Recipe) or shaper.each:
        words.append(f"{where}: plant and actuator as given")
    return textwrap.wrap("; ".join(words), LINE_CHARACTERS)


def worst_of_drives(case: MapCase, found: Map, x: Axis, y: Axis | None) -> list[str]:
    """Return where a held command has its largest residual over drives.

    Parameters
    ----------
    case, found
        What is mapped, and the map.
    x, y
        The axes; without y, a curve.

    Returns
    -------
    list of str
        One sentence in lines; none of another map.
    """
    axes = [axis for axis in (y, x) if axis is not None]
    held = not isinstance(case.shaper, Recipe) or not case.shaper.each
    if (
        found.quantity != "residual"
        or not held
        or any(axis.path[0] != "actuator" for axis in axes)
        or np.isnan(found.values).all()
    ):
        return []
    place = np.unravel_index(np.nanargmax(found.values), found.values.shape)
    at = zip(axes[::-1], (place[1], place[0]), strict=False)
    told = [f"{axis_in_words(axis)} {axis.values[where]:.4g}{_unit(axis)}" for axis, where in at]
    worst = f"largest {100 * float(found.values[place]):.3g} %, at {', '.join(told)}"
    return textwrap.wrap(worst, LINE_CHARACTERS)


def axis_in_words(axis: Axis) -> str:
    """Return the name of a field with the set or the part that it is of."""
    return " ".join([*axis.path[1:-1], name_in_words(axis.path[-1])])


def _unit(axis: Axis) -> str:
    unit = unit_of(axis.path[-1])
    return "" if unit == "1" else f" {unit.replace('^2', '²')}"


def design_point(case: MapCase, x: Axis, y: Axis | None) -> tuple[float, float] | None:
    """Return where plant, actuator and move as given are on the axes.

    Parameters
    ----------
    case
        What is mapped.
    x, y
        The axes; without y the second place is 0.

    Returns
    -------
    tuple of float or None
        None where that is outside.
    """
    places = [given(case, axis.path) for axis in (x, y) if axis is not None]
    for axis, place in zip((x, y), places, strict=False):
        if axis is not None and not axis.values.min() <= place <= axis.values.max():
            return None
    return places[0], places[1] if y is not None else 0.0


def given(case: MapCase, path: Path) -> float:
    """Return the value of a field as given.

    Parameters
    ----------
    case
        What is mapped.
    path
        ``plant``, ``actuator`` or ``move``, then names of fields.

    Returns
    -------
    float
        In the field's own unit.
    """
    record: Any = case
    for name in path:
        record = record[int(name)] if isinstance(record, tuple) else getattr(record, name)
    return float(record)
