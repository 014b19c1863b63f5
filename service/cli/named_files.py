"""Files that the command line names: read, or looked at before the work is done."""

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


def read(name: str) -> tuple[bytes, os.stat_result]:
    """Return what a file holds, or standard input, and which file it is.

    Returns
    -------
    tuple of bytes and os.stat_result
        Its content, and its place on the disk.

    Raises
    ------
    UsageError
        If it cannot be read.
    """
    if name == "-":
        return sys.stdin.buffer.read(), os.fstat(sys.stdin.fileno())
    try:
        with Path(name).open("rb") as opened:
            return opened.read(), os.fstat(opened.fileno())
    except OSError as error:
        raise UsageError(f"cannot read {name}: {error.strerror}") from None


def require_picture(path: Path, file: os.stat_result) -> None:
    """Refuse a picture that could not be written, before the work is done.

    Parameters
    ----------
    path
        The picture.
    file
        What was read, which it must not be.

    Raises
    ------
    UsageError
        If its name ends otherwise, or it cannot be written.
    """
    if path.suffix not in PICTURES:
        ends = ", ".join(PICTURES)
        raise UsageError(f"--plot takes a name ending in one of {ends}, got {str(path)!r}")
    require_file(path, file, "the request itself")


def require_file(path: Path, file: os.stat_result | None, what: str) -> None:
    """Refuse an output that could not be written, or is what was read.

    Parameters
    ----------
    path
        The output.
    file, what
        What was read, if anything, and what it is called.

    Raises
    ------
    UsageError
        If it cannot be written, or is the same file.
    """
    from service.files import NotReplaceableError, require_not_input, require_replaceable  # noqa: PLC0415

    try:
        require_not_input(path, file, what)
        require_replaceable(path)
    except NotReplaceableError as error:
        raise UsageError(str(error)) from None
    if not path.parent.is_dir():
        raise UsageError(f"cannot write {path}: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise UsageError(f"cannot write {path}: the folder {path.parent} is read-only")


def same_file(one: Path, other: Path) -> bool:
    """Return whether two paths are one file.

    Parameters
    ----------
    one, other
        The paths; the files need not be there.

    Returns
    -------
    bool
        Whether they are.
    """
    return one.resolve() == other.resolve()
