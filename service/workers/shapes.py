"""Shapes of requests: what two share that are expected to cost alike."""

import re
from collections.abc import Hashable

MAX_SHAPE_BYTES = 16_384
"""Shorter bodies are distinguished by all but their numbers, longer ones by length [bytes]."""

NUMBERS = re.compile(rb"[-+.\d]+(?:[eE][-+]?\d+)?")


def shape_of(operation: str, body: bytes) -> Hashable:
    """Return what two requests share that differ in their numbers only.

    Parameters
    ----------
    operation, body
        Name of what is done with the request; beyond `MAX_SHAPE_BYTES` only the magnitude of its
        length counts [bytes].

    Returns
    -------
    Hashable
        Equal for requests that are expected to cost alike.
    """
    if len(body) > MAX_SHAPE_BYTES:
        return operation, len(body).bit_length()
    return operation, NUMBERS.sub(b"", body)
