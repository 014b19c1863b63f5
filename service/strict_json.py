"""JSON in which every name of an object stands once: of two the first would be lost in silence."""

import json
from typing import Any, NoReturn

from schemas.pointers import json_pointer


class RepeatedNameError(ValueError):
    """A name stands more than once in an object.

    Parameters
    ----------
    pointer
        JSON pointer of the first such name.
    """

    def __init__(self, pointer: str) -> None:
        super().__init__(f"{pointer}: must be given once")
        self.pointer = pointer


def loads(text: bytes | str) -> Any:  # noqa: ANN401
    """Return the value of a JSON text.

    Parameters
    ----------
    text
        The JSON.

    Returns
    -------
    Any
        Objects as dicts, lists as lists.

    Raises
    ------
    RepeatedNameError
        If a name stands more than once in an object.
    ValueError
        If it is no JSON; NaN and infinities are none.
    """
    try:
        return json.loads(text, object_pairs_hook=_object, parse_constant=_no_constant)
    except _RepeatedError:
        told = json.loads(text, object_pairs_hook=_Pairs)
        raise RepeatedNameError(_first_repeated(told, "")) from None


def require_names_once(text: bytes | str) -> None:
    """Raise RepeatedNameError if a name stands twice in an object.

    Parameters
    ----------
    text
        Valid JSON.

    Raises
    ------
    RepeatedNameError
        If a name stands more than once in an object: has the pointer of the first.
    """
    loads(text)


class _RepeatedError(ValueError):
    """Some name stands more than once; where, is looked for then."""


class _Pairs(list[tuple[str, Any]]):
    """An object as its names and values, in order."""


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        raise _RepeatedError
    return made


def _first_repeated(here: Any, pointer: str) -> str:  # noqa: ANN401 - any JSON
    """Return the pointer of the first repeated name, from the outside in; empty if none is."""
    if isinstance(here, _Pairs):
        inner, seen = list(here), set[str]()
        for name, _ in inner:
            if name in seen:
                return pointer + json_pointer([name])
            seen.add(name)
    elif isinstance(here, list):
        inner = [(str(number), value) for number, value in enumerate(here)]
    else:
        return ""
    found = (_first_repeated(value, pointer + json_pointer([name])) for name, value in inner)
    return next((one for one in found if one), "")


def _no_constant(text: str) -> NoReturn:
    raise ValueError(f"{text} is no JSON number")
