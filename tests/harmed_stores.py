"""What may befall the SQLite file of a job store: other processes lock it, or it is no more."""

import multiprocessing
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.patience import PATIENT_S


def _hold(file: str, kind: str, held: Any, let_go: Any) -> None:
    connection = sqlite3.connect(file, isolation_level=None, timeout=PATIENT_S)
    connection.execute(f"BEGIN {kind}")
    held.set()
    let_go.wait()


@contextmanager
def hold_locked(file: Path, kind: str) -> Iterator[None]:
    """Have another process hold a lock on an SQLite file."""
    context = multiprocessing.get_context("spawn")
    held, let_go = context.Event(), context.Event()
    process = context.Process(target=_hold, args=(str(file), kind, held, let_go))
    process.start()
    try:
        assert held.wait(PATIENT_S)
        yield
    finally:
        let_go.set()
        process.join(PATIENT_S)


def delete(file: Path) -> None:
    """Delete a store."""
    for end in ("", "-wal", "-shm"):
        file.with_name(file.name + end).unlink(missing_ok=True)


def empty(file: Path) -> None:
    """Put a database without any table in place of a store."""
    delete(file)
    file.touch()


def damage(file: Path) -> None:
    """Put a file that is no database in place of a store."""
    delete(file)
    file.write_bytes(b"no database at all" * 1000)


HARMS = [(delete, "is gone"), (empty, "tables are gone"), (damage, "is damaged")]
"""Each with what is told of it."""
