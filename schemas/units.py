"""Units that a request may use beside those of its fields, by the ends of names.

A field in SI units may be given by its name with another unit at the end: ``cable_length_mm`` for
``cable_length_m``. A period stands for a natural frequency, a logarithmic decrement for a damping
ratio. All models read them here, by the names of their fields; answers keep SI.
"""

import math
from collections.abc import Callable, Iterable
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any, NamedTuple

from pydantic import ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError


class Unit(NamedTuple):
    """A unit as the end of a name; a value of 1 in it is ``times / over`` in SI.

    Two factors, since a thousandth is no binary fraction: 1001 mm divided by 1000 are the same
    number as 1.001 m.
    """

    end: str
    si_end: str
    times: float = 1.0
    over: float = 1.0


UNITS = (
    Unit("_rate_deg_s", "_rate_rad_s", times=math.pi, over=180.0),
    Unit("_mm_s3", "_m_s3", over=1000.0),
    Unit("_mm_s2", "_m_s2", over=1000.0),
    Unit("_mm_s", "_m_s", over=1000.0),
    Unit("_n_mm", "_n_m", times=1000.0),
    Unit("_deg", "_rad", times=math.pi, over=180.0),
    Unit("_hz", "_rad_s", times=math.tau),
    Unit("_mm", "_m", over=1000.0),
    Unit("_ms", "_s", over=1000.0),
)
"""The longer ends first."""

SI_ENDS = ("_per_s", "_rad_s", "_m_s3", "_m_s2", "_m_s", "_n_m", "_rad", "_m", "_s")
"""The longer ends first: a speed in m/s is no time in s."""


MAX_NAME_CHARACTERS = 64
"""Characters of a name that may be one of a field: of what strangers send, no more is kept."""


def frequency_of_period(period_s: float) -> float:
    """Return an angular frequency [rad/s]; 0, which none has, for 0."""
    return math.tau / period_s if period_s else 0.0


def ratio_of_decrement(log_decrement: float) -> float:
    """Return the damping ratio, z = d / sqrt(4 pi^2 + d^2) of d [-]."""
    return log_decrement / math.hypot(math.tau, log_decrement)


STAND_INS: dict[str, tuple[str, Callable[[float], float]]] = {
    "period_s": ("natural_frequency_rad_s", frequency_of_period),
    "period_ms": ("natural_frequency_rad_s", lambda value: frequency_of_period(value / 1000.0)),
    "log_decrement": ("damping_ratio", ratio_of_decrement),
}
"""Other quantities that say the same, each with the field that it stands for."""


@dataclass(frozen=True, slots=True)
class Reading:
    """How a field that is not in SI units is read.

    Attributes
    ----------
    name
        Name of the field in SI units.
    scale
        From its value to that in SI units.
    even
        Whether values that are evenly spaced stay so: a factor, nothing else.
    """

    name: str
    scale: Callable[[float], float]
    even: bool

    def convert(self, value: Any) -> Any:  # noqa: ANN401 - any JSON
        """Return a number, a list or a course over time in SI, else the same."""
        if isinstance(value, dict) and "values" in value:
            return {**value, "values": self.convert(value["values"])}
        if isinstance(value, list):
            return [self.convert(one) for one in value]
        if isinstance(value, bool) or not isinstance(value, int | float):
            return value
        try:
            return self.scale(value)
        except OverflowError:  # a whole number that no float holds
            return value


def _scaled(times: float, over: float, value: float) -> float:
    return value * times / over


def reading_of(name: str) -> Reading | None:
    """Return how a name is read.

    Returns
    -------
    Reading or None
        None for a name that ends with no unit of `UNITS`.

    Examples
    --------
    >>> reading_of("cable_length_mm").name, reading_of("cable_length_mm").convert(800)
    ('cable_length_m', 0.8)
    """
    return _reading_of(name) if len(name) <= MAX_NAME_CHARACTERS else None


