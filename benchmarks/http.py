"""Designs a second over HTTP, and the echo of the same body by the same server stack."""

import asyncio
import json
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from benchmarks.measure import Figure

CLIENTS = 32
REQUESTS = 4000
PORT_WAIT_S = 30.0


def request_body(number: int) -> bytes:
    """Return one request; every number gives another plant."""
    return json.dumps({
        "plant": {"kind": "pendulum", "cable_length_m": 0.3 + 1.1 * number / REQUESTS},
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


async def load(port: int, bodies: list[bytes]) -> tuple[float, int]:
    """Send all bodies over keep-alive connections; return seconds and answers not 200."""
    waiting = iter(bodies)
    failures = 0

    async def client() -> None:
        nonlocal failures
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        for body in waiting:
            writer.write(
                b"POST /v1/designs HTTP/1.1\r\nhost: bench\r\ncontent-type: application/json\r\n"
                b"content-length: " + str(len(body)).encode() + b"\r\n\r\n" + body
            )
            head = await reader.readuntil(b"\r\n\r\n")
            length = int(head.lower().split(b"content-length:")[1].split(b"\r\n")[0])
            answer = await reader.readexactly(length)
            if b" 200 " not in head[:15] or not answer:
                failures += 1
        writer.close()

    started = time.perf_counter()
    await asyncio.gather(*(client() for _ in range(CLIENTS)))
    return time.perf_counter() - started, failures


def rate(port: int) -> tuple[float, int]:
    """Return requests a second, and failures, after a warm-up."""
    asyncio.run(load(port, [request_body(0)] * 4 * CLIENTS))
    seconds, failures = asyncio.run(load(port, [request_body(n) for n in range(REQUESTS)]))
    return REQUESTS / seconds, failures


def figures() -> Iterator[Figure]:
    """Measure."""
    with running(sys.executable, "-m", "service.cli", "serve") as port:
        designs, failures = rate(port)
    with running(
        sys.executable, "-m", "uvicorn", "benchmarks.http:echo", "--no-access-log"
    ) as port:
        echoes, _ = rate(port)
    yield Figure(
        what=f"designs over HTTP, {CLIENTS} clients, all different, {failures} errors",
        value=f"{designs:.0f}/s (echo of the same bodies: {echoes:.0f}/s)",
        limit=">= 500/s",
        met=designs >= 500 and failures == 0,
    )
