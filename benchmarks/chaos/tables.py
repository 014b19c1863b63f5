"""Small tables beside endless ones, and beside those that another version left behind."""

import sqlite3
import time
from collections.abc import Iterator
from pathlib import Path

import uvloop

from benchmarks.chaos.requests import table_body
from benchmarks.chaos.table_client import TableClient
from benchmarks.chaos.trial import HungError, Trial, at_most, folder, none_of, serve
from benchmarks.measure import Figure
from benchmarks.wire import Answer, Client
from tests.conftest import Running

ENDLESS = (100_000, 100_000)
SMALL_WITHIN_S = 5.0
HUNG_S = 60.0


def figures(trial: Trial) -> Iterator[Figure]:
    """Measure."""
    del trial
    with folder() as place, serve(place) as service:
        yield from uvloop.run(_beside_an_endless_one(service))
    with folder() as place:
        with serve(place, job_workers=0) as service:
            job = uvloop.run(_begin(service))
        _rewrite(service.data / "jobs.sqlite", job)
        with serve(place) as service:
            yield from uvloop.run(_beside_an_unknown_one(service, job))


async def _beside_an_endless_one(service: Running) -> list[Figure]:
    client = Client(service.port)
    tables = TableClient(client)
    # What is compiled at the first use is there.
    await tables.wait_for_end(await tables.begin(table_body(2)))
    endless = await tables.begin(table_body(*ENDLESS))
    seconds, state = await _small(tables)
    cancelled = await tables.cancel(endless)
    client.close()
    return [
        at_most(
            "a table of one row beside one of 10^10, from its POST",
            seconds,
            SMALL_WITHIN_S,
            "s",
            state,
        ),
        _all_200("beside a table of 10^10 rows", {"DELETE": cancelled}),
    ]


async def _begin(service: Running) -> str:
    client = Client(service.port)
    job = await TableClient(client).begin(table_body(100))
    client.close()
    return job


def _rewrite(path: Path, job: str) -> None:
    """Make a job one of a version that is not this one, with a specification of its own."""
    store = sqlite3.connect(path)
    with store:
        store.execute("UPDATE jobs SET version = '99.0.0' WHERE id = ?", (job,))
        store.execute(
            "UPDATE specifications SET specification = ? WHERE job = ?",
            ('{"made_by": "another version"}', job),
        )
    store.close()


async def _beside_an_unknown_one(service: Running, unknown: str) -> list[Figure]:
    client = Client(service.port)
    tables = TableClient(client)
    listed = await tables.list_newest()
    state = await tables.state(unknown)
    seconds, ended = await _small(tables)
    cancelled = await tables.cancel(unknown)
    listed_then = await tables.list_newest()
    client.close()
    answers = {"list": listed, "state": state, "DELETE": cancelled, "list then": listed_then}
    return [
        _all_200("beside a table of another version", answers),
        at_most("a table of one row beside it, from its POST", seconds, SMALL_WITHIN_S, "s", ended),
    ]


async def _small(tables: TableClient) -> tuple[float, str]:
    """Return how long a table of one row takes from its POST [s], and how it ended."""
    start = time.perf_counter()
    try:
        ended = await tables.wait_for_end(await tables.begin(table_body(1)), hung_s=HUNG_S)
    except HungError as error:
        return float("inf"), str(error)
    return time.perf_counter() - start, ended


def _all_200(what: str, answers: dict[str, Answer]) -> Figure:
    failed = [answer for answer in answers.values() if answer.status != 200]
    told = ", ".join(f"{name} {answer.status}" for name, answer in answers.items())
    return none_of(f"{what}, answers not 200", failed, told)
