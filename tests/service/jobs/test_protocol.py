"""What routes rely on in table jobs, kept in a store or in memory."""

import asyncio
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import sqlalchemy as sa

from schemas.tables import sha256_of
from service.jobs.adding import KeyReusedError
from service.jobs.asking import UnansweredError
from service.jobs.memory import MemoryJobs
from service.jobs.protocol import Jobs
from service.jobs.records import State
from service.jobs.schema import JOBS
from service.jobs.service import JobService
from service.settings import Settings
from service.version import version
from tests.harmed_stores import delete
from tests.job_stores import engine_of, job

Change = Callable[[str, State], None]


class Kept:
    """Jobs, and what else befalls them: computation, and a store that is gone."""

    def __init__(self, jobs: Jobs, change: Change, silence: Callable[[], None]) -> None:
        self.jobs = jobs
        self.change = change
        self.silence = silence


def in_memory(folder: Path) -> Kept:
    jobs = MemoryJobs(folder)
    return Kept(jobs, jobs.change, lambda: setattr(jobs, "silence", "why"))


def in_a_store(folder: Path) -> Kept:
    jobs = JobService(Settings(data_dir=str(folder), job_workers=0))

    def change(one: str, state: State) -> None:
        engine = engine_of(jobs.store.url)
        with engine.begin() as connection:
            connection.execute(sa.update(JOBS).where(JOBS.c.id == one).values(state=state))
        engine.dispose()

    return Kept(jobs, change, lambda: delete(folder / "jobs.sqlite"))


@pytest.fixture(params=[in_memory, in_a_store])
def kept(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Kept]:
    made: Kept = request.param(tmp_path)
    yield made
    made.jobs.close()


def test_jobs_are_added_once_a_key_and_shown_newest_first(kept: Kept) -> None:
    jobs = kept.jobs
    first, second = replace(job(), version=version()), job()

    async def story() -> None:
        assert await jobs.newest(10) == []
        assert await jobs.add(first, "key") == first.id
        assert await jobs.add(job(), "key") == first.id
        other = replace(job(), sha256=sha256_of("other"))
        with pytest.raises(KeyReusedError, match="another specification"):
            await jobs.add(other, "key")
        await asyncio.sleep(0.01)  # clocks of databases tell milliseconds
        assert await jobs.add(second, None) == second.id
        assert [one.id for one in await jobs.newest(10)] == [second.id, first.id]
        assert [one.id for one in await jobs.newest(1)] == [second.id]
        found = await jobs.find(first.id)
        assert found is not None
        assert (found.state, found.rows, found.chunks, found.done) == ("waiting", 10, 3, 0)
        assert found.version == version()
        assert await jobs.find(32 * "0") is None

    asyncio.run(story())


@pytest.mark.parametrize(
    ("state", "cancelled", "deleted", "resumed"),
    [
        ("waiting", True, False, True),
        ("running", True, False, True),
        ("done", False, True, False),
        ("failed", False, True, True),
        ("cancelled", True, True, False),
    ],
)
def test_what_each_state_allows(
    kept: Kept, state: State, *, cancelled: bool, deleted: bool, resumed: bool
) -> None:
    async def in_state() -> str:
        begun = await kept.jobs.add(replace(job(), version=version()), None)
        kept.change(begun, state)
        return begun

    async def state_of(one: str) -> str | None:
        found = await kept.jobs.find(one)
        return None if found is None else found.state

    async def story() -> None:
        one = await in_state()
        assert await kept.jobs.cancel(one) == cancelled
        assert await state_of(one) == ("cancelled" if cancelled else state)
        one = await in_state()
        assert await kept.jobs.delete(one) == deleted
        assert await state_of(one) == (None if deleted else state)
        one = await in_state()
        assert await kept.jobs.resume(one) == resumed
        assert await state_of(one) == ("running" if state == "failed" else state)

    asyncio.run(story())


def test_a_key_is_free_again_when_its_job_is_deleted(kept: Kept) -> None:
    async def story() -> None:
        first = await kept.jobs.add(job(), "key")
        kept.change(first, "done")
        assert await kept.jobs.delete(first)
        assert await kept.jobs.add(job(), "key") != first

    asyncio.run(story())


def test_events_end_with_the_job(kept: Kept) -> None:
    async def story() -> None:
        begun = await kept.jobs.add(job(), None)
        kept.change(begun, "done")
        found = await kept.jobs.find(begun)
        assert found is not None
        (event,) = [one async for one in kept.jobs.events(found)]
        assert (event.name, event.data[0]) == ("done", "{")

    asyncio.run(story())


def test_what_does_not_answer_says_so(kept: Kept) -> None:
    kept.silence()

    async def story() -> None:
        for call in (
            kept.jobs.newest(1),
            kept.jobs.find("x"),
            kept.jobs.add(job(), None),
            kept.jobs.cancel("x"),
            kept.jobs.delete("x"),
            kept.jobs.resume("x"),
        ):
            with pytest.raises(UnansweredError):
                await call

    asyncio.run(story())
