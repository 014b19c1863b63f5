"""What the wire models refuse, in plain words: the rule, the value, and what may be meant."""

import re
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from schemas.fields_at import expected_at, kinds_of
from schemas.pointers import json_pointer
from schemas.units import other_names, reading_of
from service.suggestions import close_names, meaning_of_field

MAX_ECHO_CHARACTERS = 80
"""Characters of a refused value that a message repeats."""

RULES = {
    "greater_than": "greater than {gt:g}",
    "greater_than_equal": "at least {ge:g}",
    "less_than": "less than {lt:g}",
    "less_than_equal": "at most {le:g}",
    "int_parsing_size": "a smaller number",
    "finite_number": "a finite number",
    "float_type": "a number",
    "float_parsing": "a number",
    "int_parsing": "a whole number",
    "bool_parsing": "true or false",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "string_type": "a text",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "an object",
    "model_type": "an object",
    "model_attributes_type": "an object",
    "literal_error": "{expected}",
    "string_too_short": "a text of {min_length} characters or more",
    "string_too_long": "a text of {max_length} characters at most",
    "string_pattern_mismatch": "a text of the form {pattern}",
    "too_short": "a list of {min_length} or more",
    "too_long": "a list of {max_length} at most",
}
"""What a value must be, by pydantic's type of fault; pydantic fills in its figures."""

WORDS = {True: "true", False: "false", None: "null"}
"""Values that JSON has other words for than Python."""

NUMBER = re.compile(r"\s*[-+]?\d+([.,]\d+)?([eE][-+]?\d+)?\s*")


def refusal(fault: ErrorDetails, model: Any, given: str) -> str:  # noqa: ANN401
    """Return what is wrong with a field, to be read after its name.

    Parameters
    ----------
    fault
        As pydantic says it.
    model
        Model of the request, or a union of models.
    given
        Name of the field as the request has it: in another unit, maybe.

    Returns
    -------
    str
        Rule, value, and what may be meant.
    """
    where, type_ = fault["loc"], fault["type"]
    context: Mapping[str, Any] = fault.get("ctx", {})
    value = fault["input"]
    if type_ == "missing":
        others = other_names(str(where[-1]))
        return f"must be given{f', or {_either(others)} in its place' if others else ''}"
    if type_ == "extra_forbidden":
        return f"is no field here; {_meaning(where, model)}"
    if type_ == "union_tag_not_found":
        return f"must have a kind: {_either(kinds_of(expected_at(model, where)))}"
    if type_ == "union_tag_invalid":
        kinds = re.findall(r"'([^']*)'", context["expected_tags"])
        tag = str(context["tag"])
        told = f"must be of a kind that is known, got {echo(tag)}{_meant(tag, kinds)}"
        return f"{told}{' The' if told.endswith('?') else '; the'} kinds are {', '.join(kinds)}"
    if type_ == "literal_error":
        names = re.findall(r"'([^']*)'", context["expected"])
        if names and isinstance(value, str):
            return f"must be {_either(names)}, got {echo(value)}{_meant(value, names)}"
    if type_ not in RULES:
        return f"{fault['msg']}, got {echo(value)}"
    told = f"must be {RULES[type_].format_map(context)}, got {echo(value)}"
    field = next((step for step in reversed(where) if isinstance(step, str)), given)
    if given != field and given in other_names(field):
        return f"{told}, read as {field}"
    return told + _likely(type_, value)


def echo(value: object) -> str:
    """Return a value as a message repeats it, cut where it is long."""
    text = WORDS[value] if value is None or isinstance(value, bool) else repr(value)
    return text if len(text) <= MAX_ECHO_CHARACTERS else f"{text[: MAX_ECHO_CHARACTERS - 3]}..."


def _meaning(where: tuple[int | str, ...], model: Any) -> str:  # noqa: ANN401
    name = str(where[-1])
    fields = [one for inner in _models_at(model, where[:-1]) for one in _in_order(inner)]
    reading = reading_of(name)
    sought = name if reading is None else reading.name
    places = [
        json_pointer([outer, name])
        for outer in dict.fromkeys(one for root in _models_at(model, ()) for one in _in_order(root))
        if outer != where[0]
        and any(sought in _in_order(inner) for inner in _models_at(model, (outer,)))
    ]
    return f"did you mean {_either(places)}?" if places else meaning_of_field(name, fields)


def _models_at(model: Any, where: tuple[int | str, ...]) -> list[type[BaseModel]]:  # noqa: ANN401
    types = (one for one in expected_at(model, where) if isinstance(one, type))
    return [one for one in types if issubclass(one, BaseModel)]


def _in_order(model: type[BaseModel]) -> list[str]:
    return [field.alias or name for name, field in model.model_fields.items()]


def _meant(value: str, names: list[str]) -> str:
    close = close_names(value, names)
    return f"; did you mean {_either(close)}?" if close else ""


def _either(names: list[str] | tuple[str, ...]) -> str:
    *first, last = names
    return f"{', '.join(first)} or {last}" if first else last


def _likely(type_: str, value: object) -> str:
    """Return what a text was meant to be where a number is expected."""
    if type_ not in {"float_type", "int_type"} or not isinstance(value, str):
        return ""
    if not NUMBER.fullmatch(value):
        return ""
    number = value.strip().replace(",", ".")
    return f"; give {number}, {'with a point' if ',' in value else 'without quotes'}"
