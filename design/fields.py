"""Fields of a request that vary: their paths, the values that they take, and their units.

A path leads from the request down to a number: ``("plant", "modes", "0", "damping_ratio")``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, Literal

import numpy as np

from design.errors import InvalidInputError
from design.types import FloatArray

Path = tuple[str, ...]

Spacing = Literal["linear", "geometric", "chebyshev"]
"""How values lie in a range; ``chebyshev``: points of the second kind, both ends among them."""

UNITS = {
    "_rad_s": "rad/s",
    "_m_s2": "m/s^2",
    "_m_s3": "m/s^3",
    "_n_m": "N/m",
    "_kg": "kg",
    "_m_s": "m/s",
    "_rad": "rad",
    "_hz": "Hz",
    "_s": "s",
    "_m": "m",
}
"""Units by the end of a field's name; the longer ends first."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Axis:
    """One field and the values that it takes.

    Attributes
    ----------
    path
        ``plant``, ``actuator``, ``shaper`` or ``move``, then names of fields.
    values
        Shape (m,), each in the field's own unit.
    """

    path: Path
    values: FloatArray


def vary(record: Any, path: Sequence[str], value: float) -> Any:  # noqa: ANN401
    """Return a record with one number, named by its path, replaced.

    Parameters
    ----------
    record
        A frozen record, or a tuple of them.
    path
        Names of fields from the record down; in a tuple, the number of the entry.
    value
        In the unit of the field.

    Returns
    -------
    Any
        Of the record's own type; the record itself stays as it is.

    Raises
    ------
    InvalidInputError
        If there is no such number, or it breaks its rule.

    Examples
    --------
    >>> from design.model.plants.pendulum import Pendulum
    >>> vary(Pendulum(cable_length_m=0.8), ["cable_length_m"], 1.2).cable_length_m
    1.2
    """
    name, *rest = path
    if isinstance(record, tuple) and rest:
        numbers = [str(number) for number in range(len(record))]
        if name not in numbers:
            raise InvalidInputError(
                "field", "/".join(path), f"one of {', '.join(numbers)}", code="unknown_item"
            )
        changed = vary(record[int(name)], rest, value)
        return (*record[: int(name)], changed, *record[int(name) + 1 :])
    names = [field.name for field in fields(record) if field.init] if is_dataclass(record) else []
    if name not in names:
        raise InvalidInputError(
            "field", "/".join(path), f"one of {', '.join(names) or 'none'}", code="unknown_field"
        )
    inner = getattr(record, name)
    if rest:
        return replace(record, **{name: vary(inner, rest, value)})
    if not isinstance(inner, float | int) or isinstance(inner, bool):
        raise InvalidInputError(
            "field", "/".join(path), "the name of a number", code="not_a_number"
        )
    return replace(record, **{name: value})


def space_evenly(start: float, stop: float, points: int, spacing: Spacing) -> FloatArray:
    """Return the values of a range, evenly spaced by some measure.

    Parameters
    ----------
    start, stop
        Ends of the range, both among the values.
    points
        Number of values m, >= 1.
    spacing
        By which measure.

    Returns
    -------
    FloatArray
        Shape (m,), rising.

    Raises
    ------
    InvalidInputError
        If the range is empty, or reaches zero and is spaced geometrically.

    Examples
    --------
    >>> space_evenly(1.0, 100.0, 3, "geometric").tolist()
    [1.0, 10.0, 100.0]
    """
    if not stop > start:
        raise InvalidInputError("to", stop, f"greater than from, {start!r}", code="range_reversed")
    if spacing == "linear":
        return np.linspace(start, stop, points)
    if spacing == "chebyshev":
        angles = np.pi * np.arange(points) / max(points - 1, 1)
        middle, half = (start + stop) / 2, (stop - start) / 2
        values = middle - half * np.cos(angles)
        values[0] = start
        if points > 1:
            values[-1] = stop
        return values
    if start <= 0:
        raise InvalidInputError(
            "from", start, "> 0 for geometric spacing", code="geometric_from_zero"
        )
    return np.geomspace(start, stop, points)


def unit_of(name: str) -> str:
    """Return the unit that the end of a field's name says.

    Returns
    -------
    str
        As in ``UNITS``; ``1`` where the name ends with no unit.

    Examples
    --------
    >>> unit_of("accel_limit_m_s2"), unit_of("damping_ratio")
    ('m/s^2', '1')
    """
    return next((unit for end, unit in UNITS.items() if name.endswith(end)), "1")


def name_in_words(name: str) -> str:
    """Return the name of a field as words, without its unit.

    Returns
    -------
    str
        As an axis of a picture is labelled.

    Examples
    --------
    >>> name_in_words("natural_frequency_rad_s")
    'natural frequency'
    """
    end = next((end for end in UNITS if name.endswith(end)), "")
    return name.removesuffix(end).replace("_", " ")
