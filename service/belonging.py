"""Where a field of a request belongs: at another place, in another kind, in another request."""

from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import BaseModel

from schemas.base import wire_names
from schemas.fields_at import expected_at, kinds_of
from schemas.pointers import json_pointer
from schemas.requests import requests
from schemas.units import reading_of
from service.suggestions import MOST_SUGGESTIONS, listed

Where = tuple[int | str, ...]
"""A place of a request, as pydantic says it."""


def models_at(model: Any, where: Where) -> list[type[BaseModel]]:  # noqa: ANN401
    """Return the models that are expected at a place.

    Parameters
    ----------
    model
        Model of the request, or a union of models.
    where
        The place.

    Returns
    -------
    list of type
        Several of a union.
    """
    types = (one for one in expected_at(model, where) if isinstance(one, type))
    return [one for one in types if issubclass(one, BaseModel)]


def names_in_order(model: type[BaseModel]) -> list[str]:
    """Return the fields of a model by their names on the wire."""
    return [field.alias or name for name, field in model.model_fields.items()]


def where_it_belongs(name: str, where: Where, model: Any, request: Any) -> str:  # noqa: ANN401
    """Return where a field that is none at its place is one.

    A place is said only where the object that stands there, of its kind, takes the field.

    Parameters
    ----------
    name, where
        The field, and its place.
    model, request
        Model of the request, and the request as JSON has it.

    Returns
    -------
    str
        A part of a sentence; empty where it is a field of nothing.
    """
    sought = _in_si(name)
    kinds = kinds_of([one for one in models_at(model, where[:-2]) if sought in wire_names(one)])
    if not kinds and (places := places_of(name, model, request)):
        return f"did you mean {listed(places[:MOST_SUGGESTIONS], 'or')}?"
    others = [command for command, one in requests().items() if sought in wire_names(one)]
    # What is a field of this request at its root is no news, wherever else it is one.
    known = any(sought in wire_names(one) for one in models_at(model, ()))
    owners = []
    if kinds:
        several = [*kinds[:MOST_SUGGESTIONS], "others"]
        told = kinds if len(kinds) <= MOST_SUGGESTIONS else several
        owners.append(f"the kind {listed(told, 'or')}")
    if others and not known:
        owners.append(listed(others, "or"))
    return f"{name} belongs to {', or to '.join(owners)}" if owners else ""


def places_of(name: str, model: Any, request: Any) -> list[str]:  # noqa: ANN401
    """Return where a request takes a field, the places nearest to its root.

    Parameters
    ----------
    name
        The field, in any unit.
    model, request
        Model of the request, and the request as JSON has it.

    Returns
    -------
    list of str
        JSON pointers.
    """
    sought = _in_si(name)
    paths = [path for path, one in _objects(model, (), request, ()) if sought in wire_names(one)]
    least = min(map(len, paths), default=0)
    return [json_pointer([*path, name]) for path in paths if len(path) == least]


def owner_of_request(model: Any, request: Any) -> str:  # noqa: ANN401
    """Return of what else a request is one, by its fields.

    Parameters
    ----------
    model, request
        The model that refused it, and the request as JSON has it.

    Returns
    -------
    str
        Commands; empty where it is a request of none, or only values of it are at fault.
    """
    if not isinstance(request, dict) or model not in requests().values():
        return ""
    given = {_in_si(name) for name in request}
    strangers = [name for name in request if _in_si(name) not in wire_names(model)]
    # One number too many is a slip, and nothing else.
    slip = len(strangers) == 1 and not isinstance(request[strangers[0]], dict | list)
    if not strangers or (slip and _required(model) <= given):
        return ""
    owners = (one for one in requests().items() if _required(one[1]) <= given <= wire_names(one[1]))
    found = [command for command, _ in owners]
    return listed(found, "or") if found else ""


def _in_si(name: str) -> str:
    reading = reading_of(name)
    return name if reading is None else reading.name


def _required(model: type[BaseModel]) -> set[str]:
    fields = model.model_fields.items()
    return {field.alias or name for name, field in fields if field.is_required()}


def _objects(
    model: Any,  # noqa: ANN401
    where: Where,
    here: Any,  # noqa: ANN401
    path: Sequence[str],
) -> Iterator[tuple[Sequence[str], type[BaseModel]]]:
    """Yield the objects of a request, and those that a field alone would make."""
    if isinstance(here, list):
        for number, one in enumerate(here[: MOST_SUGGESTIONS + 1]):  # a million need no look
            yield from _objects(model, (*where, number), one, (*path, str(number)))
    models = models_at(model, where)
    if not isinstance(here, dict) or not models:
        return
    kind = here.get("kind")
    owner = next((one for one in models if kind in kinds_of([one])), None)
    if owner is None and len(models) == 1 and not kinds_of(models):
        owner = models[0]
    if owner is None:
        return
    yield path, owner
    for name in names_in_order(owner):
        if name in here:
            yield from _objects(owner, (name,), here[name], (*path, name))
        elif not path:
            inner = models_at(owner, (name,))
            if len(inner) == 1 and not _required(inner[0]):
                yield (*path, name), inner[0]
