"""What becomes of a job in each state, whatever is asked of it, over both databases."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from service.jobs.adding import KeyReusedError
from service.jobs.contents import GoneError
from service.jobs.erasing import ERASED_AT_ONCE
from service.jobs.plan import wire_job
from service.jobs.records import ChunkClaim, Job
from service.jobs.store import MAX_FAILURES, Store
from tests.job_stores import (
    HOUR_S,
    change_jobs,
    count_chunks,
    done,
    erase,
    job,
    silent_for,
    state_of,
)


def to_waiting(store: Store, one: str) -> None:
    del store, one


def to_running(store: Store, one: str) -> None:
    assert store.claim("w", 1) == [ChunkClaim(one, 0)]


def to_done(store: Store, one: str) -> None:
    for claim in store.claim("w", 9):
        assert claim.job == one
        assert store.finish("w", claim, done())
    store.settle()


def to_failed(store: Store, one: str) -> None:
    to_running(store, one)
    store.give_back("w", [ChunkClaim(one, 0)])
    store.fail_job(one, "it broke")


def to_cancelled(store: Store, one: str) -> None:
    assert store.cancel(one)


def to_gone(store: Store, one: str) -> None:
    to_cancelled(store, one)
    assert store.delete(one)


WAYS: dict[str, Callable[[Store, str], None]] = {
    "waiting": to_waiting,
    "running": to_running,
    "done": to_done,
    "failed": to_failed,
    "cancelled": to_cancelled,
    "gone": to_gone,
}

AFTER = {
    # state:     cancel,             delete,            resume,             claims
    "waiting": (("cancelled", True), ("waiting", False), ("waiting", True), 3),
    "running": (("cancelled", True), ("running", False), ("running", True), 2),
    "done": (("done", False), ("gone", True), ("done", False), 0),
    "failed": (("failed", False), ("gone", True), ("running", True), 0),
    "cancelled": (("cancelled", True), ("gone", True), ("cancelled", False), 0),
    "gone": (("gone", False), ("gone", False), ("gone", False), 0),
}


@pytest.mark.parametrize("state", list(WAYS))
def test_each_state_answers_each_wish(store: Store, state: str) -> None:
    *wishes, claims = AFTER[state]
    for ask, wanted in zip((store.cancel, store.delete, store.resume), wishes, strict=True):
        new = job()
        store.add(new)
        WAYS[state](store, new.id)
        assert state_of(store, new.id) == state
        assert (ask(new.id), state_of(store, new.id)) == (wanted[1], wanted[0])
        store.cancel(new.id)
        store.fail_job(new.id, "out of the way")
        store.delete(new.id)
    new = job()
    store.add(new)
    WAYS[state](store, new.id)
    store.settle()
    assert state_of(store, new.id) == state
    assert len(store.claim("other", 9)) == claims


@pytest.mark.parametrize("state", ["failed", "cancelled", "gone"])
def test_chunks_in_flight_of_a_job_that_ended_harm_nothing(store: Store, state: str) -> None:
    new = job()
    store.add(new)
    (claim,) = store.claim("slow", 1)
    if state == "failed":
        store.fail_job(new.id, "it broke")
    else:
        WAYS[state](store, new.id)
    store.beat("slow", [claim])
    store.fail("slow", claim, "late")
    store.finish("slow", claim, done())
    store.give_back("slow", [claim])
    store.settle()
    assert state_of(store, new.id) == state


def test_a_failed_job_that_is_resumed_is_tried_as_often_as_before(store: Store) -> None:
    new = job(rows=1)
    store.add(new)
    for _ in range(2):
        for _ in range(MAX_FAILURES):
            assert state_of(store, new.id) in {"waiting", "running"}
            (claim,) = store.claim("w", 1)
            store.fail("w", claim, "it broke")
        assert state_of(store, new.id) == "failed"
        assert store.resume(new.id)


def test_a_job_costs_the_same_whatever_its_size(store: Store, url: str) -> None:
    huge = job(rows=10**10, chunk_rows=10**4)
    store.add(huge)
    assert count_chunks(url, huge.id) == 0
    assert len(store.claim("w", 3)) == 3
    assert count_chunks(url, huge.id) == 3
    found = store.job(huge.id)
    assert found is not None
    assert (found.rows, found.chunks, found.done) == (10**10, 10**6, 0)


def newer(store: Store) -> Store:
    return Store(store.url, stalled_s=HOUR_S, version="2")


def test_a_job_of_another_version_with_rows_is_failed_and_resumed_by_its_own_alone(
    store: Store,
) -> None:
    new = job()
    store.add(new)
    (claim,) = store.claim("w", 1)
    store.finish("w", claim, done())
    other = newer(store)
    assert other.claim("w", 9) == []
    found = store.job(new.id)
    assert found is not None
    assert (found.state, found.done) == ("failed", 4)
    assert found.reason == (
        "begun by version 1, this is 2: begin it anew, or resume it with the version that began it"
    )
    assert not other.resume(new.id)
    assert state_of(store, new.id) == "failed"
    assert store.resume(new.id)
    assert [claim.number for claim in store.claim("w", 9)] == [1, 2]
    other.close()


@pytest.mark.parametrize("state", ["waiting", "given back", "silent", "failed"])
def test_a_job_of_another_version_without_rows_is_taken_over(
    store: Store, url: str, state: str
) -> None:
    new, other = job(), newer(store)
    store.add(new)
    if state == "failed":
        to_failed(store, new.id)
        assert other.resume(new.id)
    elif state != "waiting":
        held = store.claim("w", 1)
        if state == "given back":
            store.give_back("w", held)
        silent_for(url, 2 * HOUR_S)
    assert [claim.number for claim in other.claim("other", 9)] == [0, 1, 2]
    found = store.job(new.id)
    assert found is not None
    assert (found.state, found.version) == ("running", "2")
    other.close()


def test_a_job_that_its_own_version_still_computes_is_left_to_it(store: Store) -> None:
    new, other = job(), newer(store)
    store.add(new)
    held = store.claim("w", 1)
    assert other.claim("other", 9) == []
    assert state_of(store, new.id) == "running"
    assert store.finish("w", held[0], done())
    other.close()


def test_a_state_that_this_version_does_not_know_stops_no_other_job(store: Store, url: str) -> None:
    strange, good = job(), job()
    store.add(strange)
    change_jobs(url, state="paused")
    store.add(good)
    assert {claim.job for claim in store.claim("w", 9)} == {good.id}
    found: dict[str, Job] = {one.id: one for one in store.jobs(9)}
    assert found[strange.id].state == "failed"
    assert found[strange.id].reason == (
        "its state 'paused' is none that this version of shapersmith knows"
    )
    assert not store.cancel(strange.id)
    assert not store.resume(strange.id)
    store.drop_ended(-1.0)
    assert store.job(strange.id) is not None  # whoever knows it may go on with it
    assert store.delete(strange.id)
    assert state_of(store, strange.id) == "gone"


def test_a_deleted_job_goes_with_its_chunks_however_many(store: Store, url: str) -> None:
    new = job(rows=3 * ERASED_AT_ONCE + 1, chunk_rows=1)
    store.add(new)
    store.claim("w", new.chunks)
    store.fail_job(new.id, "enough")
    assert store.delete(new.id)
    assert store.jobs(9) == []
    assert count_chunks(url, new.id) == new.chunks  # whoever deletes need not wait for that
    assert store.jobs_to_erase() == [new.id]
    erase(store)
    assert count_chunks(url, new.id) == 0
    with pytest.raises(GoneError, match="has gone"):
        store.contents_of(new.id)


def test_what_a_killed_process_left_of_a_deleted_job_is_unseen_and_erased(
    store: Store, url: str
) -> None:
    new = job()
    store.add(new)
    store.claim("w", 9)
    change_jobs(url, state="deleted")
    assert store.job(new.id) is None
    assert store.jobs(9) == []
    assert store.claim("w", 9) == []
    assert not store.delete(new.id)
    assert store.jobs_to_erase() == [new.id]
    erase(store)
    assert count_chunks(url, new.id) == 0
    assert store.jobs_to_erase() == []


def test_rows_that_are_deleted_while_they_are_read_are_not_taken_for_all(store: Store) -> None:
    new = job(rows=30, chunk_rows=1)
    store.add(new)
    for claim in store.claim("w", 30):
        store.finish("w", claim, done())
    store.settle()
    blobs = store.blobs(new.id)
    next(blobs)
    assert store.delete(new.id)
    with pytest.raises(GoneError, match="rows of job"):
        list(blobs)


def test_a_key_begins_one_job_of_one_specification(store: Store) -> None:
    first, again, other = job(), job(), replace(job(), sha256="1" * 64)
    assert store.add(first, "key") == first.id
    assert store.add(again, "key") == first.id
    assert store.add(other, "another key") == other.id
    with pytest.raises(KeyReusedError, match="another specification"):
        store.add(replace(other, id=job().id), "key")
    assert {one.id for one in store.jobs(9)} == {first.id, other.id}
    assert {store.add(job()) for _ in range(3)}.isdisjoint({first.id, other.id})
    assert store.cancel(first.id)
    assert store.delete(first.id)
    assert store.add(again, "key") == again.id


def test_what_is_told_of_a_job_needs_no_specification(store: Store) -> None:
    new = replace(job(rows=10**10, chunk_rows=10**4), specification="none", estimated_bytes=57)
    store.add(new)
    (found,) = store.jobs(9)
    size = wire_job(found).size
    assert (size.rows, size.chunks, size.estimated_bytes) == (10**10, 10**6, 57)
