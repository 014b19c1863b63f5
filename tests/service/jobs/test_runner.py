"""What becomes of a job's chunks when workers die, cannot be started, or cannot read it."""

import json
import os
import signal
import sqlite3
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from multiprocessing import forkserver
from pathlib import Path
from typing import Any

import pytest

from schemas.tables import sha256_of
from service.jobs.executors import Started, fault_of, processes
from service.jobs.plan import Plan, plan_table
from service.jobs.records import Done, Job, NewJob
from service.jobs.runner import MAX_KILLS, Runner
from service.jobs.store import MAX_FAILURES, Store
from tests.conftest import CRANE
from tests.patience import PATIENT_S

SOUND = Done(blob=b"rows", verified=1, infeasible=0)


@pytest.fixture(autouse=True)
def _no_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.jobs.runner.START_PAUSE_S", 0.0)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    opened = Store(f"sqlite:///{tmp_path / 'jobs.sqlite'}", stalled_s=3600.0)
    yield opened
    opened.close()


def table(chunks: int, title: str = "") -> NewJob:
    axis = {"field": "/plant/cable_length_m", "from": 0.5, "to": 1.0, "points": chunks}
    specification = {"design": CRANE, "axes": [axis], "chunk_rows": 1, "title": title or "table"}
    plan = plan_table(json.dumps(specification).encode())
    assert isinstance(plan, Plan)
    return plan.job


Script = Callable[[list[int]], BaseException | None]
"""What becomes of chunks that are in flight together, by their numbers; None: they are computed."""


class Scripted(Executor):
    """An executor that waits for so many chunks, and then does with them what its script says."""

    def __init__(self, script: Script, together: int) -> None:
        self._script = script
        self._together = together
        self._waiting: dict[int, Future[Any]] = {}

    def submit(self, task: Any, /, *arguments: Any, **named: Any) -> "Future[Any]":
        del task, named
        future: Future[Any] = Future()
        self._waiting[arguments[-1]] = future
        if len(self._waiting) == self._together:
            error = self._script(list(self._waiting))
            for one in self._waiting.values():
                if error is None:
                    one.set_result(SOUND)
                else:
                    one.set_exception(error)
            self._waiting.clear()
        return future


def start(script: Script, *, together: int = 1, fault: str = "") -> Started:
    return Started(Scripted(script, together), together, lambda: None, lambda: fault)


def sound(numbers: list[int]) -> None:
    del numbers


def run(store: Store, start: Callable[[], Started], *jobs: NewJob) -> list[str]:
    """Add jobs, run all to their ends, and return what a person is told."""
    for job in jobs:
        store.add(job)
    told: list[str] = []
    runner = Runner(store, start, database_wait_s=PATIENT_S, tell=told.append)
    hung = time.monotonic() + PATIENT_S

    def until() -> bool:
        assert time.monotonic() < hung, told
        return all(job.ended for job in store.jobs(100))

    runner.run(until=until, pause_s=0.0)
    return told


def ended(store: Store, job: NewJob) -> Job:
    found = store.job(job.id)
    assert found is not None
    return found


def attempts(store: Store) -> int:
    with sqlite3.connect(store.url.removeprefix("sqlite:///")) as connection:
        return int(connection.execute("SELECT sum(attempt) FROM chunks").fetchone()[0])


@pytest.mark.parametrize("fault", ["", "SIGSEGV"])
def test_a_death_beside_others_is_blamed_on_none_and_they_are_computed_one_by_one(
    store: Store, fault: str
) -> None:
    seen: list[list[int]] = []

    def breaks(numbers: list[int]) -> BaseException:
        seen.append(numbers)
        return BrokenExecutor("a worker died")

    def alone(numbers: list[int]) -> None:
        seen.append(numbers)

    scripts = iter([start(breaks, together=3, fault=fault), start(alone)])
    (new,) = jobs = [table(5)]
    run(store, lambda: next(scripts), *jobs)
    assert seen == [[0, 1, 2], [0], [1], [2], [3], [4]]
    assert ended(store, new).state == "done"
    assert attempts(store) == 0


def breaking(number: int, times: int) -> Script:
    """Return what breaks so often when a chunk is computed."""
    left = iter(range(times))

    def script(numbers: list[int]) -> BaseException | None:
        broken = number in numbers and next(left, None) is not None
        return BrokenExecutor("a worker died") if broken else None

    return script


def test_a_chunk_whose_worker_dies_by_its_own_fault_when_alone_fails_its_job_alone(
    store: Store,
) -> None:
    script = breaking(3, MAX_FAILURES)  # the other job has no such chunk
    bad, good = table(4, "bad"), table(2, "good")
    run(store, lambda: start(script, fault="SIGSEGV"), bad, good)
    assert ended(store, bad).state == "failed"
    assert ended(store, bad).reason == "chunk 3 failed 3 times, last: its worker died by SIGSEGV"
    assert ended(store, good).state == "done"
    assert store.resume(bad.id)
    run(store, lambda: start(sound))
    assert ended(store, bad).state == "done"


def test_kills_from_outside_cost_nothing_but_time(store: Store) -> None:
    new, script = table(3), breaking(1, MAX_KILLS - 1)
    run(store, lambda: start(script), new)
    assert ended(store, new).state == "done"
    assert attempts(store) == 0


