"""Worker processes: CasADi crashes when threads share it, and only a process can be ended in time.

A pool of our own, since those of the standard library and of PyPI cost a third to a half of a
millisecond a task in threads and locks, and a design takes two.
"""

import asyncio
import gc
import logging
import multiprocessing
import os
import pickle
import signal
import socket
import struct
import threading
import traceback
import warnings
from collections.abc import Callable
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from design.actuators import FirstOrder, Ideal, SecondOrder, SecondOrderSet
from design.pipeline import design
from design.plants import Mode
from design.shapers.registry import SHAPERS
from service.problems import INTERNAL, OVERLOADED, TIME_LIMIT, Problem

RETRIES = 1
"""How often a task is given to another worker when its own dies."""

LENGTH = struct.Struct("!i")
"""What `multiprocessing.connection` sends ahead of a message of up to 2 GiB."""

LONGEST_WAIT_S = 30.0
"""How long a task may wait for a worker [s]."""

START_PAUSE_S = 1.0
"""Wait after a worker that could not be started: whatever it was, do not spin on it [s]."""

STOP_WAIT_S = 5.0
"""How long an idle worker may take to end before it is killed [s]."""

ERRORS = logging.getLogger("shapersmith.error")


class TaskError(Exception):
    """A task that has no answer."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.detail)
        self.problem = problem


class WorkerDiedError(Exception):
    """The worker ended before its answer."""


class Worker:
    """One process and the socket to it; does one task at a time.

    On the worker's side the socket is a `multiprocessing` connection, on this side a stream of the
    event loop that speaks the same: a length, then a pickle.
    """

    def __init__(self) -> None:
        context = multiprocessing.get_context("forkserver")
        ours, theirs = context.Pipe()
        self._process: BaseProcess = context.Process(
            target=_work, args=(theirs,), daemon=True, name="shapersmith-worker"
        )
        self._process.start()
        theirs.close()
        self._socket = socket.socket(fileno=os.dup(ours.fileno()))
        ours.close()
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None

    @property
    def pid(self) -> int | None:
        """Process id."""
        return self._process.pid

    async def ready(self) -> None:
        """Wait until its solvers are built."""
        self._streams = await asyncio.open_connection(sock=self._socket)
        await self._received(self._streams[0])

    async def run(self, task: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
        """Return whether the task ended well, and its result or its traceback.

        Raises
        ------
        WorkerDiedError
            If the process ends first.
        """
        if self._streams is None:
            raise WorkerDiedError
        reader, writer = self._streams
        message = pickle.dumps((task, arguments))
        try:
            writer.write(LENGTH.pack(len(message)) + message)
            await writer.drain()
        except OSError as error:
            raise WorkerDiedError from error
        done: tuple[bool, Any] = await self._received(reader)
        return done

    async def _received(self, reader: asyncio.StreamReader) -> Any:  # noqa: ANN401
        try:
            (size,) = LENGTH.unpack(await reader.readexactly(LENGTH.size))
            return pickle.loads(await reader.readexactly(size))
        except (asyncio.IncompleteReadError, OSError) as error:
            raise WorkerDiedError from error

    def kill(self) -> None:
        """End the process at once."""
        self._process.kill()
        self.close()

    def join(self) -> None:
        """Wait for the process, which ends when its socket is closed."""
        self._process.join(STOP_WAIT_S)
        if self._process.is_alive():
            self._process.kill()

    def close(self) -> None:
        """Close the socket."""
        if self._streams is None:
            self._socket.close()
        else:
            self._streams[1].close()


class WorkerPool:
    """A fixed number of workers, each with its solvers built; dead ones are replaced.

    Parameters
    ----------
    workers
        Number of processes.
    time_limit_s
        Longest run of one task; its worker is ended then [s].
    max_pending
        Tasks running and waiting beyond which new ones are refused.
    """

    def __init__(self, *, workers: int, time_limit_s: float, max_pending: int) -> None:
        self.time_limit_s = time_limit_s
        self.max_pending = max_pending
        self.pending = 0
        self._idle: asyncio.Queue[Worker] = asyncio.Queue()
        self._all: set[Worker] = set()
        self._built: set[Worker] = set()
        self._starting: set[asyncio.Task[None]] = set()
        # One thread of BLAS a worker: the workers are the parallelism.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        multiprocessing.get_context("forkserver").set_forkserver_preload([
            "service.answers",
            "service.pool",
            "casadi",
        ])
        for _ in range(workers):
            self._start_one()

    async def run(self, task: Callable[..., Any], *arguments: Any) -> Any:  # noqa: ANN401
        """Run a task in a worker.

        Raises
        ------
        TaskError
            If too much waits, or it waits too long; if the time limit ends it, its worker dies
            twice, or it fails.
        """
        if self.pending >= self.max_pending:
            raise TaskError(
                Problem(OVERLOADED, f"{self.pending} tasks are running or waiting; try again later")
            )
        self.pending += 1
        try:
            for _ in range(1 + RETRIES):
                worker = await self._idle_worker()
                try:
                    well, result = await self._run_on(worker, task, arguments)
                except WorkerDiedError:
                    ERRORS.error("worker %s died at a task", worker.pid)
                    continue
                if well:
                    return result
                ERRORS.error("a task failed: %s", result)
                raise TaskError(Problem(INTERNAL, "the service failed; its log has the reason"))
            raise TaskError(Problem(INTERNAL, "the worker died at this request, twice"))
        finally:
            self.pending -= 1

    @property
    def ready(self) -> bool:
        """Whether a worker lives whose solvers are built, and there is room for a task."""
        return bool(self._built) and self.pending < self.max_pending

    async def _idle_worker(self) -> Worker:
        if not self._idle.empty():
            return self._idle.get_nowait()
        try:
            async with asyncio.timeout(LONGEST_WAIT_S):
                return await self._idle.get()
        except TimeoutError:
            detail = f"no worker was free within {LONGEST_WAIT_S:g} s"
            raise TaskError(Problem(OVERLOADED, detail)) from None

    async def _run_on(
        self, worker: Worker, task: Callable[..., Any], arguments: tuple[Any, ...]
    ) -> tuple[bool, Any]:
        """Run a task on an idle worker, and put it back, or replace it."""
        try:
            async with asyncio.timeout(self.time_limit_s):
                done = await worker.run(task, arguments)
        except BaseException as error:
            # Out of step with the pool, whatever the reason: late, dead, or nobody waits any more.
            self._replace(worker)
            if isinstance(error, TimeoutError):
                raise TaskError(
                    Problem(TIME_LIMIT, f"the work was ended after {self.time_limit_s:g} s")
                ) from None
            raise
        self._idle.put_nowait(worker)
        return done

    def _replace(self, worker: Worker) -> None:
        worker.kill()
        self._all.discard(worker)
        self._built.discard(worker)
        self._start_one()

    def _start_one(self) -> None:
        starting = asyncio.get_running_loop().create_task(self._started())
        self._starting.add(starting)
        starting.add_done_callback(self._starting.discard)

    async def _started(self) -> None:
        try:
            worker = Worker()
        except OSError as error:
            ERRORS.error("no worker could be started: %s", error)
            await asyncio.sleep(START_PAUSE_S)
            self._start_one()
            return
        self._all.add(worker)
        try:
            await worker.ready()
        except WorkerDiedError:
            ERRORS.error("worker %s died at its start", worker.pid)
            await asyncio.sleep(START_PAUSE_S)
            self._replace(worker)
        else:
            self._built.add(worker)
            self._idle.put_nowait(worker)

    async def close(self) -> None:
        """End the workers; all tasks have ended."""
        for starting in list(self._starting):
            starting.cancel()
        await asyncio.gather(*self._starting, return_exceptions=True)
        for worker in self._all:
            worker.close()
        await asyncio.gather(*(asyncio.to_thread(worker.join) for worker in self._all))


def _work(pipe: Connection) -> None:
    """Do tasks as they come, until the pipe closes; the parent alone hears signals."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()
    # Results are checked to be finite; a warning on the way would break the log of JSON lines.
    warnings.simplefilter("ignore", RuntimeWarning)
    warm_solvers()
    gc.freeze()  # what is built now stays: collections need not look at it again
    try:
        pipe.send(None)
        while True:
            task, arguments = pipe.recv()
            try:
                done = True, task(*arguments)
            except Exception:  # noqa: BLE001 - told to the pool, which logs it
                done = False, traceback.format_exc()
            pipe.send(done)
    except (EOFError, OSError):
        return  # the pool has closed its end


def _end_with(sentinel: int) -> None:
    """End this process when its parent ends, in the middle of a solve too."""
    wait([sentinel])
    os._exit(0)


def warm_solvers() -> None:
    """Build the solvers of every shaper by designing each once."""
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.05)
    one = SecondOrderSet(natural_frequency_rad_s=10.0, damping_ratio=0.8)
    for actuator in (
        Ideal(),
        FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1, model="switched"),
        SecondOrder(accel=one, decel=one, model="switched"),
    ):
        for kind in SHAPERS.values():
            if actuator.kind in kind.actuators:
                design(mode, actuator, kind)
