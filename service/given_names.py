"""Where a fault is, by the names that the request itself has for its fields."""

from itertools import zip_longest
from typing import Any

from design.errors import InvalidInputError, Path
from schemas.pointers import json_pointer
from schemas.units import other_names


def pointer(location: tuple[int | str, ...], body: Any) -> str:  # noqa: ANN401 - any JSON
    """Return the JSON pointer of a fault.

    Pydantic's location also holds the tags of unions, as ``("plant", "mode", "damping_ratio")``; a
    tag is known by the ``kind`` of the object it stands in, or, of unions without a kind, as a name
    that is not there though it is not the last, or that no object is there to hold.

    Parameters
    ----------
    location
        Names, tags and numbers of list items, from the body inward.
    body
        The JSON that the model was given, parsed.

    Returns
    -------
    str
        The pointer, without the tags.
    """
    parts: list[str] = []
    here = body
    for said, after in zip_longest(location, location[1:]):
        step = _name_given(said, here)
        if isinstance(here, dict) and here.get("kind") == step:
            # A field may have the name of the tag: a list is not entered by a name.
            entered = isinstance(after, str) and not isinstance(here.get(step), dict)
            if step not in here or entered:
                continue
        named_here = isinstance(here, dict) and (step in here or after is None)
        if isinstance(step, str) and here is not None and not named_here:
            continue
        parts.append(str(step))
        if isinstance(here, dict):
            here = here.get(step)
        elif isinstance(here, list) and isinstance(step, int) and step < len(here):
            here = here[step]
        else:
            here = None
    return json_pointer(parts)


def _name_given(name: int | str, here: Any) -> int | str:  # noqa: ANN401 - any JSON
    """Return the name by which an object has a field: in another unit, maybe."""
    if not isinstance(here, dict) or not isinstance(name, str) or name in here:
        return name
    return next((other for other in other_names(name) if other in here), name)


def without_made_modes(error: InvalidInputError, here: Any) -> InvalidInputError:  # noqa: ANN401
    """Return a fault of modes as that of the plant whose fields make them.

    Only a plant of kind ``modes`` lists them.

    Parameters
    ----------
    error, here
        The fault, and the request as JSON, parsed.

    Returns
    -------
    InvalidInputError
        The same, where it is of no mode that the plant's fields make.
    """
    for depth, name in enumerate(error.path):
        if name == "modes" and isinstance(here, dict) and "modes" not in here and "kind" in here:
            damped = error.path[-1] == "damping_ratio"
            field = "damping_ratio" if damped else "kind"
            return error.at((*error.path[:depth], field), error.value)
        here = here.get(name) if isinstance(here, dict) else None
    return error


def as_given(path: Path, here: Any) -> Path:  # noqa: ANN401
    """Return a path with the names by which the request has its fields.

    Parameters
    ----------
    path, here
        Names and numbers from the body inward, and the request as JSON, parsed.

    Returns
    -------
    Path
        As long as the path given.
    """
    parts: list[str] = []
    for name in path:
        given = str(_name_given(name, here))
        parts.append(given)
        if isinstance(here, dict):
            here = here.get(given)
        elif isinstance(here, list) and name.isdecimal() and int(name) < len(here):
            here = here[int(name)]
        else:
            here = None
    return tuple(parts)
