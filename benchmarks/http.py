"""Designs a second over HTTP, and the echo of the same body by the same server stack."""

import itertools
import json
import math
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import uvloop

from benchmarks.loops import Outcome, closed_loop, latencies, with_status
from benchmarks.measure import Figure
from benchmarks.wire import Client, message

CLIENTS = 32
WARM_S = 2.0
SECONDS = 8.0
GOLDEN = (math.sqrt(5) - 1) / 2
"""Its multiples, without their whole parts, fill 0 to 1 evenly, and none comes twice."""

PORT_WAIT_S = 30.0


def request_body(number: int) -> bytes:
    """Return one request; every number gives another plant."""
    return json.dumps({
        "plant": {"kind": "pendulum", "cable_length_m": 0.3 + 1.1 * (number * GOLDEN % 1)},
        "actuator": {
            "kind": "second_order",
            "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
            "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
        },
        "shaper": {"kind": "numzvd"},
    }).encode()


async def echo(scope: dict, receive, send) -> None:  # type: ignore[no-untyped-def, type-arg] # noqa: ANN001
    """Answer a request with its own body: what the stack costs without any work."""
    if scope["type"] != "http":
        return
    body, more = b"", True
    while more:
        message = await receive()
        body += message.get("body", b"")
        more = message.get("more_body", False)
    headers = [(b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": 200, "headers": headers})
    await send({"type": "http.response.body", "body": body})


@contextmanager
def running(*command: str) -> Iterator[int]:
    """Run a server on a free port until it is done with."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    server = subprocess.Popen([*command, "--port", str(port)], stderr=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + PORT_WAIT_S
        while True:
            try:
                socket.create_connection(("127.0.0.1", port), timeout=1).close()
                break
            except OSError:
                if time.monotonic() > deadline:
                    raise
                time.sleep(0.05)
        yield port
    finally:
        server.terminate()
        server.wait(30)


async def load(port: int, seconds: float) -> list[Outcome]:
    """Send designs, all different, over keep-alive connections; return what became of them."""
    client = Client(port)
    bodies = map(request_body, itertools.count())
    told = await closed_loop(
        lambda: client.ask(message("POST", "/v1/designs", next(bodies))),
        callers=CLIENTS,
        seconds=seconds,
    )
    client.close()
    return [one for of_a_client in told for one in of_a_client]


def measure(port: int) -> list[Outcome]:
    """Return what became of the requests of some seconds, after a warm-up."""
    uvloop.run(load(port, WARM_S))
    return uvloop.run(load(port, SECONDS))


def figures() -> Iterator[Figure]:
    """Measure."""
    with running(sys.executable, "-m", "service", "serve") as port:
        told = measure(port)
    with running(
        sys.executable, "-m", "uvicorn", "benchmarks.http:echo", "--no-access-log"
    ) as port:
        echoes = len(measure(port)) / SECONDS
    answered = with_status(told, 200)
    failures = len(told) - len(answered)
    designs = len(answered) / SECONDS
    yield Figure(
        what=f"designs over HTTP, {CLIENTS} clients, all different, {failures} errors",
        value=f"{designs:.0f}/s (echo of the same bodies: {echoes:.0f}/s)",
        limit=">= 500/s",
        met=designs >= 500 and failures == 0,
    )
    yield Figure(what="time of each", value=str(latencies(answered)), limit="", met=None)
