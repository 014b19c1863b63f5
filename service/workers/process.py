"""One worker process, and the socket to it.

CasADi crashes when threads share it, and only a process can be ended in time. Pools of the standard
library and of PyPI cost a third to a half of a millisecond a task in threads and locks, and a
design takes two.
"""

import asyncio
import pickle
import signal
import socket
import struct
import time
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Literal

from service.operations.table import TABLE
from service.workers import system
from service.workers.own_path import ensure_fork_server
from service.workers.solvers import warm_solvers
from service.workers.watchdog import end_with_parent

LENGTH = struct.Struct("!i")
"""What `multiprocessing.connection` sends ahead of a message of up to 2 GiB."""

NICENESS, NICENESS_OF_LARGE = 5, 10
"""Of workers, which let the event loop go first on the processors too; of one that is busy with
large work, which lets what is small go first."""

STATUS_WAIT_S = 0.5
"""How long the exit status of a process that has ended may take to arrive [s]."""

PRELOADED = [
    "service.dispatch",
    "service.jobs.results",
    "service.jobs.work",
    "service.workers.warm",
    *(f"service.operations.{name}" for name in TABLE),
]
"""What the fork server imports, and its workers need not."""

Outcome = Literal["ready", "done", "failed", "memory"]


def prepare() -> None:
    """Start the fork server if none is running and the system has one."""
    ensure_fork_server(PRELOADED)