@lru_cache(maxsize=1024)
def _reading_of(name: str) -> Reading | None:
    if name in STAND_INS:
        field, scale = STAND_INS[name]
        return Reading(field, scale, even=False)
    for end, si_end, times, over in UNITS:
        if name.endswith(end) and name != end:
            field = name.removesuffix(end) + si_end
            if si_end.endswith(next(one for one in SI_ENDS if field.endswith(one))):
                return Reading(field, partial(_scaled, times, over), even=True)
            return None
    return None


def other_names(field: str) -> tuple[str, ...]:
    """Return the names by which a field may be given beside its own.

    Returns
    -------
    tuple of str
        Empty for a field without a unit.

    Examples
    --------
    >>> other_names("damping_ratio"), other_names("speed_m_s")
    (('log_decrement',), ('speed_mm_s',))
    """
    ends = (
        field.removesuffix(unit.si_end) + unit.end for unit in UNITS if field.endswith(unit.si_end)
    )
    names = (*ends, *STAND_INS)
    readings = ((name, reading_of(name)) for name in names)
    return tuple(name for name, read in readings if read is not None and read.name == field)


ENDS = sorted({*SI_ENDS, *(unit.end for unit in UNITS), "_kg"}, key=len, reverse=True)

MILLI = {"_m": "_mm", "_s": "_ms", "_m_s": "_mm_s", "_m_s2": "_mm_s2"}
"""Ends of units, and of those a thousand times smaller that are read."""


def end_of(name: str) -> str:
    """Return the unit of a name as its end; empty for one without."""
    return next((end for end in ENDS if name.endswith(end)), "")


def in_milli(name: str) -> str:
    """Return a name in a thousandth of its unit; empty where none is read."""
    milli = MILLI.get(end_of(name), "")
    return name.removesuffix(end_of(name)) + milli if milli else ""


def in_si(given: dict[str, Any], fields: AbstractSet[str]) -> dict[str, Any]:
    """Return an object with its fields in SI units.

    Parameters
    ----------
    given
        The object, as JSON has it.
    fields
        Names of the fields that it may have; those of other objects stay as they are.

    Returns
    -------
    dict
        With a field of SI units in place of each that is not.

    Raises
    ------
    ValidationError
        If a field is given twice.
    """
    read: dict[str, Any] = {}
    said: dict[str, str] = {}
    for name, value in given.items():
        reading = None if name in fields else reading_of(name)
        if reading is None or reading.name not in fields:
            field, told = name, value
        else:
            field, told = reading.name, reading.convert(value)
        if field in said:
            said_twice = PydanticCustomError(
                "unit_said_twice",
                "{first} and {second} say the same",
                {"first": said[field], "second": name},
            )
            fault = InitErrorDetails(type=said_twice, loc=(name,), input=value)
            refusal = ValidationError.from_exception_data("units", [fault])
            raise refusal
        said[field] = name
        read[field] = told
    return read


def all_in_si(here: Any) -> Any:  # noqa: ANN401 - any JSON
    """Return objects within objects in SI units, by their names alone.

    Parameters
    ----------
    here
        Parts of a request, whose fields are not known: those of a listed design.

    Returns
    -------
    Any
        The same object where it is in SI units.

    Raises
    ------
    ValidationError
        If a field is given twice.
    """
    if isinstance(here, list):
        changed = _changed(enumerate(here))
        if not changed:
            return here  # millions of designs are not held twice
        return [changed.get(number, one) for number, one in enumerate(here)]
    if not isinstance(here, dict):
        return here
    changed = _changed(here.items())
    inner = {**here, **changed} if changed else here
    fields = set()
    for name in here:
        reading = reading_of(name)
        fields.add(name if reading is None else reading.name)
    return inner if fields == here.keys() else in_si(inner, fields)


def _changed(parts: Iterable[tuple[Any, Any]]) -> dict[Any, Any]:
    """Return the parts that are not the same in SI units, by number or name."""
    read = ((where, part, all_in_si(part)) for where, part in parts)
    return {where: told for where, part, told in read if told is not part}
