"""Design, plot, table, service, and a table that goes on, where there is nothing of Unix."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import CRANE, running_service
from tests.patience import PATIENT_S
from tests.processes import children, running, until
from tests.service.cli.commands import COMMAND
from tests.service.cli.table_runs import SMALL, begun
from tests.service.http.test_tables_over_http import TABLE, ended
from tests.without_unix import environment, python

HIDDEN = """
import importlib, multiprocessing, os, signal, socket
for name in ("fcntl", "resource", "uvloop", "multiprocessing.forkserver"):
    try:
        importlib.import_module(name)
    except ImportError:
        continue
    raise SystemExit(name)
assert "forkserver" not in multiprocessing.get_all_start_methods()
for module, name in ((os, "fork"), (os, "setpriority"), (signal, "SIGKILL"), (socket, "AF_UNIX")):
    assert not hasattr(module, name), name
"""

POOL = """
import asyncio
from service.workers.pool import WorkerPool
from service.workers.runs import TaskError
from tests import pool_tasks as tasks

async def told(pool, *task, limit_s=None):
    try:
        return await pool.run(*task, limit_s=limit_s)
    except TaskError as error:
        return error.problem.kind.name

async def main():
    pool = WorkerPool(workers=1, time_limit_s=600.0, max_pending=9, memory_bytes=2**30)
    pool.start()
    try:
        large = "x" * 10_000_000
        print(await told(pool, tasks.echo, large) == large)
        print(await told(pool, tasks.asleep, 600.0, limit_s=0.1))
        print(await told(pool, tasks.crash))
        print(await told(pool, tasks.fail))
        print(await told(pool, tasks.echo, "answered"))
    finally:
        await pool.close()

if __name__ == "__main__":
    asyncio.run(main())
"""

LONG: dict[str, Any] = {
    **SMALL,
    "design": CRANE,
    "axes": [{**SMALL["axes"][0], "points": 1200}],
}


@pytest.fixture(scope="module")
def hidden(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Return the environment of processes from which it is hidden."""
    return environment(tmp_path_factory.mktemp("hiding") / "site")


def run(
    hidden: dict[str, str], folder: Path, *command: object
) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [*map(str, command)], env=hidden, cwd=folder, capture_output=True, check=False
    )


@pytest.fixture
def crane(tmp_path: Path) -> Path:
    path = tmp_path / "crane.json"
    path.write_text(json.dumps(CRANE))
    return path


def test_it_is_hidden_from_every_process(hidden: dict[str, str], tmp_path: Path) -> None:
    done = run(hidden, tmp_path, *python(HIDDEN))
    assert (done.returncode, done.stderr) == (0, b"")


def test_the_same_is_designed_and_drawn(
    hidden: dict[str, str], tmp_path: Path, crane: Path
) -> None:
    done = run(hidden, tmp_path, *COMMAND, "design", crane, "--plot", tmp_path / "crane.svg")
    usual = run(dict(os.environ), tmp_path, *COMMAND, "design", crane)
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout == usual.stdout
    assert (tmp_path / "crane.svg").read_bytes().startswith(b"<?xml")


def test_a_killed_table_goes_on_to_the_same_bytes(hidden: dict[str, str], tmp_path: Path) -> None:
    spec, path, usual = (tmp_path / name for name in ("spec.json", "t.csv", "usual.csv"))
    spec.write_text(json.dumps(LONG))
    with begun(spec, path, env=hidden) as process:
        process.kill()
        process.wait(PATIENT_S)
        assert not path.exists()
    done = run(hidden, tmp_path, *COMMAND, "table", spec, "-o", path)
    assert done.returncode == 0, done.stderr
    assert b"going on at" in done.stderr
    assert run(dict(os.environ), tmp_path, *COMMAND, "table", spec, "-o", usual).returncode == 0
    assert path.read_bytes() == usual.read_bytes()
    assert sorted(one.name for one in tmp_path.iterdir()) == ["spec.json", "t.csv", "usual.csv"]


def test_of_two_that_write_one_file_the_second_is_refused(
    hidden: dict[str, str], tmp_path: Path
) -> None:
    spec, path = tmp_path / "spec.json", tmp_path / "t.csv"
    endless = {**LONG, "axes": [{**SMALL["axes"][0], "points": 100_000}]}
    spec.write_text(json.dumps(endless))
    with begun(spec, path, env=hidden):
        second = run(hidden, tmp_path, *COMMAND, "table", spec, "-o", path)
    assert second.returncode == 1
    assert f"another shapersmith is writing {path}".encode() in second.stderr


def test_a_pool_heals_and_ends_what_takes_too_long(hidden: dict[str, str], tmp_path: Path) -> None:
    # A worker imports the program, from its file, before it works.
    (tmp_path / "program.py").write_text(POOL)
    done = run(hidden, tmp_path, sys.executable, "program.py")
    told = done.stdout.decode().split()
    assert told == ["True", "time-limit", "internal", "internal", "answered"], done.stderr


def test_a_service_designs_makes_tables_and_ends_well(
    hidden: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", hidden["PYTHONPATH"])
    with (
        running_service(tmp_path / "log", workers=1, job_workers=1) as service,
        service.client() as client,
    ):
        assert client.post("/v1/designs", json=CRANE).json()["certificate"]["verified"]
        location = client.post("/v1/tables", json=TABLE).headers["location"]
        assert ended(client, location)["verified"] == 8
        assert client.get(f"{location}/result", params={"format": "csv"}).status_code == 200
        started = children(service.process.pid)
        service.process.send_signal(signal.SIGINT)
        assert service.process.wait(PATIENT_S) == 0
    assert len(started) >= 3, started
    until(lambda: not running(started), f"a process goes on: {started}")
    assert b"Traceback" not in service.log.read_bytes()
