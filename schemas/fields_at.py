"""What the wire models expect at a place of a request, for those who explain a fault there."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel


def expected_at(model: Any, location: Sequence[int | str]) -> tuple[Any, ...]:  # noqa: ANN401
    """Return the types that are expected at a place.

    Parameters
    ----------
    model
        Model of the request, or a union of models.
    location
        Names, tags of unions and numbers of list items, as pydantic says them.

    Returns
    -------
    tuple
        Models or other types; empty where none is known.
    """
    here = tuple(_types(model))
    for step in location:
        here = _inner(here, step)
    return here


TAGS = ("kind", "mode")
"""Names of the fields that say which model of a union is meant."""


def kinds_of(expected: Sequence[Any]) -> list[str]:
    """Return the kinds, or modes, of those types that are models with one."""
    models = [one for one in expected if _is_model(one)]
    fields = (one.model_fields.get(tag) for one in models for tag in TAGS)
    return [kind for field in fields if field for kind in get_args(field.annotation)]


def also_called(expected: Sequence[Any]) -> dict[str, tuple[str, ...]]:
    """Return what people call kinds, of those types whose models say it."""
    models = [one for one in expected if getattr(one, "ALSO", ())]
    return {kind: one.ALSO for one in models for kind in kinds_of([one])}


def _inner(here: tuple[Any, ...], step: int | str) -> tuple[Any, ...]:
    if isinstance(step, int):
        lists = (one for one in here if get_origin(one) in {list, tuple})
        return tuple(type_ for one in lists for type_ in _types(get_args(one)[0]))
    models = [one for one in here if _is_model(one)]
    if len(models) > 1:
        return tuple(one for one in models if step in {one.__name__, *kinds_of([one])})
    fields = (item for one in models for item in one.model_fields.items())
    named = (field for name, field in fields if step == (field.alias or name))
    return tuple(type_ for field in named for type_ in _types(field.annotation))


def _types(annotation: Any) -> list[Any]:  # noqa: ANN401 - any annotation
    """Return the types of a union; one that is none as it is."""
    origin = get_origin(annotation)
    if origin is Annotated:
        return _types(get_args(annotation)[0])
    if origin in {list, tuple, dict, Literal} or not get_args(annotation):
        return [annotation]
    return [inner for one in get_args(annotation) for inner in _types(one)]


def _is_model(annotation: object) -> bool:
    return isinstance(annotation, type) and issubclass(annotation, BaseModel)
