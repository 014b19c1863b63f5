"""What any job store does, over both databases."""

import sqlite3
import threading
import time
from pathlib import Path

import pytest
import sqlalchemy as sa
from alembic import command
from alembic.config import Config

import service.jobs
from service.jobs.database import StoreError
from service.jobs.records import ChunkClaim
from service.jobs.store import MAX_FAILURES, Store
from tests.job_stores import HOUR_S, change_jobs, done, job, silent_for

MIGRATIONS = Path(service.jobs.__file__).parent / "migrations"


def test_chunks_are_claimed_once_and_in_order(store: Store) -> None:
    new = job()
    store.add(new)
    assert store.claim("one", 2) == [ChunkClaim(new.id, 0), ChunkClaim(new.id, 1)]
    assert store.claim("two", 2) == [ChunkClaim(new.id, 2)]
    assert store.claim("one", 2) == []


def test_a_job_is_done_when_its_chunks_are_and_its_rows_come_in_order(store: Store) -> None:
    new = job()
    store.add(new)
    for claim in reversed(store.claim("one", 9)):
        rows = done(b"%d" % claim.number, infeasible=1, verified_ideal=claim.number % 2)
        assert store.finish("one", claim, rows)
    store.settle()
    found = store.job(new.id)
    assert found is not None
    assert (found.state, found.done, found.verified, found.infeasible) == ("done", 10, 3, 3)
    assert (found.verified_ideal, found.failed) == (1, 3)
    assert list(store.blobs(new.id)) == [b"0", b"1", b"2"]


def test_many_chunks_are_read_in_order(store: Store) -> None:
    new = job(rows=30, chunk_rows=1)
    store.add(new)
    for claim in store.claim("one", 30):
        store.finish("one", claim, done(b"%d" % claim.number))
    assert list(store.blobs(new.id)) == [b"%d" % number for number in range(30)]


def test_a_silent_worker_loses_its_chunk_and_cannot_record_it_any_more(
    store: Store, url: str
) -> None:
    new = job(rows=1)
    store.add(new)
    (claim,) = store.claim("silent", 1)
    assert store.claim("other", 1) == []
    silent_for(url, 2 * HOUR_S)
    assert store.claim("other", 1) == [claim]
    assert not store.finish("silent", claim, done(b"late"))
    assert store.finish("other", claim, done(b"right"))
    assert not store.finish("silent", claim, done(b"late"))
    assert list(store.blobs(new.id)) == [b"right"]


def test_a_heartbeat_keeps_a_chunk(store: Store, url: str) -> None:
    store.add(job(rows=1))
    held = store.claim("slow", 1)
    for _ in range(3):
        silent_for(url, 2 * HOUR_S)
        store.beat("slow", held)
        assert store.claim("other", 1) == []
    silent_for(url, 2 * HOUR_S)
    assert store.claim("other", 1) == held


def test_a_chunk_that_fails_again_and_again_fails_its_job_with_the_reason(store: Store) -> None:
    new = job(rows=1)
    store.add(new)
    for _ in range(MAX_FAILURES):
        (claim,) = store.claim("one", 1)
        store.fail("one", claim, "it broke")
    found = store.job(new.id)
    assert found is not None
    assert (found.state, found.reason) == ("failed", "chunk 0 failed 3 times, last: it broke")
    assert store.claim("one", 1) == []
    assert store.resume(new.id)
    assert len(store.claim("one", 1)) == 1


def test_a_cancelled_job_takes_no_more_rows_and_is_cancelled_twice_like_once(store: Store) -> None:
    new = job()
    store.add(new)
    (claim,) = store.claim("one", 1)
    assert store.cancel(new.id)
    assert store.cancel(new.id)
    assert not store.finish("one", claim, done())
    store.settle()
    found = store.job(new.id)
    assert found is not None
    assert found.state == "cancelled"
    assert store.claim("one", 1) == []


def test_a_job_that_is_done_is_not_cancelled(store: Store) -> None:
    new = job(rows=1)
    store.add(new)
    (claim,) = store.claim("one", 1)
    store.finish("one", claim, done())
    store.settle()
    assert not store.cancel(new.id)
    assert list(store.blobs(new.id)) == [b"rows"]


