"""The process that computes tables: apart from the server, kept alive, and never left behind."""

import json
import os
import signal
import sqlite3
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.jobs.service import JobService
from service.settings import Settings
from tests.conftest import CRANE, Running, changed, running_service
from tests.patience import PATIENT_S
from tests.processes import children, of_service, table_process, until
from tests.service.http.test_tables_over_http import ENDLESS, TABLE, ended


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Running]:
    with running_service(tmp_path / "log", workers=1, job_workers=1) as service:
        yield service


def begin(service: Running, table: object) -> str:
    with service.client() as client:
        location: str = client.post("/v1/tables", json=table).headers["location"]
    return location


def chunks(service: Running, state: str) -> int:
    with sqlite3.connect(service.data / "jobs.sqlite", timeout=PATIENT_S) as store:
        wanted = "SELECT count(*) FROM chunks WHERE state = ?"
        return int(store.execute(wanted, (state,)).fetchone()[0])


def at_work(service: Running) -> int:
    """Begin a table without end; return the process that computes it once a chunk is done."""
    begin(service, ENDLESS)
    until(lambda: chunks(service, "done"), "no chunk is done")
    return table_process(service)


QUICK = changed(service__jobs__keeping__RESTART_PAUSE_S=0.2)
"""A service that waits less before it starts the process anew."""


def test_it_lets_signals_to_the_service_and_is_started_anew_when_it_is_killed(
    tmp_path: Path,
) -> None:
    log = tmp_path / "log"
    with running_service(log, command=QUICK, workers=1, job_workers=1, stalled_s=1) as service:
        victim = at_work(service)
        done = chunks(service, "done")
        for number in (signal.SIGINT, signal.SIGTERM):
            os.kill(victim, number)
        until(lambda: chunks(service, "done") > done + 2, "it has stopped")
        assert table_process(service) == victim
        below = children(victim)
        done = chunks(service, "done")
        os.kill(victim, signal.SIGKILL)
        until(lambda: table_process(service) not in {0, victim}, "none takes its place")
        until(lambda: not below & of_service(service).keys(), "its workers outlive it")
        until(lambda: chunks(service, "done") > done + 2, "no other goes on with its table")
        location = begin(service, TABLE)
        with service.client() as client:
            assert client.post("/v1/designs", json=CRANE).status_code == 200
            ended(client, location)
    assert f"the process of table jobs {victim} ended with SIGKILL" in log.read_text()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_it_gives_its_chunks_back_and_ends_with_the_service(
    service: Running, number: signal.Signals
) -> None:
    at_work(service)
    service.process.send_signal(number)
    assert service.process.wait(PATIENT_S) == (0 if number == signal.SIGTERM else -number)
    until(lambda: not of_service(service), "processes outlive the service")
    assert chunks(service, "running") == 0


def test_why_it_cannot_go_on_is_logged_and_it_is_tried_again(tmp_path: Path) -> None:
    log = tmp_path / "log"
    with running_service(log, command=QUICK, workers=1, scheduler="nowhere") as service:
        begin(service, TABLE)
        first = until(lambda: table_process(service), "it is not started")
        until(lambda: table_process(service) not in {0, first}, "it is not started anew")
    lines = [json.loads(line)["message"] for line in log.read_text().splitlines()]
    assert any(line.startswith("table jobs pause: ") for line in lines)
    assert any("ended with status 1; again in" in line for line in lines)


def test_no_tables_no_process(tmp_path: Path) -> None:
    jobs = JobService(Settings(data_dir=str(tmp_path), job_workers=0))
    jobs.start()
    started = [thread.name for thread in threading.enumerate()]
    jobs.close()
    assert "table-jobs" not in started


def test_processes_of_tables_use_their_memory_again_unless_a_person_says_otherwise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To fetch it anew for each run of rows holds up a virtual machine for 100 ms."""
    monkeypatch.setenv("MALLOC_TRIM_THRESHOLD_", "131072")
    with running_service(tmp_path / "log", workers=1, job_workers=1) as service:
        process = at_work(service)
        for one in (process, *children(process)):
            told = Path(f"/proc/{one}/environ").read_bytes().split(b"\0")
            assert b"MALLOC_MMAP_MAX_=0" in told
            assert b"ARROW_DEFAULT_MEMORY_POOL=system" in told
            assert b"MALLOC_TRIM_THRESHOLD_=131072" in told
