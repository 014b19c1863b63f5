"""JSON pointers (RFC 6901): paths into a request as texts."""

from collections.abc import Sequence


def json_pointer(parts: Sequence[str]) -> str:
    """Return the pointer of a path, as RFC 6901 writes it.

    Returns
    -------
    str
        With a slash ahead of each part; empty for no parts.

    Examples
    --------
    >>> json_pointer(["plant", "a/b~c", "0"])
    '/plant/a~1b~0c/0'
    """
    return "".join(f"/{part.replace('~', '~0').replace('/', '~1')}" for part in parts)


def path_of(pointer: str) -> tuple[str, ...]:
    """Return the path of a pointer, the reverse of `json_pointer`.

    Returns
    -------
    tuple of str
        Parts without escapes.

    Examples
    --------
    >>> path_of("/plant/a~1b~0c/0")
    ('plant', 'a/b~c', '0')
    """
    parts = pointer.removeprefix("/").split("/")
    return tuple(part.replace("~1", "/").replace("~0", "~") for part in parts)
