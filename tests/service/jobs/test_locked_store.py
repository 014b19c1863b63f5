"""A job store that is locked, gone or damaged: what it holds up, and what it says."""

import asyncio
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from sqlalchemy.exc import DBAPIError

from service.jobs import database
from service.jobs.asking import Asking, UnansweredError
from service.jobs.records import Done
from service.jobs.store import Store
from tests.harmed_stores import HARMS, delete, hold_locked
from tests.job_stores import HOUR_S
from tests.job_stores import job as job_of
from tests.patience import PATIENT_S
from tests.postgres import running_cluster

READS: dict[str, Callable[[Store, str], Any]] = {
    "job": lambda store, job: store.job(job),
    "jobs": lambda store, _: store.jobs(10),
    "contents_of": lambda store, job: store.contents_of(job),
    "blobs": lambda store, job: list(store.blobs(job)),
}

WRITES: dict[str, Callable[[Store, str], Any]] = {
    "add": lambda store, _: store.add(job_of(2, 1)),
    "claim": lambda store, _: store.claim("one", 1),
    "cancel": lambda store, job: store.cancel(job),
}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "jobs?%41#.sqlite"  # as a folder of a user may be named


@pytest.fixture
def store(file: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Store]:
    monkeypatch.setattr(database, "LOCK_WAIT_S", 0.1)
    opened = Store(database.url_of(file), stalled_s=HOUR_S, version="1")
    yield opened
    opened.close()


@pytest.fixture
def job(store: Store) -> str:
    new = job_of(2, 1)
    store.add(new)
    for claim in store.claim("one", 2):
        store.finish("one", claim, Done(blob=b"rows", verified=1, infeasible=0))
    store.add(job_of(2, 1))  # to be claimed
    return new.id


def refused(store: Store, job: str) -> None:
    with pytest.raises(DBAPIError):
        store.cancel(job)


@pytest.mark.parametrize("kind", ["IMMEDIATE", "EXCLUSIVE"])
def test_readers_wait_for_no_writer_be_it_another_process_or_many_threads_here(
    store: Store, job: str, file: Path, kind: str
) -> None:
    with hold_locked(file, kind):
        blocked = [threading.Thread(target=refused, args=(store, job)) for _ in range(20)]
        for thread in blocked:
            thread.start()
        for read in READS.values():
            assert read(store, job)  # a reader that waited would be refused, as the writers are
        again = Store(
            store.url, stalled_s=HOUR_S, version="1"
        )  # opened as by a process that makes a file
        for read in READS.values():
            assert read(again, job)
        again.close()
        for thread in blocked:
            thread.join()


@pytest.mark.parametrize("write", WRITES)
def test_a_writer_is_refused_while_another_process_holds_the_lock_and_served_after(
    store: Store, job: str, file: Path, write: str
) -> None:
    with hold_locked(file, "IMMEDIATE"), pytest.raises(DBAPIError) as error:
        WRITES[write](store, job)
    assert database.reason_of(error.value) == "another process has locked it"
    WRITES[write](store, job)


def test_a_reader_cannot_write(store: Store, job: str) -> None:
    with store._reading.connect() as connection, pytest.raises(DBAPIError, match="readonly"):
        connection.execute(sa.text("DELETE FROM chunks"))
    assert store.job(job) is not None


@pytest.mark.parametrize(("harm", "told"), HARMS)
@pytest.mark.parametrize("call", [*READS, *WRITES])
def test_a_store_that_is_gone_or_damaged_says_so_and_nothing_is_written_to_what_it_was(
    store: Store, job: str, file: Path, harm: Callable[[Path], None], told: str, call: str
) -> None:
    harm(file)
    with pytest.raises(DBAPIError) as error:
        {**READS, **WRITES}[call](store, job)
    assert told in database.reason_of(error.value)
    assert harm is not delete or not file.exists()


def test_a_lock_in_postgresql_holds_up_writers_for_a_while_and_no_reader(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(database, "LOCK_WAIT_S", 1)
    with running_cluster() as cluster:
        store = Store(cluster.url, stalled_s=HOUR_S, version="1")
        new = job_of(2, 1)
        store.add(new)
        other = Store(cluster.url, stalled_s=HOUR_S, version="1")
        with other._engine.begin() as connection:
            connection.execute(sa.text("LOCK TABLE jobs, chunks IN EXCLUSIVE MODE"))
            for read in ("job", "jobs", "contents_of"):
                assert READS[read](store, new.id)
            for write in WRITES.values():
                with pytest.raises(DBAPIError, match="lock timeout"):
                    write(store, new.id)
        assert store.cancel(new.id)
        other.close()
        store.close()


def test_calls_beyond_the_bound_are_refused_at_once_and_served_when_there_is_room() -> None:
    begun, let_go = threading.Event(), threading.Event()

    def hold() -> bool:
        begun.set()
        return let_go.wait(PATIENT_S)

    async def asked() -> None:
        asking = Asking("test", threads=1, most=3)
        waiting = [asyncio.create_task(asking.ask(hold)) for _ in range(3)]
        assert await asyncio.to_thread(begun.wait, PATIENT_S)  # the first
        with pytest.raises(UnansweredError, match="too many"):
            await asking.ask(hold)
        waiting[2].cancel()  # its place is free at once: it had not begun
        await asyncio.wait([waiting[2]])
        waiting[2] = asyncio.create_task(asking.ask(hold))
        await asyncio.sleep(0)
        waiting[0].cancel()  # its place is not: its thread is still at it
        await asyncio.wait([waiting[0]])
        with pytest.raises(UnansweredError, match="too many"):
            await asking.ask(hold)
        let_go.set()
        assert await asyncio.gather(*waiting[1:]) == [True, True]
        assert await asking.ask(hold)
        asking.close()

    asyncio.run(asked())


def test_a_call_that_takes_too_long_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.jobs.asking.MAX_WAIT_S", 0.05)
    let_go = threading.Event()

    async def asked() -> None:
        asking = Asking("test", threads=1, most=1)
        with pytest.raises(UnansweredError, match="within"):
            await asking.ask(let_go.wait)
        let_go.set()
        asking.close()

    asyncio.run(asked())
