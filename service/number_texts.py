"""What a text or a figure was meant to be where a number is expected: its unit, its per cent."""

import re

from schemas.units import end_of, in_milli, other_names, reading_of
from service.suggestions import FOREIGN_UNITS

NUMBER = re.compile(r"\s*([-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?)\s*(\D.*?)?\s*", re.DOTALL)
"""A number, and what stands after it."""

MAX_CHARACTERS = 80
"""Characters of a text that may be a number with its unit."""

END_OF_SYMBOL = {
    "m": "_m",
    "mm": "_mm",
    "cm": "_cm",
    "km": "_km",
    "um": "_um",
    "ft": "_ft",
    "in": "_in",
    "s": "_s",
    "sec": "_sec",
    "ms": "_ms",
    "us": "_us",
    "min": "_min",
    "hz": "_hz",
    "khz": "_khz",
    "rad/s": "_rad_s",
    "rpm": "_rpm",
    "rad": "_rad",
    "deg": "_deg",
    "m/s": "_m_s",
    "mm/s": "_mm_s",
    "cm/s": "_cm_s",
    "m/min": "_m_min",
    "mm/min": "_mm_min",
    "km/h": "_km_h",
    "m/s2": "_m_s2",
    "mm/s2": "_mm_s2",
    "cm/s2": "_cm_s2",
    "m/s3": "_m_s3",
    "mm/s3": "_mm_s3",
    "n/m": "_n_m",
    "n/mm": "_n_mm",
    "n/cm": "_n_cm",
    "kn/m": "_kn_m",
    "kg": "_kg",
    "g": "_g",
    "t": "_t",
    "lb": "_lb",
    "%": "_percent",
}
"""Ends of names by the symbol of their unit, in small letters and without signs of powers."""

SPELLED = str.maketrans({"²": "2", "³": "3", "^": "", "µ": "u", "μ": "u", "°": "deg", " ": ""})

OF_ANOTHER_FIELD = frozenset({"from", "to", "values"})
"""Fields whose unit is that of another."""

SHARE = re.compile(r"(^|_)(ratio|tolerance|half_width|residual)$")
"""Names of what is 1 for the whole."""

MOST_PERCENT = 1000.0
"""No share is ten times the whole and more."""


def number_meant(text: str, given: str, field: str) -> str:
    """Return what a text was meant to be where a number is expected.

    Parameters
    ----------
    text
        The text.
    given, field
        Name of the field as the request has it, and in SI units.

    Returns
    -------
    str
        The end of a sentence; empty where the text is no number.

    Examples
    --------
    >>> number_meant("48 Hz", "natural_frequency_rad_s", "natural_frequency_rad_s")
    '; give natural_frequency_hz 48'
    >>> number_meant("750 cm", "cable_length_mm", "cable_length_m")
    '; give 7500'
    """
    found = NUMBER.fullmatch(text) if len(text) <= MAX_CHARACTERS else None
    if found is None:
        return ""
    number = found[1].replace(",", ".")
    if found[2] is None:
        return f"; give {number}, {'with a point' if ',' in text else 'without quotes'}"
    end = END_OF_SYMBOL.get(found[2].translate(SPELLED).lower())
    if end is None:
        return ""
    if given in OF_ANOTHER_FIELD:
        return "; give a number alone, in the unit of the field that varies"
    for name in (given, field, *other_names(field)):
        if end_of(name) == end:
            return f"; give {number}" if name == given else f"; give {name} {number}"
    return _converted(float(number), end, given, field)


def _converted(number: float, end: str, given: str, field: str) -> str:
    """Return a number of a unit that is not read, in the field's."""
    for unit in FOREIGN_UNITS:
        if (unit.end, unit.si_end) == (end, end_of(field)):
            in_si, reading = number * unit.in_si, reading_of(given)
            if given == field or reading is None:
                return f"; give {in_si:.12g}"
            if reading.even:
                return f"; give {in_si / reading.convert(1.0):.12g}"
            return f"; give {field} {in_si:.12g}"
    own = next((symbol for symbol, one in END_OF_SYMBOL.items() if one == end_of(given)), "")
    return f"; the field is in {own}" if own else "; the field has no unit"


def percent_meant(value: object, field: str, most: float | None) -> str:
    """Return the share that was meant by a number of per cent.

    Parameters
    ----------
    value
        What is beyond its range.
    field
        Its name.
    most
        The end of the range where it is known.

    Returns
    -------
    str
        The end of a sentence; empty for what is no share, or is no number of per cent.

    Examples
    --------
    >>> percent_meant(5, "tolerance", 0.5)
    '; 5 % is 0.05'
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    share = SHARE.search(field) or (most is not None and most <= 1)
    if not share or not 1 < value < MOST_PERCENT or (most is not None and value <= most):
        return ""
    return f"; {value:.12g} % is {value / 100:.12g}"


def thousandth_meant(value: object, given: str, field: str) -> str:
    """Return the field in a smaller unit that a number was meant for.

    Parameters
    ----------
    value
        The number, far too large.
    given, field
        Name of the field as the request has it, and in SI units.

    Returns
    -------
    str
        The end of a sentence; empty where there is no such field.

    Examples
    --------
    >>> thousandth_meant(9000, "distance_m", "distance_m")
    '; was distance_mm 9000 meant?'
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    name = in_milli(given)
    return f"; was {name} {value:.12g} meant?" if name in other_names(field) else ""
