"""The processes of a service, as the system tells of them."""

import os
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from tests.conftest import Running
from tests.patience import PATIENT_S

Found = TypeVar("Found")

TICKS_PER_SECOND = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True, kw_only=True)
class Process:
    """What the system tells of a process; ``used_s`` is its processor time so far [s]."""

    pid: int
    parent: int
    state: str
    used_s: float


def process(pid: int) -> Process | None:
    """Return what the system tells of a process; None where there is none."""
    try:
        told = Path(f"/proc/{pid}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return None
    # The name, in brackets, may hold anything.
    fields = told.rpartition(")")[2].split()
    used_s = (int(fields[11]) + int(fields[12])) / TICKS_PER_SECOND
    return Process(pid=pid, parent=int(fields[1]), state=fields[0], used_s=used_s)


def children(pid: int) -> set[int]:
    """Return all processes below one."""
    found: set[int] = set()
    for one in filter(None, map(process, _pids())):
        if one.parent == pid:
            found |= {one.pid} | children(one.pid)
    return found


def end(pid: int, number: int = signal.SIGKILL) -> bool:
    """End a process that was seen; return False if it has ended by itself meanwhile."""
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        return False
    return True


def running(pids: set[int]) -> set[int]:
    """Return those of some processes that have not ended; a zombie has."""
    return {one.pid for one in filter(None, map(process, pids)) if one.state != "Z"}


def started_with(variable: str) -> dict[int, Process]:
    """Return the processes that have ``NAME=value`` in their environment, by their ids.

    So are found those too whose parent has ended.
    """
    found = {}
    for pid in _pids():
        try:
            environment = Path(f"/proc/{pid}/environ").read_bytes()
        except (FileNotFoundError, ProcessLookupError, PermissionError):
            continue  # it ended meanwhile, or is another user's
        if variable.encode() in environment.split(b"\0") and (one := process(pid)) is not None:
            found[pid] = one
    return found


def of_service(service: Running) -> dict[int, Process]:
    """Return all processes of a service, those that it has lost too."""
    return started_with(f"SHAPERSMITH_DATA_DIR={service.data}")


def table_process(service: Running) -> int:
    """Return the process that runs the table jobs of a service; 0 where there is none."""
    for pid in children(service.process.pid):
        with suppress(FileNotFoundError, ProcessLookupError):
            if b"service.jobs.running" in Path(f"/proc/{pid}/cmdline").read_bytes():
                return pid
    return 0


def workers(service: Running) -> dict[int, float]:
    """Return the processes that answer requests, with the processor time each has used [s].

    They are forked by a process that the service starts: its own children are none, nor is what
    computes tables.
    """
    own, tables = service.process.pid, table_process(service)
    others = {own, *(children(tables) if tables else ())}
    return {
        pid: one.used_s
        for pid, one in of_service(service).items()
        if pid not in others and one.parent != own
    }


def _pids() -> list[int]:
    return [int(entry.name) for entry in Path("/proc").iterdir() if entry.name.isdigit()]


def until(found: Callable[[], Found], what: str) -> Found:
    """Return what comes to be, however slow the machine is."""
    hung = time.monotonic() + PATIENT_S
    while not (one := found()):
        assert time.monotonic() < hung, what
        time.sleep(0.02)
    return one
