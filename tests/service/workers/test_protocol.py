"""What routes rely on in a pool, of processes or of none."""

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from service.problems import INTERNAL, OVERLOADED
from service.workers.inline import InlinePool
from service.workers.pool import WorkerPool
from service.workers.protocol import Pool
from service.workers.runs import TaskError
from tests import pool_tasks as tasks
from tests.patience import PATIENT_S

POOLS: dict[str, Callable[[], Pool]] = {
    "inline": InlinePool,
    "processes": lambda: WorkerPool(
        workers=1, time_limit_s=PATIENT_S, max_pending=10, memory_bytes=1024**3
    ),
}


@pytest.fixture(params=POOLS)
def pool(request: pytest.FixtureRequest) -> Pool:
    """Return a pool that has not started: it is made where no event loop runs."""
    return POOLS[request.param]()


def play(pool: Pool, story: Callable[[], Awaitable[None]]) -> None:
    async def played_whole() -> None:
        pool.start()
        try:
            while not pool.ready:
                await asyncio.sleep(0.01)
            await story()
        finally:
            await pool.close()

    asyncio.run(asyncio.wait_for(played_whole(), PATIENT_S))


async def refusal(work: Awaitable[object]) -> TaskError:
    with pytest.raises(TaskError) as refused:
        await work
    return refused.value


def test_a_pool_answers_and_takes_none_once_it_is_closed(pool: Pool) -> None:
    async def story() -> None:
        value = {"a": [1, 2.5]}
        answer = await pool.run(tasks.echo, value, client="c", kind="batch", splits=True)
        assert answer == value
        assert answer is not value
        assert pool.refusal("c") is None
        await pool.close()
        stopping = await refusal(pool.run(tasks.echo, value))
        assert stopping.problem.kind == OVERLOADED
        assert "is stopping" in stopping.problem.detail

    play(pool, story)


@pytest.mark.parametrize("task", [tasks.fail, tasks.unsendable])
def test_a_task_that_fails_is_a_fault_of_the_service_and_no_other_task_knows(
    pool: Pool, task: Callable[[], object]
) -> None:
    async def story() -> None:
        failed = await refusal(pool.run(task))
        assert failed.problem.kind == INTERNAL
        assert "its log has the reason" in failed.problem.detail
        assert await pool.run(tasks.echo, 1) == 1

    play(pool, story)
