"""What is said of a value that is hardly meant, and where in an answer."""

import json
from collections.abc import Iterable, Sequence
from math import tau
from typing import Any

from pydantic import BaseModel

from schemas.pointers import json_pointer, path_of
from schemas.recommendations import RecommendationResponse
from schemas.units import MILLI, Reading, end_of, in_milli, other_names, reading_of
from schemas.usual_ranges import PRINTED, Range
from schemas.warnings import WarningOut

THOUSAND = 1000.0
"""Between two usual units of a quantity: most slips are one of them."""

SECONDS_OF_A_MINUTE = 60.0

OF_RANGES = frozenset({"from", "to", "values"})

SECOND_END = {"from": "to", "to": "from"}


def with_warnings(
    answer: BaseModel, values: Iterable[tuple[str, Range, float, float]], body: bytes
) -> BaseModel:
    """Return an answer with a warning for each value, ahead of others.

    Parameters
    ----------
    answer
        An answer with warnings, or a recommendation: those of the recommended shaper.
    values
        As of `implausible_values`.
    body
        The request as JSON, by whose names the fields are called.

    Returns
    -------
    BaseModel
        The answer; as it is where it has no warnings.
    """
    told = warnings_of(values, body)
    if isinstance(answer, RecommendationResponse):
        best = answer.recommended
        warned = best.model_copy(update={"warnings": [*told, *best.warnings]})
        return answer.model_copy(update={"recommended": warned})
    own: list[WarningOut] | None = getattr(answer, "warnings", None)
    if own is None:
        return answer
    return answer.model_copy(update={"warnings": [*told, *own]})


def warnings_of(values: Iterable[tuple[str, Range, float, float]], body: bytes) -> list[WarningOut]:
    """Return a warning for each value that is hardly meant.

    Parameters
    ----------
    values, body
        As of `with_warnings`.

    Returns
    -------
    list of WarningOut
        In their order.
    """
    request = json.loads(body)
    return [
        WarningOut(
            code="implausible_value",
            detail=meaning(*_as_typed(pointer, request), usual, quantity, compared),
        )
        for pointer, usual, quantity, compared in values
    ]


def _as_typed(pointer: str, request: Any) -> tuple[str, str, float | None]:  # noqa: ANN401
    """Return a pointer, the field that is there or varies there, and the number, as typed."""
    parts = path_of(pointer)
    typed: list[str] = []
    here = request
    for number, step in enumerate(parts):
        varied = isinstance(here, dict) and here.get("over", here.get("field"))
        if varied and step in OF_RANGES:
            name = varied.rpartition("/")[2]
            rest, value = _in_range(here, parts[number:], reading_of(name))
            return json_pointer([*typed, *rest]), name, value
        if isinstance(here, list):
            here = here[int(step)]
        else:
            step = _typed_name(step, here)
            here = here.get(step)
        typed.append(step)
    return json_pointer(typed), typed[-1], here if isinstance(here, int | float) else None


def _in_range(
    here: dict[str, Any], rest: Sequence[str], reading: Reading | None
) -> tuple[Sequence[str], float | None]:
    """Return where a number of a range stands as typed, and the number."""
    # A range of periods falls where that of frequencies rises.
    falls = reading is not None and reading.convert(1.0) > reading.convert(2.0)
    if rest[0] in here and rest[0] == "values":
        return rest, here["values"][int(rest[1])]
    # Values that were made of a range, in rising order, stand for its ends.
    end = rest[0] if rest[0] != "values" else ("from" if rest[1] == "0" else "to")
    end = SECOND_END[end] if falls else end
    return [end], here.get(end)


def _typed_name(name: str, here: Any) -> str:  # noqa: ANN401
    return name if name in here else next((one for one in other_names(name) if one in here), name)


def meaning(
    pointer: str, field: str, typed: float | None, usual: Range, quantity: float, compared: float
) -> str:
    """Return what is implausible of a value, and what may be meant.

    Parameters
    ----------
    pointer, field, typed
        Where the number stands, the field that it is of, and the number, all as typed.
    usual
        Its usual range.
    quantity, compared
        The quantity in its unit, and as the range has it.

    Returns
    -------
    str
        Field, value, range and the likely meaning.

    Examples
    --------
    >>> length = Range(0.01, 300, "m", "cable_length_mm")
    >>> meaning("/plant/cable_length_m", "cable_length_m", 800, length, 800, 800)
    '/plant/cable_length_m: 800 m, usual are 0.01 to 300 m; was 0.8 m meant, cable_length_mm 800?'
    """
    if usual is PRINTED:
        return f"{pointer}: {_of_printers(field, typed, usual, quantity)}"
    what = "a period of " if usual.of_frequency else ""
    figure = f"{what}{quantity:.6g} {usual.unit}"
    if usual.in_periods:
        told = f"{figure}, {compared:.4g} periods of the plant, usual are at most {usual.high:g}"
    elif usual.low == 0:
        told = f"{figure}, usual is less than {usual.high:g} {usual.unit}"
    else:
        told = f"{figure}, usual are {usual.low:g} to {usual.high:g} {usual.unit}"
    over = compared >= usual.high
    factor = 1 / THOUSAND if over else THOUSAND
    if not usual.low <= compared * factor < usual.high:
        return f"{pointer}: {told}; is it in {usual.unit}?"
    return (
        f"{pointer}: {told}; was {what}{quantity * factor:.6g} {usual.unit} meant"
        f"{_by_other_name(field, typed, usual, over=over)}?{_per_minute(field, typed, usual)}"
    )


def _by_other_name(field: str, typed: float | None, usual: Range, *, over: bool) -> str:
    """Return the number that was typed by the name that it was meant for."""
    if typed is None:
        return ""
    if over and in_milli(field) == usual.milli:
        return f", {usual.milli} {typed:.6g}"
    if not over and field == usual.milli:
        in_si = next(end for end, milli in MILLI.items() if milli == end_of(field))
        return f", {field.removesuffix(end_of(field))}{in_si} {typed:.6g}"
    return ""


def _per_minute(field: str, typed: float | None, usual: Range) -> str:
    """Return a speed as one per minute, which most machines with small speeds are in."""
    if typed is None or end_of(field) != "_m_s" or usual.unit != "m/s":
        return ""
    if abs(typed) / SECONDS_OF_A_MINUTE >= usual.high:
        return ""
    return f" {typed:.6g} m/min is {typed / SECONDS_OF_A_MINUTE:.6g} m/s"


def _of_printers(field: str, typed: float | None, usual: Range, period_s: float) -> str:
    """Return that no printer has a period, and by which name its number would be usual."""
    told = (
        f"a period of {period_s:.6g} s, {1 / period_s:.4g} Hz, usual of a printer are "
        f"{1 / usual.high:.3g} to {1 / usual.low:.3g} Hz"
    )
    names = ("natural_frequency_rad_s", *other_names("natural_frequency_rad_s"))
    for name in ("natural_frequency_hz", "period_ms", "period_s"):
        reading = reading_of(name)
        if not typed or field not in names or field == name or reading is None:
            continue
        if usual.low <= tau / reading.convert(typed) < usual.high:
            return f"{told}; was {name} {typed:.6g} meant?"
    return f"{told}; is it that of a printer?"
