"""Fields of a request that vary: their paths, the values that they take, and their units.

A path leads from the request down to a number: ``("plant", "modes", "0", "damping_ratio")``.
"""

import bisect
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, Literal

import numpy as np

from design.errors import InvalidInputError
from design.types import FloatArray, IntArray

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

    @property
    def telling(self) -> FloatArray:
        """All that a rule or an amplitude can turn on: here every value."""
        return self.values


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


@dataclass(frozen=True, slots=True)
class EvenRange:
    """The values of a range, evenly spaced by some measure; each is made when it is asked for.

    Attributes
    ----------
    start, stop
        Ends of the range, both among the values.
    size
        Number of values m, >= 1.
    spacing
        By which measure.

    Raises
    ------
    InvalidInputError
        If the range is empty, or reaches zero and is spaced geometrically.
    """

    start: float
    stop: float
    size: int
    spacing: Spacing

    def __post_init__(self) -> None:
        if not self.stop > self.start:
            raise InvalidInputError(
                "to", self.stop, f"greater than from, {self.start!r}", code="range_reversed"
            )
        if self.spacing == "geometric" and self.start <= 0:
            raise InvalidInputError(
                "from", self.start, "> 0 for geometric spacing", code="geometric_from_zero"
            )

    def __getitem__(self, places: IntArray) -> FloatArray:
        """Return the values at some places from 0 to m - 1, of the same shape; they rise."""
        steps = max(self.size - 1, 1)
        if self.spacing == "linear":
            values = self.start + places * ((self.stop - self.start) / steps)
        elif self.spacing == "geometric":
            first, last = np.log10(self.start), np.log10(self.stop)
            values = 10.0 ** (first + places * ((last - first) / steps))
        else:
            middle, half = (self.start + self.stop) / 2, (self.stop - self.start) / 2
            values = middle - half * np.cos(np.pi * places / steps)
        values[places == self.size - 1] = self.stop
        values[places == 0] = self.start
        return values

    @property
    def telling(self) -> FloatArray:
        """The first value, the last, the least above zero: a rule turns there."""
        places = range(self.size)
        above_zero = bisect.bisect_right(places, 0.0, key=lambda one: self[np.array([one])][0])
        return self[np.array(sorted({0, min(above_zero, self.size - 1), self.size - 1}))]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LongAxis:
    """One field and a range of values, too many to be held.

    Attributes
    ----------
    path
        As of `Axis`.
    values
        The range, in the field's own unit.
    """

    path: Path
    values: EvenRange

    @property
    def telling(self) -> FloatArray:
        """The first value, the last, and the least above zero."""
        return self.values.telling


def space_evenly(start: float, stop: float, points: int, spacing: Spacing) -> FloatArray:
    """Return the values of a range, evenly spaced by some measure.

    Parameters
    ----------
    start, stop, points, spacing
        As of `EvenRange`.

    Returns
    -------
    FloatArray
        Shape (m,), rising.

    Raises
    ------
    InvalidInputError
        As of `EvenRange`.

    Examples
    --------
    >>> space_evenly(1.0, 100.0, 3, "geometric").tolist()
    [1.0, 10.0, 100.0]
    """
    return EvenRange(start, stop, points, spacing)[np.arange(points)]


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
