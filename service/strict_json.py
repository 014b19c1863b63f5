"""JSON in which every name of an object stands once: of two the first would be lost in silence."""

import json
from typing import Any, NoReturn

from service.repeated_names import RepeatedNameError, first_repeated_name


def loads(text: bytes | str) -> Any:  # noqa: ANN401
    """Return the value of a JSON text.

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
        raise RepeatedNameError(first_repeated_name(text)) from None


class _RepeatedError(ValueError):
    """Some name stands more than once; where, is looked for then."""


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        raise _RepeatedError
    return made


def _no_constant(text: str) -> NoReturn:
    raise ValueError(f"{text} is no JSON number")
