"""Four callers at one worker: each gets as much as the others."""

import time
from collections.abc import Iterator

import uvloop

from benchmarks.chaos.trial import HUNG_S, Trial, designs, folder, request_bodies, serve, until
from benchmarks.loops import closed_loop, with_status
from benchmarks.measure import Figure
from benchmarks.wire import Answer, Client
from service.dispatch import answer
from service.workers.pool import WorkerPool

CALLERS = 4
SECONDS = 10.0
MAX_SURPLUS = 0.1
"""How much more than the one with least a caller may get."""


def figures(trial: Trial) -> Iterator[Figure]:
    """Measure."""
    seconds = trial.span_s(SECONDS)
    with folder() as place, serve(place, workers=1) as service:
        yield _fairness("over HTTP", uvloop.run(_over_http(service.port, seconds)))
    yield _fairness("straight at its pool", uvloop.run(_at_the_pool(seconds)))


async def _over_http(port: int, seconds: float) -> list[int]:
    """Return how many answers each caller got."""
    client = Client(port)
    told = await closed_loop(designs(client), callers=CALLERS, seconds=seconds)
    client.close()
    return [len(with_status(mine, 200)) for mine in told]


async def _at_the_pool(seconds: float) -> list[int]:
    pool = WorkerPool(workers=1, time_limit_s=HUNG_S, max_pending=256, memory_bytes=2 * 1024**3)
    pool.start()
    bodies = request_bodies()

    async def ask() -> Answer:
        sent_s = time.perf_counter()
        await pool.run(answer, "design", next(bodies))
        return Answer(status=200, sent_s=sent_s)

    await until(lambda: pool.ready, "no worker is ready")
    told = await closed_loop(ask, callers=CALLERS, seconds=seconds)
    await pool.close()
    return [len(with_status(mine, 200)) for mine in told]


def _fairness(how: str, answers: list[int]) -> Figure:
    more = max(answers) / min(answers) - 1 if min(answers) else float("inf")
    return Figure(
        what=f"{CALLERS} callers at one worker {how}: how much more the first gets than the last",
        value=f"{100 * more:.0f} % ({', '.join(map(str, answers))} answers)",
        limit=f"<= {100 * MAX_SURPLUS:.0f} %",
        met=more <= MAX_SURPLUS,
    )
