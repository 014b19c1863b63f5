"""Files appear whole or not at all, and have one writer at a time."""

import glob
import os
import secrets
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFIFO: "a FIFO",
    stat.S_IFSOCK: "a socket",
}
"""What is no file that could be replaced, in words."""


class NotReplaceableError(Exception):
    """What stands at a path is not to be replaced by a file; the message says why."""


def require_replaceable(path: Path) -> None:
    """Raise NotReplaceableError unless a file may be put at a path.

    A path is free or leads to a regular file that may be written. A link is not followed: whoever
    means the file behind it names that.

    Parameters
    ----------
    path
        The path.

    Raises
    ------
    NotReplaceableError
        If something else stands there: says what.
    """
    try:
        found = path.lstat()
    except FileNotFoundError:
        return
    if stat.S_ISLNK(found.st_mode):
        raise NotReplaceableError(
            f"cannot write {path}: it is a link to {path.readlink()}; name the file itself"
        )
    if not stat.S_ISREG(found.st_mode):
        kind = KINDS.get(stat.S_IFMT(found.st_mode), "no file")
        raise NotReplaceableError(f"cannot write {path}: it is {kind}")
    # Root may write what is marked as not to be written.
    if not (found.st_mode & 0o222 and os.access(path, os.W_OK)):
        raise NotReplaceableError(f"cannot write {path}: it is read-only")


def require_not_input(path: Path, given: os.stat_result | None, what: str) -> None:
    """Raise NotReplaceableError if a path leads to a file that was read.

    The file is known by whatever name.

    Parameters
    ----------
    path
        The path.
    given
        The file that was read; None where it was none.
    what
        What that file is, for the message.

    Raises
    ------
    NotReplaceableError
        If both are the same file.
    """
    try:
        found = path.stat()
    except FileNotFoundError:
        return
    if given is not None and os.path.samestat(found, given):
        raise NotReplaceableError(f"cannot write {path}: it is {what}")


def write_whole(path: Path, content: bytes) -> None:
    """Write a file whole or not at all.

    A temporary file beside it is renamed when complete.

    Parameters
    ----------
    path
        The file.
    content
        The bytes of the file.

    Raises
    ------
    NotReplaceableError
        If something else than a file that may be written stands there.
    OSError
        If the file cannot be written.
    """
    write_pieces(path, [content])


def write_pieces(path: Path, pieces: Iterable[bytes]) -> None:
    """Write a file piece by piece, whole or not at all.

    A temporary file beside it is renamed when complete. A file that is replaced hands its
    permissions on.

    Parameters
    ----------
    path
        The file.
    pieces
        The bytes of the file in order; an error of theirs passes, and no file is written.

    Raises
    ------
    NotReplaceableError
        If something else than a file that may be written stands there.
    OSError
        If the file cannot be written.
    """
    require_replaceable(path)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(8)}.part")
    file = temporary.open("xb")
    try:
        with file:
            for piece in pieces:
                file.write(piece)
            file.flush()
            os.fsync(file.fileno())  # else a lost machine could leave the name without the content
        require_replaceable(path)  # as it is by now
        if path.exists():
            temporary.chmod(stat.S_IMODE(path.stat().st_mode))
        temporary.replace(path)
    except BaseException:
        temporary.unlink()
        raise


def remove_parts(path: Path) -> None:
    """Remove the parts of a file that killed writers have left.

    It is for one who holds the lock of the file.
    """
    for part in path.parent.glob(f".{glob.escape(path.name)}.*.part"):
        part.unlink(missing_ok=True)


class LockedError(Exception):
    """Another process holds the lock."""


@contextmanager
def hold_lock(path: Path) -> Iterator[None]:
    """Hold a lock file; the lock dies with the process, however it ends.

    Raises
    ------
    LockedError
        If another process holds it.
    """
    lock = FileLock(path, timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise LockedError(str(path)) from None
    try:
        yield
    finally:
        with suppress(PermissionError):  # Windows removes no open file, but when it is let go of
            path.unlink(missing_ok=True)
        lock.release()
