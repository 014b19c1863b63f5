"""How long the command line takes from a cold start."""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from statistics import median

from benchmarks.http import request_body
from benchmarks.measure import Figure


def figures() -> Iterator[Figure]:
    """Measure."""
    cases = [
        ("shapersmith design, cold", ["design", "-"], 1.5),
        ("shapersmith --help", ["--help"], 0.4),
    ]
    body = json.dumps(json.loads(request_body(0))).encode()
    for what, arguments, limit in cases:
        command = [sys.executable, "-m", "service", *arguments]
        times = []
        for _ in range(7):
            started = time.perf_counter()
            subprocess.run(command, input=body, capture_output=True, check=True)
            times.append(time.perf_counter() - started)
        yield Figure(
            what=what,
            value=f"{median(times):.2f} s",
            limit=f"<= {limit} s",
            met=median(times) <= limit,
        )
