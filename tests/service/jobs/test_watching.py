"""Streams of events: one look for all, until the job has ended, is gone, or nobody watches."""

import asyncio
import json
from collections.abc import AsyncIterator, Callable
from dataclasses import replace
from typing import Any

import pytest

from service.jobs import watching
from service.jobs.asking import UnansweredError
from service.jobs.records import Event, Job
from service.jobs.watching import Watching
from tests.patience import PATIENT_S

JOB = Job(
    id=32 * "0",
    state="running",
    reason="",
    created=0.0,
    sha256=64 * "0",
    version="1",
    rows=100,
    chunks=10,
    estimated_bytes=0,
    done=0,
    verified=0,
    verified_ideal=0,
    infeasible=0,
    rate_rows_s=0.0,
)

STREAMS = 200


class Looks:
    """What each look finds, in turn; counted."""

    def __init__(self, *found: Job | Exception | None) -> None:
        self._found = list(found)
        self.count = 0

    async def __call__(self, job: str) -> Job | None:
        assert job == JOB.id
        self.count += 1
        found = self._found.pop(0) if len(self._found) > 1 else self._found[0]
        if isinstance(found, Exception):
            raise found
        return found


@pytest.fixture(autouse=True)
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(watching, "LOOK_EVERY_S", 0.001)


def name_and_done(event: Event) -> tuple[str, int]:
    state: dict[str, Any] = json.loads(event.data)
    return event.name, state["rows_done"]


async def seen(stream: AsyncIterator[Event]) -> list[tuple[str, int]]:
    return [name_and_done(event) async for event in stream]


def watched(
    looks: Looks, *, streams: int = 1, stopping: Callable[[], bool] = lambda: False
) -> list[list[tuple[str, int]]]:
    async def all_seen() -> list[list[tuple[str, int]]]:
        watch = Watching(looks, stopping)
        return list(await asyncio.gather(*(seen(watch.events(JOB)) for _ in range(streams))))

    return asyncio.run(asyncio.wait_for(all_seen(), PATIENT_S))


@pytest.mark.parametrize("state", ["done", "failed", "cancelled"])
def test_streams_share_their_looks_and_end_with_the_job(state: Any) -> None:
    looks = Looks(replace(JOB, done=50), replace(JOB, done=50), replace(JOB, done=100, state=state))
    for one in watched(looks, streams=STREAMS):
        assert one[-1] == (state, 100)
        assert one == sorted(set(one), key=lambda event: event[1])
    assert looks.count == 3


def test_a_job_that_has_ended_is_told_without_a_look() -> None:
    looks = Looks(None)

    async def told() -> list[tuple[str, int]]:
        return await seen(Watching(looks, lambda: False).events(replace(JOB, state="done", done=1)))

    assert asyncio.run(told()) == [("done", 1)]
    assert looks.count == 0


def test_a_deleted_job_ends_with_what_was_known_last() -> None:
    (events,) = watched(Looks(replace(JOB, done=50), None))
    assert events[-1] == ("gone", 50)


def test_a_store_that_does_not_answer_ends_no_stream() -> None:
    silence = [UnansweredError("not now")] * 5
    (events,) = watched(Looks(*silence, replace(JOB, state="done", done=100)))
    assert events == [("progress", 0), ("done", 100)]


def test_a_look_that_fails_leaves_no_stream_waiting() -> None:
    assert watched(Looks(ValueError("a fault of ours")), streams=2) == 2 * [[("progress", 0)]]


def test_streams_end_when_the_service_stops() -> None:
    looks = Looks(JOB)
    assert watched(looks, stopping=lambda: looks.count > 2) == [[("progress", 0)]]


def test_nobody_looks_any_more_when_all_streams_have_left() -> None:
    async def left() -> None:
        looks = Looks(JOB)
        watch = Watching(looks, lambda: False)
        before = asyncio.all_tasks()
        streams = [asyncio.create_task(seen(watch.events(JOB))) for _ in range(3)]
        while looks.count < 2:
            await asyncio.sleep(0.001)
        for stream in streams:
            stream.cancel()
        await asyncio.wait(streams)
        while asyncio.all_tasks() != before:
            await asyncio.sleep(0.001)
        count = looks.count
        async for event in watch.events(replace(JOB, state="done")):  # one who comes later
            assert name_and_done(event) == ("done", 0)
        assert looks.count == count

    asyncio.run(asyncio.wait_for(left(), PATIENT_S))
