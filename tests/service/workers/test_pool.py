"""The pool with processes of its own: turns, limits, deaths, and work that nobody waits for."""

import asyncio
import contextlib
import gc
import os
import signal
from collections import Counter
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from multiprocessing import forkserver
from pathlib import Path
from typing import Any

import pytest

from service.problems import INTERNAL, OVERLOADED, TIME_LIMIT, TOO_LARGE
from service.workers.costs import SLICE_S
from service.workers.pool import MAX_DEATHS, WorkerPool
from service.workers.runs import SplitError, TaskError
from tests import pool_tasks as tasks
from tests.patience import PATIENT_S
from tests.processes import end, running
from tests.processes import until as until_in_time

MEGABYTE = 1024**2


@asynccontextmanager
async def pool(
    *,
    workers: int = 1,
    time_limit_s: float = PATIENT_S,
    max_pending: int = 1000,
    memory_bytes: int = 1024 * MEGABYTE,
) -> AsyncIterator[WorkerPool]:
    made = WorkerPool(
        workers=workers,
        time_limit_s=time_limit_s,
        max_pending=max_pending,
        memory_bytes=memory_bytes,
    )
    made.start()
    try:
        await until(lambda: made.ready)
        yield made
    finally:
        await made.close()


async def until(holds: Callable[[], object]) -> None:
    async with asyncio.timeout(PATIENT_S):
        while not holds():
            await asyncio.sleep(0.01)


def play(story: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(story, 10 * PATIENT_S))


def kind_of(error: "pytest.ExceptionInfo[TaskError]") -> object:
    return error.value.problem.kind


def test_callers_that_ask_again_and_again_get_as_many_answers_each() -> None:
    async def story() -> None:
        async with pool() as one:
            answers: Counter[int] = Counter()

            async def caller(number: int) -> None:
                while sum(answers.values()) < 400:
                    await one.run(tasks.echo, number)
                    answers[number] += 1

            await asyncio.gather(*map(caller, range(4)))
            assert max(answers.values()) - min(answers.values()) <= 1

    play(story())


def test_equal_keys_on_their_way_are_run_once_and_later_ones_anew(tmp_path: Path) -> None:
    async def story() -> None:
        note = str(tmp_path / "note")
        async with pool(workers=2) as one:
            work = [one.run(tasks.note, note, "a", key=("note", "a")) for _ in range(20)]
            await asyncio.gather(*work, one.run(tasks.note, note, "b", key=("note", "b")))
            assert Counter(Path(note).read_text().split()) == {"a": 1, "b": 1}
            await one.run(tasks.note, note, "a", key=("note", "a"))
            assert Counter(Path(note).read_text().split()) == {"a": 2, "b": 1}

    play(story())


def test_work_ends_with_the_last_who_waits_for_it() -> None:
    async def story() -> None:
        async with pool(workers=1) as one:
            callers = [asyncio.create_task(one.run(tasks.asleep, 3600, key="k")) for _ in range(3)]
            waiting = asyncio.create_task(one.run(tasks.echo, 1))
            await asyncio.sleep(0)
            assert one.pending == 2
            for caller in callers[:2]:
                caller.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await callers[0]
            assert one.pending == 2
            callers[2].cancel()
            assert await waiting == 1
            assert one.pending == 0

    play(story())


def test_work_that_waits_and_is_wanted_no_more_is_never_begun(tmp_path: Path) -> None:
    async def story() -> None:
        note = tmp_path / "note"
        async with pool(workers=1) as one:
            busy = asyncio.create_task(one.run(tasks.asleep, SLICE_S / 2))
            gone = asyncio.create_task(one.run(tasks.note, str(note), "gone"))
            kept = asyncio.create_task(one.run(tasks.note, str(note), "kept"))
            await asyncio.sleep(0)
            gone.cancel()
            await asyncio.gather(busy, kept)
        assert note.read_text() == "kept\n"

    play(story())


