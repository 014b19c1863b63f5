"""Files appear whole or not at all, and have one writer at a time."""

import fcntl
import glob
import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path


def write_whole(path: Path, content: bytes) -> None:
    """Write a file by way of a temporary one beside it, renamed when complete."""
    write_pieces(path, [content])


def write_pieces(path: Path, pieces: Iterable[bytes]) -> None:
    """Write a file piece by piece, by way of a temporary one beside it, renamed when complete."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            for piece in pieces:
                file.write(piece)
            file.flush()
            os.fsync(file.fileno())  # else a lost machine could leave the name without the content
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink()
        raise


def remove_parts(path: Path) -> None:
    """Remove what killed writers of a file left behind; for one who holds its lock."""
    for part in path.parent.glob(f".{glob.escape(path.name)}.*.part"):
        part.unlink(missing_ok=True)


class LockedError(Exception):
    """Another process holds the lock."""


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock file; the lock dies with the process, however it ends.

    Raises
    ------
    LockedError
        If another process holds it.
    """
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            raise LockedError(str(path)) from None
        try:
            mine = os.path.samestat(os.fstat(handle), path.stat())
        except FileNotFoundError:
            mine = False
        if mine:
            break
        os.close(handle)  # its last holder removed it between our two calls
    try:
        yield
    finally:
        path.unlink(missing_ok=True)
        os.close(handle)