def test_a_chunk_whose_workers_are_killed_without_end_fails_its_job_alone(store: Store) -> None:
    bad, good, script = table(4, "bad"), table(2, "good"), breaking(3, 10**9)
    run(store, lambda: start(script), bad, good)
    assert ended(store, bad).state == "failed"
    assert f"chunk 3 was killed {MAX_KILLS} times in a row" in ended(store, bad).reason
    assert ended(store, good).state == "done"


@pytest.mark.parametrize(
    "error",
    [
        BrokenExecutor("idle"),
        EOFError("no answer"),
        ConnectionRefusedError(),
        BlockingIOError(11, "no more processes"),
        RuntimeError("cannot schedule new futures after shutdown"),
    ],
)
@pytest.mark.parametrize("where", ["start", "submit"])
def test_workers_that_cannot_be_started_are_started_anew(
    store: Store, where: str, error: Exception
) -> None:
    left = iter(range(5))

    def refuses(numbers: list[int]) -> None:
        del numbers
        raise error

    def start_twice() -> Started:
        if next(left, None) is None:
            return start(sound)
        if where == "start":
            raise error
        return start(refuses)

    new = table(4)
    told = run(store, start_twice, new)
    assert ended(store, new).state == "done"
    assert attempts(store) == 0
    assert any(f"are restarted: {type(error).__name__}" in one for one in told)


class Inline(Executor):
    """An executor that computes."""

    def submit(self, task: Any, /, *arguments: Any, **named: Any) -> "Future[Any]":
        future: Future[Any] = Future()
        try:
            future.set_result(task(*arguments, **named))
        except Exception as error:  # noqa: BLE001 - handed on, as executors do
            future.set_exception(error)
        return future


def inline() -> Started:
    return Started(Inline(), 1, lambda: None, lambda: "")


@pytest.mark.parametrize("specification", ["", "{}", "[" * 10_000, '{"design": {"kind": "new"}}'])
def test_a_job_that_cannot_be_read_fails_alone_with_the_reason(
    store: Store, specification: str
) -> None:
    good = table(2)
    bad = NewJob(
        id="bad",
        specification=specification,
        sha256=sha256_of(specification),
        version=good.version,
        rows=2,
        chunk_rows=1,
        estimated_bytes=0,
    )
    run(store, inline, bad, good)
    assert ended(store, bad).state == "failed"
    assert ended(store, bad).reason.startswith("its specification cannot be read: ")
    assert ended(store, good).state == "done"


def test_a_job_that_is_deleted_under_the_runner_stops_no_other(store: Store) -> None:
    gone, other = table(3, "gone"), table(3, "other")

    def deletes(numbers: list[int]) -> None:
        del numbers
        store.cancel(gone.id)
        store.delete(gone.id)

    run(store, lambda: start(deletes), gone, other)
    assert store.job(gone.id) is None
    assert ended(store, other).state == "done"


@pytest.mark.parametrize(
    ("code", "fault"),
    [
        (None, ""),
        (0, ""),
        (-signal.SIGKILL, ""),
        (-signal.SIGTERM, ""),
        (255, ""),
        (1, "exit status 1"),
        (-signal.SIGSEGV, "SIGSEGV"),
        (-signal.SIGABRT, "SIGABRT"),
    ],
)
def test_an_exit_status_tells_whether_a_process_died_by_its_own_fault(
    code: int | None, fault: str
) -> None:
    assert fault_of(code) == fault


@pytest.mark.parametrize(
    ("end", "fault"),
    [
        ((os._exit, 3), "exit status 3"),
        ((signal.raise_signal, signal.SIGSEGV), "SIGSEGV"),
        ((signal.raise_signal, signal.SIGKILL), ""),
        ((signal.raise_signal, signal.SIGTERM), ""),
    ],
)
def test_a_pool_tells_by_what_fault_its_worker_died(end: tuple[Any, ...], fault: str) -> None:
    pool = processes(2)
    try:
        with pytest.raises(BrokenExecutor):
            pool.executor.submit(*end).result(PATIENT_S)
        assert pool.fault() == fault
    finally:
        pool.end()


def breaks(pool: Started) -> Exception | None:
    """Return how a pool refuses a task, None where it does it."""
    try:
        pool.executor.submit(time.sleep, 0.01).result(PATIENT_S)
    except (BrokenExecutor, OSError, EOFError) as error:
        return error
    return None


def test_workers_whose_fork_server_died_end_with_their_pool() -> None:
    pool = processes(1)
    worker = pool.executor.submit(os.getpid).result(PATIENT_S)
    server = forkserver._forkserver._forkserver_pid  # type: ignore[attr-defined]
    os.kill(server, signal.SIGKILL)
    hung = time.monotonic() + PATIENT_S
    while breaks(pool) is None:
        assert time.monotonic() < hung
    assert pool.fault() == ""
    pool.end()
    while Path(f"/proc/{worker}").exists():
        assert time.monotonic() < hung
        time.sleep(0.01)
    again = processes(1)
    assert again.executor.submit(abs, -1).result(PATIENT_S) == 1
    again.end()