def test_large_work_makes_way_for_small_work_and_is_done_all_the_same(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # On a busy machine large work, which yields to all other, may take minutes: it is waited for.
    monkeypatch.setattr("service.workers.pool.MAX_WAIT_S", PATIENT_S)
    enough = tmp_path / "enough"

    async def story() -> None:
        async with pool(workers=1) as one:
            large = [
                asyncio.create_task(one.run(tasks.busy_until, str(enough), shape=number))
                for number in range(3)
            ]
            await asyncio.sleep(0)
            # None of the large work ends before the small is answered.
            assert await one.run(tasks.echo, "small", client="other") == "small"
            enough.touch()
            await asyncio.gather(*large)

    play(story())


def test_what_is_known_as_large_leaves_the_way_free_at_once() -> None:
    async def story() -> None:
        async with pool(workers=1) as one:
            one.costs.at_least("", "large", 10 * SLICE_S)
            large = asyncio.create_task(one.run(tasks.asleep, 3600, shape="large"))
            await asyncio.sleep(0)
            for number in range(50):
                assert await one.run(tasks.echo, number) == number
            assert not large.done()
            large.cancel()

    play(story())


def test_large_work_that_would_wait_for_minutes_is_refused_with_the_time_told() -> None:
    async def story() -> None:
        async with pool(workers=1) as one:
            one.costs.at_least("", "large", 20.0)
            waiting = [
                asyncio.create_task(one.run(tasks.asleep, 3600, shape="large")) for _ in range(2)
            ]
            await asyncio.sleep(0)
            for _ in range(2):
                waiting.append(asyncio.create_task(one.run(tasks.asleep, 3600, shape="large")))
                await asyncio.sleep(0)
            with pytest.raises(TaskError) as refused:
                await one.run(tasks.asleep, 3600, shape="large")
            assert kind_of(refused) == OVERLOADED
            assert refused.value.problem.retry_after_s >= 30
            assert await one.run(tasks.echo, "small") == "small"
            for task in waiting:
                task.cancel()

    play(story())


def test_a_part_of_a_batch_that_is_large_is_given_back_to_be_split() -> None:
    async def story() -> None:
        async with pool(workers=1) as one:
            with pytest.raises(SplitError):
                await one.run(tasks.asleep, 3600, kind="batch", splits=True)
            assert await one.run(tasks.echo, 1) == 1

    play(story())


def test_a_task_ends_at_its_time_limit_or_at_one_of_its_own() -> None:
    async def story() -> None:
        async with pool(workers=1, time_limit_s=0.1) as one:
            with pytest.raises(TaskError, match=r"after 0\.1 s") as late:
                await one.run(tasks.asleep, 3600)
            assert kind_of(late) == TIME_LIMIT
            assert await one.run(tasks.asleep, 0.2, limit_s=PATIENT_S)

    play(story())


def test_a_task_that_asks_for_too_much_memory_is_told_so_and_spoils_no_other() -> None:
    async def story() -> None:
        async with pool(workers=1, memory_bytes=512 * MEGABYTE) as one:
            assert await one.run(tasks.hungry, MEGABYTE) == MEGABYTE
            with pytest.raises(TaskError, match="more than the 537 MB") as refused:
                await one.run(tasks.hungry, 600 * MEGABYTE)
            assert kind_of(refused) == TOO_LARGE
            assert await one.run(tasks.echo, 1) == 1

    play(story())


def test_a_task_that_fails_is_told_so() -> None:
    async def story() -> None:
        async with pool(workers=1) as one:
            with pytest.raises(TaskError) as failed:
                await one.run(tasks.fail)
            assert kind_of(failed) == INTERNAL
            assert await one.run(tasks.echo, 1) == 1

    play(story())


def test_a_task_that_crashes_its_worker_is_given_up_at_the_second() -> None:
    async def story() -> None:
        async with pool(workers=1) as one:
            with pytest.raises(TaskError, match="every worker died") as given_up:
                await one.run(tasks.crash)
            assert kind_of(given_up) == INTERNAL
            assert await one.run(tasks.echo, 1) == 1

    play(story())


def test_a_task_whose_workers_are_killed_from_outside_is_answered(tmp_path: Path) -> None:
    async def story() -> None:
        async with pool(workers=1) as one:
            note = str(tmp_path / "few")
            assert await one.run(tasks.kill_until, note, MAX_DEATHS - 1) == "answered"
            note = str(tmp_path / "many")
            with pytest.raises(TaskError, match="every worker died"):
                await one.run(tasks.kill_until, note, MAX_DEATHS)
            assert await one.run(tasks.echo, 1) == 1

    play(story())


@pytest.mark.parametrize(("victim", "times"), [("worker", 2), ("fork server", 2), ("both", 1)])
def test_a_pool_is_full_again_whatever_was_killed_idle(victim: str, times: int) -> None:
    async def story() -> None:
        async with pool(workers=2) as one:
            for _ in range(times):
                seen = {await one.run(tasks.asleep, 0.0) for _ in range(8)}
                if victim != "worker":
                    os.kill(server(), signal.SIGKILL)
                    await until(lambda: not running({server()}))
                if victim != "fork server":
                    for pid in seen:
                        end(pid)
                now: set[int] = set()
                async with asyncio.timeout(PATIENT_S):
                    while len(now) < 2:
                        both = (one.run(tasks.asleep, 0.1) for _ in range(2))
                        now = set(await asyncio.gather(*both))
                if victim != "fork server":
                    assert not seen & now

    play(story())


def server() -> int:
    pid: int = forkserver._forkserver._forkserver_pid  # type: ignore[attr-defined]
    return pid


def test_a_client_with_several_large_tasks_gives_a_place_to_one_who_has_none() -> None:
    async def story() -> None:
        async with pool(workers=3) as one:
            greedy = [
                asyncio.create_task(one.run(tasks.asleep, 3600, client="a", shape=number))
                for number in range(2)
            ]
            for client, number in (("a", 0), ("a", 1), ("b", 0)):
                one.costs.at_least(client, number, 10 * SLICE_S)
            await until(lambda: one.pending == 2)
            assert await one.run(tasks.busy, 0.01, client="b", shape=0)
            assert not any(task.done() for task in greedy)
            for task in greedy:
                task.cancel()

    play(story())


def test_who_waits_when_a_pool_closes_is_told_so() -> None:
    async def story() -> None:
        async with pool(workers=1) as one:
            callers = [asyncio.create_task(one.run(tasks.asleep, 3600)) for _ in range(3)]
            await until(lambda: one.pending == 3)
        for caller in callers:
            with pytest.raises(TaskError, match="is stopping"):
                await caller
        with pytest.raises(TaskError, match="is stopping"):
            await one.run(tasks.echo, 1)

    play(story())


def test_an_outcome_that_cannot_be_sent_is_a_failure_and_costs_no_worker() -> None:
    async def story() -> None:
        async with pool(workers=1) as one:
            with pytest.raises(TaskError) as failed:
                await one.run(tasks.unsendable)
            assert kind_of(failed) == INTERNAL
            assert "worker" not in str(failed.value)
            assert await one.run(tasks.echo, 1) == 1

    play(story())


def test_a_pool_that_closes_leaves_no_process() -> None:
    seen: set[int] = set()

    async def story() -> None:
        async with pool(workers=3) as one:
            while len(seen) < 3:  # a worker that is born late may find the others awake again
                seen.update(await asyncio.gather(*(one.run(tasks.asleep, 0.2) for _ in range(3))))

    play(story())
    until_in_time(lambda: not running(seen), "workers outlive their pool")


def test_a_pool_closed_while_workers_start_keeps_none_of_their_sockets() -> None:
    """A forgotten socket is a warning at its collection, and a warning fails the test."""

    async def story() -> None:
        for moment in range(40):
            made = WorkerPool(
                workers=2, time_limit_s=PATIENT_S, max_pending=10, memory_bytes=1024 * MEGABYTE
            )
            made.start()
            await asyncio.sleep(moment / 4000)
            await made.close()

    play(story())
    gc.collect()
