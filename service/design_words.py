"""What the mathematics refuse, in plain words: the rule, the value, and what may be meant."""

from typing import Any

from design.errors import InvalidInputError, Path
from schemas.units import reading_of
from service.number_texts import percent_meant, thousandth_meant
from service.plain_words import echo
from service.suggestions import meaning_of_choice

FAR_TOO_LARGE = frozenset({
    "actuator_too_slow",
    "move_too_long",
    "dead_time_too_long",
    "sample_time_too_long",
})
"""Codes of times and distances that are far too large: the number may be one of a smaller unit."""


def refusal_of_design(error: InvalidInputError, path: Path, request: Any) -> str:  # noqa: ANN401
    """Return what is wrong with a field, to be read after its name.

    Parameters
    ----------
    error
        What the mathematics refuse.
    path
        The field as the request names it.
    request
        The request as JSON has it.

    Returns
    -------
    str
        Rule, value, and what may be meant.
    """
    given, value = _value_at(request, path), error.value
    if isinstance(value, str) and isinstance(given, str) and _in_si(given) == value:
        value = given  # a pointer, as it was typed
    told = f"must be {error.rule}, got {echo(value)}"
    if isinstance(value, str):
        told += meaning_of_choice(value, error.rule)
    if path != error.path:
        told += f" in SI units ({error.path[-1]})"
    if error.code == "out_of_range":
        told += percent_meant(error.value, error.path[-1], None)
    if error.code in FAR_TOO_LARGE:
        told += thousandth_meant(given, path[-1], error.path[-1])
    return told


def _in_si(pointer: str) -> str:
    path, slash, name = pointer.rpartition("/")
    reading = reading_of(name)
    return pointer if reading is None else path + slash + reading.name


def _value_at(here: Any, path: Path) -> Any:  # noqa: ANN401
    """Return what stands at a path of a request; None where nothing does."""
    for name in path:
        if isinstance(here, dict):
            here = here.get(name)
        elif isinstance(here, list) and name.isdecimal() and int(name) < len(here):
            here = here[int(name)]
        else:
            return None
    return here
