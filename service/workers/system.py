"""What only some systems have: a fork server, priorities, bounds of memory, processes in `/proc`.

Windows has none of them.
"""

import multiprocessing
import os
import signal
import sys
from contextlib import suppress
from multiprocessing.context import SpawnContext
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import cast

try:
    import resource
except ImportError:
    resource = None  # type: ignore[assignment]

HAS_FORK_SERVER = "forkserver" in multiprocessing.get_all_start_methods()
"""Whether workers are forked from a process that has imported what they need; else each of them
is a Python that starts anew, and imports it all."""

MOST_OF_A_POOL = 61 if sys.platform == "win32" else sys.maxsize
"""Processes that Python can wait for at once."""

TICKS_PER_SECOND = (
    os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") and Path("/proc/self/stat").exists() else 0
)
"""Of the processor times in `/proc`; 0 where there is none."""

KILLED = frozenset(
    -int(getattr(signal, name)) for name in ("SIGKILL", "SIGTERM") if hasattr(signal, name)
)
"""Exit statuses of a process that another has ended."""

FAULTS = frozenset(
    int(getattr(signal, name))
    for name in ("SIGSEGV", "SIGABRT", "SIGBUS", "SIGFPE", "SIGILL", "SIGSYS", "SIGTRAP")
    if hasattr(signal, name)
)
"""Signals that a process brings on itself."""


def context() -> SpawnContext:
    """Return how worker processes are started; both ways are called alike."""
    method = "forkserver" if HAS_FORK_SERVER else "spawn"
    return cast("SpawnContext", multiprocessing.get_context(method))


def make_way(niceness: int, pid: int = 0) -> None:
    """Let other processes go first, where there are priorities.

    Parameters
    ----------
    niceness
        How far a process stands back, 0 to 19.
    pid
        Of that process; 0 for this one.
    """
    if sys.platform != "win32" and hasattr(os, "setpriority"):
        with suppress(ProcessLookupError):  # it has just ended, which is reported
            os.setpriority(os.PRIO_PROCESS, pid, niceness)


def bound_memory(most_bytes: int) -> None:
    """Bound the memory of this process, where the system can [bytes]."""
    if sys.platform != "win32" and resource is not None:
        resource.setrlimit(resource.RLIMIT_DATA, (most_bytes, most_bytes))


def processor_time_s(pid: int) -> float | None:
    """Return the processor time that a process has used [s].

    The time is as exact as the system's ticks. It is None where the process has just ended, and
    where there is no `/proc`.
    """
    if not TICKS_PER_SECOND:
        return None
    try:
        told = Path(f"/proc/{pid}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return None
    # The name, in brackets, may hold anything.
    fields = told.rpartition(")")[2].split()
    return float(int(fields[11]) + int(fields[12])) / TICKS_PER_SECOND


def kill(process: BaseProcess) -> None:
    """End a process at once.

    Without its fork server nobody knows how a process has ended, nor that it has not.
    """
    if sys.platform != "win32" and HAS_FORK_SERVER and process.pid is not None:
        with suppress(ProcessLookupError):
            os.kill(process.pid, signal.SIGKILL)
    else:
        process.kill()
