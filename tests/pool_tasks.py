"""What the tests of the pool have its workers do."""

import os
import signal
import time
from pathlib import Path


def echo(value: object) -> object:
    """Return what it is given."""
    return value


def asleep(seconds: float) -> int:
    """Sleep, and return the worker's process id."""
    time.sleep(seconds)
    return os.getpid()


def busy_until(path: str) -> int:
    """Use processor time until there is a file, and return the worker's process id."""
    while not Path(path).exists():
        pass
    return os.getpid()


def busy(seconds: float) -> int:
    """Use so much processor time, and return the worker's process id."""
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass
    return os.getpid()


def note(path: str, value: str) -> None:
    """Add a line to a file: who was served, in order."""
    with Path(path).open("a") as file:
        file.write(f"{value}\n")


def crash() -> None:
    """End the worker as a fault of its own would."""
    os.kill(os.getpid(), signal.SIGSEGV)


def kill_until(path: str, times: int) -> str:
    """End the worker as somebody else would, some times; then answer."""
    note(path, "killed")
    if Path(path).read_text().count("killed") <= times:
        os.kill(os.getpid(), signal.SIGKILL)
    return "answered"


def hungry(size: int) -> int:
    """Ask for memory."""
    return len(bytearray(size))


def fail() -> None:
    """Fail."""
    raise ZeroDivisionError


def unsendable() -> object:
    """Return what cannot be pickled."""
    return lambda: None