def test_only_ended_jobs_that_are_old_are_dropped(store: Store) -> None:
    store.drop_ended(-1.0)  # what other tests left
    ended, unfinished = job(), job()
    store.add(ended)
    store.add(unfinished)
    assert store.cancel(ended.id)
    assert store.claim("a", 1) == [ChunkClaim(unfinished.id, 0)]
    assert store.drop_ended(HOUR_S) == 0
    time.sleep(0.01)
    assert store.drop_ended(0.0) == 1
    assert store.job(ended.id) is None
    assert store.finish("a", ChunkClaim(unfinished.id, 0), done())


def test_rows_of_a_dropped_job_are_gone(store: Store) -> None:
    store.drop_ended(-1.0)
    old = job(rows=4)
    store.add(old)
    [claim] = store.claim("a", 1)
    assert store.finish("a", claim, done())
    store.settle()
    assert store.drop_ended(-1.0) == 1
    with pytest.raises(StoreError, match=f"job {old.id} has gone"):
        list(store.blobs(old.id))


def test_many_claim_at_once_and_none_gets_what_another_has(store: Store, url: str) -> None:
    store.add(job(rows=120, chunk_rows=1))
    claimed: list[ChunkClaim] = []

    def claim(name: str) -> None:
        mine = Store(url, stalled_s=HOUR_S, version="1")
        while got := mine.claim(name, 3):
            claimed.extend(got)
        mine.close()

    threads = [threading.Thread(target=claim, args=(str(number),)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    numbers = [one.number for one in claimed]
    assert sorted(numbers) == list(range(120))


def older(url: str) -> None:
    """Bring a store back to the schema of the first version."""
    engine = sa.create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.downgrade(config, "0001")
    engine.dispose()


def test_a_store_of_an_older_schema_is_migrated_with_its_jobs(url: str) -> None:
    first = Store(url, stalled_s=HOUR_S, version="1")
    change_jobs(url, state="cancelled")  # what other tests left
    new = job()
    first.add(new)
    (claim,) = first.claim("w", 1)
    assert first.finish("w", claim, done())
    first.close()
    older(url)
    again = Store(url, stalled_s=HOUR_S, version="1")
    found = again.job(new.id)
    assert found is not None
    assert (found.rows, found.chunks, found.done) == (10, 3, 4)
    assert again.contents_of(new.id) == new
    assert [claim.number for claim in again.claim("w", 9)] == [1, 2]
    engine = sa.create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
    indices = [index["name"] for index in sa.inspect(engine).get_indexes("chunks")]
    engine.dispose()
    again.close()
    assert indices == ["chunks_by_state"]


def test_a_store_of_a_newer_schema_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "jobs.sqlite"
    Store(f"sqlite:///{file}", stalled_s=HOUR_S).close()
    with sqlite3.connect(file) as connection:
        connection.execute("UPDATE alembic_version SET version_num = '9999'")
    connection.close()
    with pytest.raises(StoreError, match="schema 9999, made by a newer version"):
        Store(f"sqlite:///{file}", stalled_s=HOUR_S)


@pytest.mark.parametrize("url", ["mysql://host/x", "nothing", "sqlite:////proc/no/jobs.sqlite"])
def test_a_url_that_is_no_store_is_refused(url: str) -> None:
    with pytest.raises(StoreError, match="job store"):
        Store(url, stalled_s=HOUR_S)


def test_the_migrations_lead_to_the_tables_that_the_store_uses(url: str) -> None:
    from alembic.autogenerate import compare_metadata
    from alembic.migration import MigrationContext

    from service.jobs.schema import METADATA

    Store(url, stalled_s=HOUR_S).close()
    engine = sa.create_engine(url.replace("postgresql://", "postgresql+psycopg://"))
    with engine.connect() as connection:
        found = compare_metadata(MigrationContext.configure(connection), METADATA)
    engine.dispose()
    assert [change[0] for change in found] == ["remove_index"]  # which the store does not name
