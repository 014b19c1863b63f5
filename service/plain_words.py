"""What the wire models refuse, in plain words: the rule, the value, and what may be meant."""

import re
from collections.abc import Mapping
from typing import Any

from pydantic_core import ErrorDetails

from schemas.fields_at import also_called, expected_at, kinds_of
from schemas.units import other_names
from service.belonging import (
    Where,
    models_at,
    names_in_order,
    places_of,
    where_it_belongs,
)
from service.number_texts import number_meant, percent_meant
from service.suggestions import close_names, kinds_meant, listed, meaning_of_field

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

POINTER = re.compile(r"\^/\(([a-z|]+)\)/")
"""The form of a text that is a pointer into some parts of a request."""


def refusal(
    fault: ErrorDetails,
    model: Any,  # noqa: ANN401
    given: str,
    request: Any = None,  # noqa: ANN401
) -> str:
    """Return what is wrong with a field, to be read after its name.

    Parameters
    ----------
    fault
        As pydantic says it.
    model
        Model of the request, or a union of models.
    given
        Name of the field as the request has it: in another unit, maybe.
    request
        The request as JSON has it.

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
        return "must be given" + (f", or {listed(others, 'or')} in its place" if others else "")
    if type_ == "extra_forbidden":
        return f"is no field here; {_meaning(where, model, request)}"
    if type_ == "union_tag_not_found":
        return f"must have a {_tag(context)}: {listed(kinds_of(expected_at(model, where)), 'or')}"
    if type_ == "union_tag_invalid":
        kinds = re.findall(r"'([^']*)'", context["expected_tags"])
        tag = str(context["tag"])
        meant = _swapped(tag, kinds, where, model, request) or _meant(
            kinds_meant(tag, {**dict.fromkeys(kinds, ()), **also_called(expected_at(model, where))})
        )
        name = _tag(context)
        told = f"must be of a {name} that is known, got {echo(tag)}{meant}"
        return f"{told}{' The' if told.endswith('?') else '; the'} {name}s are {', '.join(kinds)}"
    if type_ == "literal_error":
        names = re.findall(r"'([^']*)'", context["expected"])
        if names and isinstance(value, str):
            told = f"must be {listed(names, 'or')}, got {echo(value)}"
            return told + _meant(close_names(value, names))
    if type_ == "string_pattern_mismatch" and (form := POINTER.match(context["pattern"])):
        return _no_pointer(str(value), form[1].split("|"), model, request)
    if type_ not in RULES:
        return f"{fault['msg']}, got {echo(value)}"
    told = f"must be {RULES[type_].format_map(context)}, got {echo(value)}"
    field = next((step for step in reversed(where) if isinstance(step, str)), given)
    if isinstance(value, str):
        of_number = type_ in {"float_type", "int_type"}
        return told + (number_meant(value, given, field) if of_number else "")
    most = context.get("le", context.get("lt"))
    if given != field and given in other_names(field) and _is_number(value):
        return f"{told}, read as {field}"
    return told + (percent_meant(value, field, most) if most is not None else "")


def _tag(context: Mapping[str, Any]) -> str:
    """Return the field that says which model of a union is meant: kind, or mode."""
    return str(context["discriminator"]).strip("'")


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def echo(value: object) -> str:
    """Return a value as a message repeats it, cut where it is long."""
    text = WORDS[value] if value is None or isinstance(value, bool) else repr(value)
    return text if len(text) <= MAX_ECHO_CHARACTERS else f"{text[: MAX_ECHO_CHARACTERS - 3]}..."


def _meaning(where: Where, model: Any, request: Any) -> str:  # noqa: ANN401
    name = str(where[-1])
    fields = [one for inner in models_at(model, where[:-1]) for one in names_in_order(inner)]
    told = where_it_belongs(name, where, model, request)
    if not told or told.startswith("did you mean"):
        return told or meaning_of_field(name, fields)
    return f"{told}; the fields are {', '.join(fields)}"


def _swapped(tag: str, kinds: list[str], where: Where, model: Any, request: Any) -> str:  # noqa: ANN401
    """Return that a kind is one of another field, and whether that has one of this field."""
    here, name = _object_at(request, where[:-1]), str(where[-1]) if where else ""
    for outer in models_at(model, where[:-1]):
        for other in names_in_order(outer):
            if other == name or tag not in kinds_of(expected_at(outer, (other,))):
                continue
            beside = here.get(other) if isinstance(here, dict) else None
            if isinstance(beside, dict) and beside.get("kind") in kinds:
                return f"; {name} and {other} are swapped"
            return f"; {tag} is a kind of {other}"
    return ""


def _object_at(here: Any, where: Where) -> Any:  # noqa: ANN401
    """Return what stands at a place of a request; tags of unions are no steps."""
    for step in where:
        if isinstance(here, list) and isinstance(step, int):
            here = here[step]
        elif isinstance(here, dict):
            here = here.get(step, here)
    return here


def _no_pointer(value: str, parts: list[str], model: Any, request: Any) -> str:  # noqa: ANN401
    """Return what is wrong with a text that should point at a number of a request."""
    ahead = listed([f"/{part}/" for part in parts], "or")
    within = request.get("design") if isinstance(request, dict) and "axes" in request else request
    designed = models_at(model, ("design",)) if within is not request else [model]
    places = [
        place
        for one in designed
        for place in places_of(value.rpartition("/")[2], one, within)
        if place.split("/")[1] in parts
    ]
    return f"must begin with {ahead}, got {echo(value)}{_meant(places)}"


def _meant(names: list[str]) -> str:
    return f"; did you mean {listed(names, 'or')}?" if names else ""
