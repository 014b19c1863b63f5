"""Jobs that are killed again and again give the bytes of one that is not disturbed.

`KILLS_OF_JOBS` sets how often; 50 is the acceptance run.
"""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE, Running, free_port, wait_until_ready
from tests.patience import PATIENT_S
from tests.postgres import Cluster, running_cluster
from tests.service.cli.table_runs import begun

KILLS = int(os.environ.get("KILLS_OF_JOBS", "8"))

JOB: dict[str, Any] = {
    "design": {
        **CRANE,
        "actuator": {
            "kind": "rate_limited",
            "accel_limit_m_s2": 30,
            "decel_limit_m_s2": 5e4,
            "speed_m_s": 0.2,
            "then": CRANE["actuator"],
        },
    },
    "axes": [{"field": "/plant/cable_length_m", "from": 0.4, "to": 1.4, "points": 600}],
    "chunk_rows": 3,
}
"""Two hundred chunks of three rows, by IPOPT: compiled ones would be done before one is killed."""


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, bytes, float]:
    """Return specification, file and seconds of a job that nobody kills."""
    folder = tmp_path_factory.mktemp("undisturbed")
    spec, path = folder / "spec.json", folder / "t.csv"
    spec.write_text(json.dumps(JOB))
    subprocess.run(command(spec, path), check=True, capture_output=True)
    path.unlink()  # that was with all to compile
    started = time.monotonic()
    subprocess.run(command(spec, path), check=True, capture_output=True)
    return spec, path.read_bytes(), time.monotonic() - started


def command(spec: Path, path: Path) -> list[str]:
    return [sys.executable, "-m", "service", "table", str(spec), "-o", str(path)]


def test_a_command_killed_at_random_moments(
    undisturbed: tuple[Path, bytes, float], tmp_path: Path
) -> None:
    spec, wanted, seconds = undisturbed
    path = tmp_path / "t.csv"
    with begun(spec, path):
        pass  # which kills it once a chunk is done
    resumed = subprocess.run(command(spec, path), capture_output=True, text=True, check=True)
    assert "going on at" in resumed.stderr
    assert path.read_bytes() == wanted
    path.unlink()
    moments = random.Random(20111)
    kills = 0
    while kills < KILLS:
        process = subprocess.Popen(
            command(spec, path), stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        try:
            process.wait(moments.uniform(0.05, 1.1) * seconds)
        except subprocess.TimeoutExpired:
            assert not path.exists() or path.read_bytes() == wanted
            os.killpg(process.pid, signal.SIGKILL)
            kills += 1
        _, told = process.communicate(timeout=PATIENT_S)
        assert process.returncode in {0, -signal.SIGKILL}, told
        if path.exists():
            assert path.read_bytes() == wanted
            path.unlink()
    last = subprocess.run(command(spec, path), capture_output=True, text=True, check=False)
    assert last.returncode == 0, last.stderr
    assert path.read_bytes() == wanted
    assert [left.name for left in tmp_path.iterdir()] == ["t.csv"]


@contextmanager
def killable_service(folder: Path, url: str) -> Iterator[Running]:
    """Start a service in a process group of its own; kill it at the end."""
    folder.mkdir(exist_ok=True)
    port, log = free_port(), folder / "log"
    settings = {
        "DATA_DIR": folder / "data",
        "DATABASE_URL": url,
        "WORKERS": 1,
        "JOB_WORKERS": 1,
        "STALLED_S": 1,
    }
    environment = {f"SHAPERSMITH_{name}": str(value) for name, value in settings.items()}
    with log.open("ab") as stderr:
        process = subprocess.Popen(
            [sys.executable, "-m", "service", "serve", "--port", str(port)],
            stderr=stderr,
            env={**os.environ, **environment},
            start_new_session=True,
        )
    try:
        service = Running(process, port, log)
        wait_until_ready(service)
        yield service
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait(PATIENT_S)


def state_of(service: Running, location: str) -> dict[str, Any]:
    """Return a job's state; ask again while the database is gone."""
    deadline = time.monotonic() + PATIENT_S
    with service.client() as client:
        while True:
            answer = client.get(location)
            if answer.status_code == 200:
                found: dict[str, Any] = answer.json()
                return found
            assert answer.status_code == 503, answer.text
            assert time.monotonic() < deadline
            time.sleep(0.1)


def test_two_services_on_postgresql_are_killed_in_turn_and_the_database_restarted(
    undisturbed: tuple[Path, bytes, float], tmp_path: Path
) -> None:
    _, wanted, _ = undisturbed
    with running_cluster() as cluster:
        kill_in_turn(cluster, tmp_path, wanted)


def kill_in_turn(cluster: Cluster, folder: Path, wanted: bytes) -> None:
    moments = random.Random(20112)
    kills = restarts = jobs = 0
    with ExitStack() as first_stack, ExitStack() as second_stack:
        stacks = [first_stack, second_stack]

        def start(number: int) -> Running:
            service = killable_service(folder / str(number), cluster.url)
            return stacks[number].enter_context(service)

        services = [start(0), start(1)]

        def begin() -> str:
            with services[0].client() as client:
                return str(client.post("/v1/tables", json=JOB).headers["location"])

        def finish(location: str) -> None:
            deadline = time.monotonic() + 3 * PATIENT_S
            while (job := state_of(services[0], location))["state"] in {"waiting", "running"}:
                assert time.monotonic() < deadline, job
                time.sleep(0.05)
            assert (job["state"], job["rows_done"], job["verified"]) == ("done", 600, 600), job
            for service in services:
                result = httpx.get(f"{service.address}{location}/result", timeout=PATIENT_S)
                assert result.content == wanted

        location = begin()
        while kills < KILLS:
            time.sleep(moments.uniform(0.0, 1.5))
            if kills % 3 == 1 and restarts <= kills // 3:
                cluster.stop()
                time.sleep(moments.uniform(0.0, 1.0))
                cluster.start()
                restarts += 1
            victim = kills % 2
            stacks[victim].close()  # kills it and all its workers
            kills += 1
            services[victim] = start(victim)
            if state_of(services[victim], location)["state"] == "done":
                finish(location)
                jobs += 1
                location = begin()
        finish(location)
    assert restarts > 0