class Worker(asyncio.Protocol):
    """One process; does one task at a time.

    On the worker's side the socket is a `multiprocessing` connection, on this side a protocol of
    the event loop that speaks the same: a length, then a pickle.

    Parameters
    ----------
    memory_bytes
        Memory that the process may have for itself [bytes].
    take_outcome
        Called with each outcome and what came with it.
    forget
        Called once, when the process has ended or is out of reach.

    Attributes
    ----------
    cost_s
        Processor time of its latest task that has ended [s].
    """

    def __init__(
        self,
        memory_bytes: int,
        take_outcome: Callable[["Worker", Outcome, object], None],
        forget: Callable[["Worker"], None],
    ) -> None:
        self._take_outcome = take_outcome
        self._forget = forget
        self._received = bytearray()
        self._used_s = 0.0
        self._begun_s = time.monotonic()
        self.cost_s = 0.0
        self._transport: asyncio.WriteTransport | None = None
        self._socket, theirs = _socket_pair()
        self._process: BaseProcess = system.context().Process(
            target=_work, args=(theirs, memory_bytes), daemon=True, name="shapersmith-worker"
        )
        try:
            self._process.start()
        except BaseException:
            self._socket.close()
            raise
        finally:
            theirs.close()

    @property
    def pid(self) -> int | None:
        """Process id."""
        return self._process.pid

    async def connect(self) -> None:
        """Listen to it from now on; its first outcome is that it is ready."""
        loop = asyncio.get_running_loop()
        await loop.create_connection(lambda: self, sock=self._socket)

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Keep the way to the process."""
        self._transport = transport  # type: ignore[assignment]

    def data_received(self, data: bytes) -> None:
        """Tell each outcome that is whole."""
        self._received += data
        while len(self._received) >= LENGTH.size:
            (size,) = LENGTH.unpack_from(self._received)
            if len(self._received) < LENGTH.size + size:
                return
            # What is large is not copied: the loop has others to serve.
            with memoryview(self._received) as whole, whole[LENGTH.size :] as rest:
                outcome, result, used_s = pickle.loads(rest)
            del self._received[: LENGTH.size + size]
            self.cost_s, self._used_s = used_s - self._used_s, used_s
            self._take_outcome(self, outcome, result)

    def connection_lost(self, exc: Exception | None) -> None:
        """Tell that the process is gone."""
        del exc
        self._transport = None
        self._forget(self)

    def send(self, task: Callable[..., object], arguments: tuple[object, ...]) -> None:
        """Send a task; its outcome or the loss of the worker is reported.

        The callbacks that the worker was made with report it.

        Parameters
        ----------
        task
            A function of a module.
        arguments
            What it takes.
        """
        message = pickle.dumps((task, arguments))
        self._begun_s = time.monotonic()
        if self._transport is not None:
            self._transport.writelines([LENGTH.pack(len(message)), message])

    def spent_s(self) -> float:
        """Return the processor time of its present task [s].

        It is 0 where the process has just ended. Where the system does not say it is the time since
        the task began, which is no less.
        """
        if not system.TICKS_PER_SECOND:
            return time.monotonic() - self._begun_s
        told_s = None if self.pid is None else system.processor_time_s(self.pid)
        return 0.0 if told_s is None else told_s - self._used_s

    def make_way(self) -> None:
        """Let other processes go first."""
        if self.pid is not None:
            system.make_way(NICENESS_OF_LARGE, self.pid)

    async def ending(self) -> str:
        """Return how the process has ended, in words."""
        for _ in range(round(STATUS_WAIT_S / 0.01)):
            if self._process.exitcode is not None:
                break
            await asyncio.sleep(0.01)
        return _in_words(self._process.exitcode)

    @property
    def by_its_own_fault(self) -> bool:
        """Whether the process crashed of itself.

        One that was killed from outside, or ended with its fork server, did not.
        """
        code = self._process.exitcode
        return code is not None and code not in {0, UNKNOWN, *system.KILLED}

    def kill(self) -> None:
        """End the process at once; that it is lost is no longer reported."""
        self._forget = _nobody
        self._take_outcome = _nobody
        # Its exit status alone may be that of a fork server that has died.
        if self._transport is not None or self._process.exitcode is None:
            system.kill(self._process)
        self.close()

    def close(self) -> None:
        """Close the socket, at which an idle process ends."""
        if self._transport is None:
            self._socket.close()
        else:
            self._transport.close()

    def join(self, wait_s: float) -> None:
        """Wait for the process, whose socket is closed, and kill it if late.

        Parameters
        ----------
        wait_s
            How long to wait [s].
        """
        self._process.join(wait_s)
        if self._process.is_alive():
            self._process.kill()


UNKNOWN = 255
"""The exit status of a process whose fork server has died before it."""


def _nobody(*_: object) -> None:
    """Hear what nobody wants to know."""


def _in_words(code: int | None) -> str:
    if code is None or code == UNKNOWN:
        return "ended, its status unknown"
    if code < 0:
        return f"killed by {signal.Signals(-code).name}"
    return f"ended with status {code}"


def _socket_pair() -> tuple[socket.socket, socket.socket]:
    """Return two sockets that are joined; what is sent is not held back for more to come."""
    pair = socket.socketpair()
    for one in pair:
        if one.family == socket.AF_INET:  # Windows has no others that are joined
            one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return pair


def _work(ours: socket.socket, memory_bytes: int) -> None:
    """Do tasks as they come, until the socket closes; the parent alone hears signals."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    pipe = Connection(ours.detach())
    warm_solvers()
    system.make_way(NICENESS)
    system.bound_memory(memory_bytes)
    try:
        pipe.send(("ready", None, time.process_time()))
        while True:
            task, arguments = pipe.recv()
            pipe.send_bytes(_outcome(task, arguments))
    except (EOFError, OSError):
        return  # the pool has closed its end


def _outcome(task: Callable[..., object], arguments: tuple[object, ...]) -> bytes:
    """Do a task; return the pickle of how it ended, what it gave, and the processor time so far."""
    outcome: Outcome
    try:
        return pickle.dumps(("done", task(*arguments), time.process_time()))
    except MemoryError:
        outcome = "memory"
    except Exception:  # noqa: BLE001 - given to the pool, which logs it
        outcome = "failed"
    return pickle.dumps((outcome, traceback.format_exc(limit=-5), time.process_time()))
