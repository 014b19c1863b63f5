"""Whole table jobs: specification to file, memory of a longer one, two Dask workers for one."""

import json
import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from benchmarks.measure import Figure

COMMAND = (sys.executable, "-m", "service", "table")

SET = {"natural_frequency_rad_s": 20, "damping_ratio": 0.8}
COMPILED: dict[str, Any] = {
    "plant": {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81},
    "actuator": {
        "kind": "second_order",
        "accel": SET,
        "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
    },
    "shaper": {"kind": "numzvd"},
}
"""The crane of Kim 2011: every row by the compiled kernel."""

ONE_BY_ONE: dict[str, Any] = {
    **COMPILED,
    "actuator": {
        "kind": "rate_limited",
        "accel_limit_m_s2": 30,
        "decel_limit_m_s2": 5e4,
        "speed_m_s": 0.2,
        "then": COMPILED["actuator"],
    },
}
"""The same behind limits, which the kernel does not serve: every row is searched and proven."""

MILLION = (1000, 1000)
TEN_MILLION = (1000, 10_000)
ROWS_ONE_BY_ONE = (1000, 20)

LOOK_EVERY_S = 0.02
"""Between two looks at the memory of a job [s]."""


def specification(design: dict[str, Any], points: tuple[int, int], chunk_rows: int) -> str:
    """Return a table over cable length and damping."""
    lengths, dampings = points
    return json.dumps({
        "design": design,
        "axes": [
            {"field": "/plant/cable_length_m", "from": 0.3, "to": 1.4, "points": lengths},
            {"field": "/plant/damping_ratio", "from": 0, "to": 0.1, "points": dampings},
        ],
        "columns": ["times_s", "residual"],
        "chunk_rows": chunk_rows,
    })


def run(spec: str, *options: str) -> tuple[float, int]:
    """Run one job; return its seconds and the largest memory of its command [kB]."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "spec.json").write_text(spec)
        arguments = [*COMMAND, str(folder / "spec.json"), "-o", str(folder / "t.parquet"), *options]
        started = time.perf_counter()
        process = subprocess.Popen(arguments, stderr=subprocess.DEVNULL)
        memory = 0
        while process.poll() is None:
            memory = max(memory, peak_memory(process.pid))
            time.sleep(LOOK_EVERY_S)
        seconds = time.perf_counter() - started
        if process.returncode != 0 or not (folder / "t.parquet").is_file():
            raise RuntimeError(f"the job ended with status {process.returncode}")
        return seconds, memory


def peak_memory(process: int) -> int:
    """Return the largest memory of a process so far, 0 where it has ended [kB].

    Not by what it is told to have used at its end: that counts the memory of the process which
    started it too.
    """
    try:
        told = Path(f"/proc/{process}/status").read_text()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in told.splitlines() if "VmHWM" in line), 0)


def on_dask(spec: str, workers: int) -> float:
    """Run one job on a scheduler and workers of its own; return its seconds."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    with tempfile.TemporaryDirectory() as folder, ExitStack() as ends:

        def begin(*arguments: str) -> None:
            process = subprocess.Popen(
                [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd=folder,
                env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])},
            )
            ends.callback(process.wait, 30)
            ends.callback(process.terminate)

        begin("dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
        for _ in range(workers):
            begin("dask_worker", address, "--nthreads", "1", "--no-dashboard")
        wait_for(address, workers)
        return run(spec, "--scheduler", address)[0]


def wait_for(address: str, workers: int) -> None:
    """Wait until the workers have come, and have imported what they need."""
    from distributed import Client

    with Client(address, timeout=60, set_as_default=False) as client:
        client.wait_for_workers(workers, timeout=60)
        client.run(import_kernel)


def import_kernel() -> None:
    """Import what a chunk needs."""
    import service.jobs.work  # noqa: F401


def figures() -> Iterator[Figure]:
    """Measure."""
    million = specification(COMPILED, MILLION, 10_000)
    run(specification(COMPILED, (10, 10), 10))  # numba's cache is there
    runs = [run(million) for _ in range(3)]
    seconds, memory = min(runs)
    yield Figure(
        what="table of 1e6 rows, specification to Parquet, 2 workers",
        value=f"{seconds:.1f} s",
        limit="<= 6 s",
        met=seconds <= 6,
    )
    longer, more = run(specification(COMPILED, TEN_MILLION, 10_000))
    yield Figure(
        what="the same with 1e7 rows: peak memory of the command / that of 1e6",
        value=f"{more / memory:.2f} ({more / 1000:.0f} / {memory / 1000:.0f} MB; {longer:.0f} s)",
        limit="<= 1.3",
        met=more <= 1.3 * memory,
    )
    one_by_one = specification(ONE_BY_ONE, ROWS_ONE_BY_ONE, 100)
    one, two = on_dask(one_by_one, 1), on_dask(one_by_one, 2)
    yield Figure(
        what="2e4 rows behind limits, each searched, on Dask: two workers / one",
        value=f"{one / two:.2f} ({one:.0f} / {two:.0f} s)",
        limit=">= 1.7",
        met=one >= 1.7 * two,
    )
