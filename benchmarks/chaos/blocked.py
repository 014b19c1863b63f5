"""What is heavy or stuck about tables holds up nobody who asks for something else."""

import asyncio
import contextlib
import itertools
import sqlite3
import time
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import uvloop

from benchmarks.chaos.requests import endless_fit, table_body
from benchmarks.chaos.table_client import RefusedError, TableClient
from benchmarks.chaos.trial import Trial, at_most, folder, none_of, serve
from benchmarks.loops import Ask, Outcome, closed_loop, latencies, open_loop, outcome, with_status
from benchmarks.measure import Figure
from benchmarks.wire import Client, message
from tests.conftest import Running

LIVE_HZ = 50.0
LIVE_MS = 50.0
READ_HZ = 2.0
READ_MS = 1000.0

TABLES = 11
LONG_AXIS = 10_000_000
LOOKED_S = 10.0

RESULTS = 12
FETCHED_S = 30.0

LOCKED_S = 40.0


def figures(trial: Trial) -> Iterator[Figure]:
    """Measure."""
    for story in (_quiet, _long_axes, _heavy_results, _lock_store):
        with folder() as place, serve(place, job_workers=1) as service:
            yield from uvloop.run(story(service, trial))


async def _quiet(service: Running, trial: Trial) -> list[Figure]:
    """Look while nothing happens: what is due to the machine."""
    live = await _live(service, trial.span_s(LOOKED_S))
    return [
        Figure(what="live while nothing happens", value=str(latencies(live)), limit="", met=None)
    ]


async def _long_axes(service: Running, trial: Trial) -> list[Figure]:
    """List tables whose axes have ten million points each."""
    client = Client(service.port)
    tables = TableClient(client)
    refused = []
    for number in range(TABLES):
        try:
            await tables.begin(table_body(LONG_AXIS - number, chunk_rows=1_000_000))
        except RefusedError as error:
            refused.append(error)
    seconds = trial.span_s(LOOKED_S)
    live, (listed,) = await asyncio.gather(
        _live(service, seconds), closed_loop(tables.list_newest, callers=1, seconds=seconds)
    )
    client.close()
    return [
        none_of("tables of 10^7 points that were refused", refused, "; ".join(map(str, refused))),
        *_figures_of_answers("live while they are listed", live, LIVE_MS),
        Figure(what="the list", value=str(latencies(listed)), limit="", met=None),
    ]


async def _heavy_results(service: Running, trial: Trial) -> list[Figure]:
    """Fetch files at once whose polynomials take seconds each."""
    client = Client(service.port)
    tables = TableClient(client)
    bodies = (table_body(2, kind="num_2ei", fit=endless_fit(number)) for number in range(RESULTS))
    jobs = [await tables.begin(body) for body in bodies]
    for job in jobs:
        await tables.wait_for_end(job)
    now = time.perf_counter()
    fetched = [asyncio.create_task(outcome(tables.result(job, "c"), now)) for job in jobs]
    live = await _live(service, trial.span_s(FETCHED_S))
    told = sorted(one.status for one in await asyncio.gather(*fetched))
    client.close()
    return [
        *_figures_of_answers(f"live while {RESULTS} heavy files are fetched", live, LIVE_MS),
        Figure(what="the files' statuses", value=", ".join(map(str, told)), limit="", met=None),
    ]


async def _lock_store(service: Running, trial: Trial) -> list[Figure]:
    """Look, and read, while another process holds the job store."""
    client = Client(service.port)
    tables = TableClient(client)
    job = await tables.begin(table_body(10))
    await tables.wait_for_end(job)
    reads: Iterator[Ask] = itertools.cycle((tables.list_newest, lambda: tables.state(job)))
    seconds = trial.span_s(LOCKED_S)
    async with _lock(service.data / "jobs.sqlite"):
        live, read = await asyncio.gather(
            _live(service, seconds),
            open_loop(lambda: next(reads)(), rate_hz=READ_HZ, seconds=seconds),
        )
    client.close()
    return [
        *_figures_of_answers(f"live while the store is locked for {seconds:g} s", live, LIVE_MS),
        *_figures_of_answers("states and lists meanwhile", read, READ_MS),
    ]


@contextlib.asynccontextmanager
async def _lock(path: Path) -> AsyncIterator[None]:
    store = sqlite3.connect(path, timeout=60.0, isolation_level=None, check_same_thread=False)
    await asyncio.to_thread(store.execute, "BEGIN EXCLUSIVE")
    try:
        yield
    finally:
        store.execute("ROLLBACK")
        store.close()


async def _live(service: Running, seconds: float) -> list[Outcome]:
    client = Client(service.port)
    asked = message("GET", "/health/live")
    told = await open_loop(lambda: client.ask(asked), rate_hz=LIVE_HZ, seconds=seconds)
    client.close()
    return told


def _figures_of_answers(what: str, outcomes: list[Outcome], limit_ms: float) -> list[Figure]:
    """Return that all were answered 200, and all of them in time."""
    answered = with_status(outcomes, 200)
    failed = [one for one in outcomes if one.status != 200]
    told = latencies(answered)
    return [
        at_most(f"{what}, longest", told.percentile(100), limit_ms, "ms", str(told)),
        none_of(f"{what}, not answered 200", failed, f"of {len(outcomes)}"),
    ]
