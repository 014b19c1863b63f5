"""Names that stand more than once in an object of JSON, and where the first does."""

import json
from typing import Any

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


def first_repeated_name(text: bytes | str) -> str:
    """Return the JSON pointer of the first repeated name; empty if none is."""
    return _first_repeated(json.loads(text, object_pairs_hook=_Pairs), "")


class _Pairs(list[tuple[str, Any]]):
    """An object as its names and values, in order."""


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
