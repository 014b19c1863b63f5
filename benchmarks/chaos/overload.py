"""Three times as many requests as the service can answer: it serves on, and refuses the rest."""

import asyncio
from collections.abc import Iterator

import uvloop

from benchmarks.chaos.trial import (
    Trial,
    at_least,
    at_most,
    folder,
    none_of,
    request_bodies,
    serve,
)
from benchmarks.crowd import Crowd
from benchmarks.loops import latencies, with_status
from benchmarks.measure import Figure
from benchmarks.wire import message

CLIENTS = 32
CAPACITY_S = 10.0
NORMAL_S = 10.0
FLOOD_S = 60.0
FLOOD = 3.0
"""Requests of the flood over what can be answered."""

RECOVERED_S = 2.0
"""After the flood, answers come as before within [s]."""


def figures(trial: Trial) -> Iterator[Figure]:
    """Measure."""
    with folder() as place, serve(place) as service:
        yield from uvloop.run(_flood(service.port, trial))


async def _flood(port: int, trial: Trial) -> list[Figure]:
    requests = (message("POST", "/v1/designs", body) for body in request_bodies())
    crowd, neighbours = Crowd(port, requests), Crowd(port, requests)

    # What it can do, with always as many waiting as there are clients.
    capacity_hz = await _capacity_hz(crowd, trial)

    # How fast it is at half of that.
    quiet = await crowd.open_loop(rate_hz=capacity_hz / 2, seconds=trial.span_s(NORMAL_S))
    normal = latencies(with_status(quiet, 200))
    normal_ms = normal.percentile(99)

    # Three times that, and at once half of it again, while the last of the flood are answered.
    seconds = trial.span_s(FLOOD_S)
    flood = asyncio.create_task(crowd.open_loop(rate_hz=FLOOD * capacity_hz, seconds=seconds))
    await asyncio.sleep(seconds)
    after = await neighbours.open_loop(
        rate_hz=capacity_hz / 2, seconds=RECOVERED_S + trial.span_s(NORMAL_S)
    )
    flooded = await flood
    # A machine whose speed drifts had the mean of both meanwhile.
    after_hz = await _capacity_hz(crowd, trial)
    mean_hz = (capacity_hz + after_hz) / 2
    crowd.close()
    neighbours.close()

    start_s = min(one.planned_s for one in flooded)
    served_all = with_status(flooded, 200)
    refused = with_status(flooded, 503)
    in_time = [one for one in served_all if one.done_s <= start_s + seconds]
    others = len(flooded) - len(served_all) - len(refused)
    recovered_s = min(one.planned_s for one in after) + RECOVERED_S
    recovered = latencies([one for one in after if one.planned_s >= recovered_s])
    return [
        Figure(
            what=f"capacity, {CLIENTS} clients, all designs different",
            value=f"{capacity_hz:.0f}/s, {after_hz:.0f}/s after the flood; at half of it {normal}",
            limit="",
            met=None,
        ),
        at_most(
            f"served at {FLOOD:g} times capacity for {seconds:g} s, p99 since planned / normal",
            latencies(served_all).percentile(99) / normal_ms,
            3.0,
            told=f"planned {latencies(served_all)}; sent {latencies(served_all, planned=False)}",
        ),
        at_most(
            "refused meanwhile with 503, p99 since planned",
            latencies(refused).percentile(99),
            100.0,
            "ms",
            told=f"{len(refused)}; sent {latencies(refused, planned=False)}",
        ),
        none_of("refused without Retry-After", [x for x in refused if not x.told_to_retry]),
        none_of("neither served nor refused", range(others)),
        at_least(
            "served a second meanwhile / capacity, the mean of before and after",
            len(in_time) / seconds / mean_hz,
            0.8,
            told=f"{len(in_time) / seconds:.0f}/s",
        ),
        none_of(
            "not served at half of capacity, from 2 s after",
            [one for one in after if one.planned_s >= recovered_s and one.status != 200],
        ),
        at_most(
            f"p99 at half of capacity, from {RECOVERED_S:g} s after / normal",
            recovered.percentile(99) / normal_ms,
            1.5,
            told=str(recovered),
        ),
    ]


async def _capacity_hz(crowd: Crowd, trial: Trial) -> float:
    seconds = trial.span_s(CAPACITY_S)
    told = await crowd.closed_loop(clients=CLIENTS, seconds=seconds)
    return len(with_status(told, 200)) / seconds
