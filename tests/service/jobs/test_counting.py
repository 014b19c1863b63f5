"""What a job's record counts is what its chunks come to, whoever changed them meanwhile."""

import random
import threading
from collections.abc import Callable
from typing import Any

import pytest
import sqlalchemy as sa

from service.jobs import counting
from service.jobs.counting import rate_rows_s
from service.jobs.records import ChunkClaim, Done
from service.jobs.schema import CHUNKS, JOBS
from service.jobs.store import Store
from tests.job_stores import HOUR_S, change_jobs, done, engine_of, job

SUMS = {
    "rows_done": CHUNKS.c.rows,
    "verified": CHUNKS.c.verified,
    "verified_ideal": CHUNKS.c.verified_ideal,
    "infeasible": CHUNKS.c.infeasible,
}


def require_sums(url: str, one: str) -> int:
    """Require the counts of a job to be the sums over its chunks, and return its rows."""
    engine = engine_of(url)
    with engine.connect() as connection:
        sums = [sa.func.coalesce(sa.func.sum(column), 0) for column in SUMS.values()]
        of_chunks = sa.select(*sums).where(CHUNKS.c.job == one, CHUNKS.c.state == "done")
        wanted = [int(value) for value in connection.execute(of_chunks).one()]
        counts = sa.select(*(JOBS.c[name] for name in SUMS)).where(JOBS.c.id == one)
        assert list(connection.execute(counts).one()) == wanted
    engine.dispose()
    return wanted[0]


def rows_of(claim: ChunkClaim) -> Done:
    """Return a chunk of four rows or more, of which so many are such as its number says."""
    kinds = claim.number % 2, claim.number % 3
    return done(b"%d" % claim.number, infeasible=kinds[0], verified_ideal=min(kinds[1], 1))


@pytest.mark.parametrize("seed", range(2))
def test_many_that_finish_fail_and_give_back_at_once_count_each_chunk_once(
    store: Store, url: str, seed: int
) -> None:
    jobs = [job(rows=40 * 4, chunk_rows=4) for _ in range(2)]
    for new in jobs:
        store.add(new)

    def work(name: str) -> None:
        dice = random.Random(f"{seed} {name}")
        mine = Store(url, stalled_s=HOUR_S, version="1")
        while claims := mine.claim(name, 3):
            for claim in claims:
                if dice.random() < 0.3:
                    mine.give_back(name, [claim])
                    continue
                held = mine.finish(name, claim, rows_of(claim))
                assert not mine.finish(name, claim, rows_of(claim))
                assert held
            mine.settle()
        mine.close()

    threads = [threading.Thread(target=work, args=(str(number),)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    # What was given back when all the others had ended already.
    work("last")
    for new in jobs:
        assert require_sums(url, new.id) == new.rows
        found = store.job(new.id)
        assert found is not None
        assert (found.state, found.done) == ("done", new.rows)


def fail(store: Store, one: str) -> None:
    store.fail_job(one, "enough")


def fail_and_resume(store: Store, one: str) -> None:
    store.fail_job(one, "enough")
    assert store.resume(one)


WISHES: dict[str, Callable[[Store, str], Any]] = {
    "cancel": Store.cancel,
    "fail": fail,
    "fail and resume": fail_and_resume,
    "release": Store.release,
}


@pytest.mark.parametrize("wish", WISHES)
def test_counts_hold_when_a_job_ends_or_is_taken_back_under_those_who_finish(
    store: Store, url: str, wish: str
) -> None:
    new = job(rows=60, chunk_rows=1)
    store.add(new)
    claims = store.claim("w", new.chunks)
    recorded: list[bool] = []
    begun = threading.Event()

    def work(part: list[ChunkClaim]) -> None:
        mine = Store(url, stalled_s=HOUR_S, version="1")
        for claim in part:
            recorded.append(mine.finish("w", claim, done()))
            begun.set()
        mine.close()

    threads = [threading.Thread(target=work, args=(claims[part::2],)) for part in range(2)]
    for thread in threads:
        thread.start()
    begun.wait()
    WISHES[wish](store, new.id)
    for thread in threads:
        thread.join()
    for left in store.jobs_to_erase():
        store.erase(left)
    counted = require_sums(url, new.id)
    assert counted == (0 if wish == "cancel" else sum(recorded))


def test_a_look_at_jobs_reads_no_chunk(store: Store, url: str) -> None:
    new = job(rows=30, chunk_rows=1)
    store.add(new)
    for claim in store.claim("w", 30):
        store.finish("w", claim, done())
    told: list[str] = []
    sa.event.listen(
        store._reading, "before_cursor_execute", lambda *given: told.append(str(given[2]))
    )
    assert store.job(new.id) is not None
    assert store.jobs(100)
    assert len(told) == 2
    assert not [one for one in told if "chunks " in one.replace("jobs.chunks", "")]
    del url


def test_the_rate_is_that_of_the_chunks_done_lately(
    store: Store, url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # So long that what this test takes is nothing beside it, however slow the machine is.
    monkeypatch.setattr(counting, "SPAN_S", HOUR_S)
    new = job(rows=100, chunk_rows=1)
    store.add(new)

    def finished(chunks: int) -> float:
        for claim in store.claim("w", chunks):
            store.finish("w", claim, done())
        found = store.job(new.id)
        assert found is not None
        return found.rate_rows_s

    def later(seconds: float) -> None:
        """Make all times of the job older, as if time had passed."""
        times = ("earlier_from", "lately_from", "last_finished")
        change_jobs(url, **{name: JOBS.c[name] - seconds for name in times})

    assert finished(1) == 0.0  # nobody knows how long it took
    later(2 * HOUR_S)
    assert finished(1) == pytest.approx(1 / (2 * HOUR_S), rel=0.3)
    later(HOUR_S / 2)
    assert finished(10) == pytest.approx(11 / (2.5 * HOUR_S), rel=0.3)
    later(100 * HOUR_S)
    found = store.job(new.id)
    assert found is not None
    assert 0 < found.rate_rows_s < 11 / (100 * HOUR_S)
    assert found.left_s is not None
    store.fail_job(new.id, "enough")
    assert store.resume(new.id)
    assert finished(1) == 0.0


@pytest.mark.parametrize("since", [None, 100.0, 200.0])
def test_there_is_no_rate_where_no_time_has_passed(since: float | None) -> None:
    record = {"earlier_from": since, "earlier_rows": 3, "lately_rows": 4}
    assert rate_rows_s(record, 100.0) == 0.0
