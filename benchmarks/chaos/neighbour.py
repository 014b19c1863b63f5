"""One client asks for all that it can; its neighbour's small designs are answered all the same."""

import asyncio
from collections.abc import Iterator

import uvloop

from benchmarks.chaos.requests import heavy_body
from benchmarks.chaos.trial import Trial, at_least, at_most, designs, folder, serve
from benchmarks.loops import latencies, open_loop, with_status
from benchmarks.measure import Figure
from benchmarks.wire import Client, message
from tests.conftest import Running
from tests.processes import of_service

BATCH_LINES = 1000
SINGLES = 256
BATCH = [message("POST", "/v1/designs/batch", b"\n".join(map(heavy_body, range(BATCH_LINES))))]
AT_ONCE = [message("POST", "/v1/designs", heavy_body(number)) for number in range(SINGLES)]

GREEDY = {
    f"a batch of {BATCH_LINES} heavy lines": BATCH,
    f"{SINGLES} heavy requests at once": AT_ONCE,
}
SOURCES = ("127.0.0.1", "127.0.0.2")
"""The neighbour's address: that of the greedy client, and another."""

RATE_HZ = 10.0
SECONDS = 30.0

GONE_S = 1.0
"""After its client has left, nothing works for it from [s]."""

WATCHED_S = 0.5


def figures(trial: Trial) -> Iterator[Figure]:
    """Measure."""
    for what, messages in GREEDY.items():
        for source in SOURCES:
            with folder() as place, serve(place) as service:
                yield from uvloop.run(
                    _beside(service, what, messages, source, trial.span_s(SECONDS))
                )


async def _beside(
    service: Running, what: str, messages: list[bytes], source: str, seconds: float
) -> list[Figure]:
    greedy, neighbour = Client(service.port), Client(service.port, source)
    asked = [asyncio.create_task(greedy.ask(one)) for one in messages]
    await asyncio.sleep(1)  # they are at work
    told = await open_loop(designs(neighbour), rate_hz=RATE_HZ, seconds=seconds)
    neighbour.close()

    greedy.close()
    await asyncio.gather(*asked, return_exceptions=True)
    await asyncio.sleep(GONE_S)
    before = _used_below(service)
    await asyncio.sleep(WATCHED_S)
    used_s = sum(used - before.get(pid, 0.0) for pid, used in _used_below(service).items())

    answered = with_status(told, 200)
    beside = f"beside {what}, from {source}"
    return [
        at_least(
            f"designs answered {beside}",
            100 * len(answered) / len(told),
            95,
            "%",
            f"of {len(told)}",
        ),
        at_most(
            f"p99 since planned {beside}",
            latencies(answered).percentile(99),
            1000,
            "ms",
            str(latencies(answered)),
        ),
        at_most(
            f"processor time of workers in {WATCHED_S:g} s, {GONE_S:g} s after {what} were left",
            used_s,
            0.02,
            "s",
        ),
    ]


def _used_below(service: Running) -> dict[int, float]:
    """Return the processor time of each process of the service but the one that serves [s]."""
    found = of_service(service)
    return {pid: one.used_s for pid, one in found.items() if pid != service.process.pid}
