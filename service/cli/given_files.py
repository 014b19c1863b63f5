"""Files that the command line names: read, and refused before work is done."""

import os
import sys
from pathlib import Path
from typing import Literal

PICTURES: dict[str, Literal["png", "svg", "html"]] = {
    ".png": "png",
    ".svg": "svg",
    ".html": "html",
}
"""Formats of a picture, by the end of its file's name."""


class UsageError(Exception):
    """The command line asks for what cannot be."""


def read_file(name: str) -> tuple[bytes, os.stat_result]:
    """Return what a file holds, and which file it is.

    Parameters
    ----------
    name
        Name of the file; ``-`` for standard input.

    Returns
    -------
    bytes
        The content.
    stat_result
        By which the file is known, whatever its name.

    Raises
    ------
    UsageError
        If the file cannot be read.
    """
    if name == "-":
        return sys.stdin.buffer.read(), os.fstat(sys.stdin.fileno())
    try:
        with Path(name).open("rb") as file:
            return file.read(), os.fstat(file.fileno())
    except OSError as error:
        raise UsageError(f"cannot read {name}: {error.strerror}") from None


def require_picture(path: Path, read: os.stat_result) -> None:
    """Raise UsageError for a picture that could not be written.

    Parameters
    ----------
    path
        Where the picture goes.
    read
        The request.

    Raises
    ------
    UsageError
        If its name is of no format, or as of `require_file`.
    """
    if path.suffix not in PICTURES:
        ends = ", ".join(PICTURES)
        raise UsageError(f"--plot takes a name ending in one of {ends}, got {str(path)!r}")
    require_file(path, read, "the request itself")


def require_file(path: Path, read: os.stat_result | None, what: str) -> None:
    """Raise UsageError for an output that could not be written.

    Parameters
    ----------
    path
        Where the output goes.
    read
        A file that was read, which it must not replace; None for none.
    what
        What that file is, for the message.

    Raises
    ------
    UsageError
        If something else stands there, the folder is missing or read-only, or it is what was read.
    """
    from service.files import NotReplaceableError, require_not_input, require_replaceable  # noqa: PLC0415

    try:
        require_not_input(path, read, what)
        require_replaceable(path)
    except NotReplaceableError as error:
        raise UsageError(str(error)) from None
    if not path.parent.is_dir():
        raise UsageError(f"cannot write {path}: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise UsageError(f"cannot write {path}: the folder {path.parent} is read-only")


def is_same_file(one: Path, other: Path) -> bool:
    """Return whether two paths lead to one file.

    Parameters
    ----------
    one, other
        The paths; there need not be a file yet.

    Returns
    -------
    bool
        Links are followed.
    """
    return one.resolve() == other.resolve()
