"""What somebody may have meant by a name that is none: another name, or another unit."""

from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from math import tau
from typing import NamedTuple

from schemas.units import end_of, other_names, reading_of


class ForeignUnit(NamedTuple):
    """A unit that is not read: the end of its name, and 1 of it in SI."""

    end: str
    si_end: str
    in_si: float


FOREIGN_UNITS = (
    ForeignUnit("_mm_min", "_m_s", 1e-3 / 60),
    ForeignUnit("_m_min", "_m_s", 1 / 60),
    ForeignUnit("_km_h", "_m_s", 1 / 3.6),
    ForeignUnit("_cm_s2", "_m_s2", 1e-2),
    ForeignUnit("_cm_s", "_m_s", 1e-2),
    ForeignUnit("_n_cm", "_n_m", 1e2),
    ForeignUnit("_kn_m", "_n_m", 1e3),
    ForeignUnit("_seconds", "_s", 1.0),
    ForeignUnit("_metres", "_m", 1.0),
    ForeignUnit("_meters", "_m", 1.0),
    ForeignUnit("_percent", "", 1e-2),
    ForeignUnit("_khz", "_rad_s", 1e3 * tau),
    ForeignUnit("_rpm", "_rad_s", tau / 60),
    ForeignUnit("_deg_s", "_rad_s", tau / 360),
    ForeignUnit("_sec", "_s", 1.0),
    ForeignUnit("_min", "_s", 60.0),
    ForeignUnit("_us", "_s", 1e-6),
    ForeignUnit("_cm", "_m", 1e-2),
    ForeignUnit("_km", "_m", 1e3),
    ForeignUnit("_um", "_m", 1e-6),
    ForeignUnit("_ft", "_m", 0.3048),
    ForeignUnit("_in", "_m", 0.0254),
    ForeignUnit("_lb", "_kg", 0.45359237),
    ForeignUnit("_g", "_kg", 1e-3),
    ForeignUnit("_g", "_m_s2", 9.80665),
    ForeignUnit("_t", "_kg", 1e3),
    ForeignUnit("", "_kg", 1.0),
    ForeignUnit("", "_m_s2", 1.0),
)
"""The longer ends first; feet, inches, pounds and standard gravity by their definitions."""

CHOICE = "one of "
"""How a rule begins that lists names."""

CLOSE = 0.6
"""Share of letters that two names have in common at least, as difflib has it."""

MOST_SUGGESTIONS = 3


def meaning_of_field(name: str, fields: Sequence[str]) -> str:
    """Return what may have been meant by the name of a field.

    Parameters
    ----------
    name, fields
        The name that is none, and those that are.

    Returns
    -------
    str
        A part of a sentence.

    Examples
    --------
    >>> meaning_of_field("cable_length_cm", ["kind", "cable_length_m"])
    'give cable_length_m, 100 times smaller, or cable_length_mm, 10 times larger'
    >>> meaning_of_field("cable_lenght_mm", ["kind", "cable_length_m"])
    'did you mean cable_length_mm or cable_length_m?'
    """
    near = _near(name, fields)
    return near or f"the fields are {', '.join(fields)}"


def meaning_of_choice(value: str, rule: str) -> str:
    """Return what may have been meant by a field that is chosen by name.

    Parameters
    ----------
    value, rule
        Its name or path, and the rule that it breaks, ``one of`` some names or paths.

    Returns
    -------
    str
        The end of a sentence; empty where nothing is close, or the rule is another.

    Examples
    --------
    >>> meaning_of_choice("/plant/cable_length_in", "one of cable_length_m, gravity_m_s2")
    '; give cable_length_m, 39.3701 times smaller, or cable_length_mm, 25.4 times larger'
    """
    if not rule.startswith(CHOICE):
        return ""
    choices = rule.removeprefix(CHOICE).split(", ")
    name = value.rpartition("/")[2]
    reading = reading_of(name)
    same = (name, name if reading is None else reading.name)
    meant = [
        f"{path}{slash}{name}"
        for path, slash, last in (one.rpartition("/") for one in choices)
        if last in same
    ]
    if meant and value not in meant:
        return f"; did you mean {listed(meant, 'or')}?"
    near = _near(name, list(dict.fromkeys(one.rpartition("/")[2] for one in choices)))
    return f"; {near}" if near else ""


def _near(name: str, fields: Sequence[str]) -> str:
    """Return the names that are near, or those in other units; empty where none is."""
    known = [*fields, *(other for field in fields for other in other_names(field))]
    for end, si_end, in_si in FOREIGN_UNITS:
        field = name.removesuffix(end) + si_end
        if name.endswith(end) and field in fields and field != name:
            return f"give {listed(_in_units(field, in_si), 'or')}"
    # Names that end in one unit are close by its letters alone.
    close = [one for one in close_names(name, known) if close_names(_stem(name), [_stem(one)])]
    return f"did you mean {listed(close, 'or')}?" if close else ""


def _stem(name: str) -> str:
    """Return a name without its unit."""
    return name.removesuffix(end_of(name))


def kinds_meant(name: str, kinds: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the kinds that may be meant by a name that is none.

    Parameters
    ----------
    name, kinds
        The name, and the kinds that are served, each with what people call it.

    Returns
    -------
    list of str
        By what people call them, else by their letters.

    Examples
    --------
    >>> kinds_meant("Overhead crane", {"mode": (), "pendulum": ("overhead_crane",)})
    ['pendulum']
    """
    plain = name.strip().lower().replace(" ", "_").replace("-", "_")
    meant = [kind for kind, also in kinds.items() if plain in also]
    return meant or close_names(name, kinds)


def close_names(name: str, known: Iterable[str]) -> list[str]:
    """Return those of the known names that are close to one, best first.

    Parameters
    ----------
    name, known
        The name that is none, and those that are.

    Returns
    -------
    list of str
        `MOST_SUGGESTIONS` at most.
    """
    lower = {one.lower(): one for one in known}
    found = get_close_matches(name.lower(), lower, MOST_SUGGESTIONS, CLOSE)
    return [lower[one] for one in found]


def _in_units(field: str, in_si: float) -> list[str]:
    """Return a field and its other names, each with what a value is to be multiplied by."""
    told = [f"{field}, {_times(in_si)}"]
    for other in other_names(field):
        reading = reading_of(other)
        if reading is not None and reading.even:
            told.append(f"{other}, {_times(in_si / reading.convert(1.0))}")
    return told


def _times(factor: float) -> str:
    if f"{factor:.6g}" == "1":
        return "the same number"
    return f"{factor:.6g} times larger" if factor > 1 else f"{1 / factor:.6g} times smaller"


def listed(names: Sequence[str], word: str) -> str:
    """Return names as a sentence lists them, with a word before the last.

    Parameters
    ----------
    names, word
        One name or more, and ``or`` or ``and``.

    Returns
    -------
    str
        With commas between names that have none.
    """
    *first, last = names
    if not first:
        return last
    comma = "," if any("," in name for name in first) else ""
    return f"{', '.join(first)}{comma} {word} {last}"
