"""Many that begin, compute, cancel and delete jobs at once."""

import threading
from collections.abc import Callable, Iterator

import pytest

from service.jobs.records import ChunkClaim
from service.jobs.store import Store
from tests.job_stores import HOUR_S, count_chunks, done, erase, job, state_of


def at_once(work: Callable[[int], None], times: int) -> None:
    threads = [threading.Thread(target=work, args=(number,)) for number in range(times)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


@pytest.fixture
def stores(store: Store) -> Iterator[list[Store]]:
    opened = [Store(store.url, stalled_s=HOUR_S, version="1") for _ in range(4)]
    yield opened
    for one in opened:
        one.close()


def test_of_many_that_begin_with_one_key_at_once_one_does(stores: list[Store]) -> None:
    got: list[str] = []
    at_once(lambda number: got.append(stores[number].add(job(), "key")), len(stores))
    (only,) = stores[0].jobs(9)
    assert got == [only.id] * len(stores)


def test_many_at_once_compute_many_jobs_and_each_chunk_once(stores: list[Store]) -> None:
    jobs = [job(rows, 1) for rows in (1, 30, 60)]
    for new in jobs:
        stores[0].add(new)
    recorded: list[ChunkClaim] = []

    def work(number: int) -> None:
        mine, name = stores[number], str(number)
        while claims := mine.claim(name, 3):
            mine.beat(name, claims)
            # One of two goes back, as long as another worker could take it.
            kept = claims[1:] or claims
            mine.give_back(name, set(claims) - set(kept))
            for claim in kept:
                if mine.finish(name, claim, done(b"%d" % claim.number)):
                    recorded.append(claim)
            mine.settle()

    at_once(work, len(stores))
    assert len(recorded) == len(set(recorded)) == 91
    for new in jobs:
        assert state_of(stores[0], new.id) == "done"
        wanted = [b"%d" % number for number in range(new.rows)]
        assert list(stores[0].blobs(new.id)) == wanted


def test_jobs_cancelled_deleted_and_resumed_under_claims_leave_nothing(
    stores: list[Store], url: str
) -> None:
    jobs = [job(200, 1) for _ in range(8)]
    for new in jobs:
        stores[0].add(new)

    def work(number: int) -> None:
        mine, name = stores[number], str(number)
        for new in jobs:
            if number % 2:
                for claim in mine.claim(name, 5):
                    mine.fail(name, claim, "it broke")
            else:
                mine.fail_job(new.id, "enough")
                mine.resume(new.id)
                mine.cancel(new.id)
                mine.delete(new.id)

    at_once(work, len(stores))
    at_once(lambda number: erase(stores[number]), len(stores))
    for new in jobs:
        assert state_of(stores[0], new.id) == "gone"
        assert count_chunks(url, new.id) == 0
