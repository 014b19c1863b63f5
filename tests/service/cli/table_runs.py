"""Runs of the command `table`."""

import sqlite3
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.conftest import CRANE
from tests.processes import until
from tests.service.cli.commands import COMMAND, Done, shapersmith, shapersmith_apart

SMALL: dict[str, Any] = {
    "design": {**CRANE, "shaper": {"kind": "numzv"}},
    "axes": [{"field": "/plant/cable_length_m", "from": 0.5, "to": 1.0, "points": 40}],
    "chunk_rows": 4,
}


def table(*arguments: object) -> Done:
    """Run the command in this process."""
    return shapersmith("table", *arguments)


def table_apart(*arguments: object) -> Done:
    """Run the command as a user does."""
    return shapersmith_apart("table", *arguments)


def chunks_done(store: Path) -> int:
    """Return how many chunks a store holds; none while it is being made."""
    if not store.exists():
        return 0
    connection = sqlite3.connect(f"file:{store}?mode=ro", uri=True)
    try:
        query = "SELECT count(*) FROM chunks WHERE state = 'done'"
        return int(connection.execute(query).fetchone()[0])
    except sqlite3.OperationalError:
        return 0
    finally:
        connection.close()


@contextmanager
def begun(spec: Path, path: Path, **options: Any) -> "Iterator[subprocess.Popen[str]]":
    """Begin a long table, and wait until some of it is in its store."""
    already = chunks_done(path.with_name(f".{path.name}.job"))
    process = subprocess.Popen(
        [*COMMAND, "table", str(spec), "-o", str(path)],
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )
    try:
        store = path.with_name(f".{path.name}.job")
        until(
            lambda: chunks_done(store) != already or process.poll() is not None,
            "no chunk is done",
        )
        assert process.poll() is None
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()
