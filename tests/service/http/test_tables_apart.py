"""What tables may not hold up: a store that is locked or gone, files that take long to make."""

import os
import signal
import sqlite3
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.files import locked as file_locked
from service.jobs.results import lock_of, write_result_of
from service.jobs.service import JobService
from service.problems import NOT_FOUND
from service.settings import Settings
from tests.conftest import CRANE, Running, running_service
from tests.harmed_stores import HARMS, locked
from tests.job_stores import job
from tests.processes import until, workers
from tests.service.http.test_tables_over_http import TABLE, ended


@pytest.fixture
def service(tmp_path: Path) -> Any:
    with running_service(tmp_path / "log", workers=1) as service:
        yield service


@pytest.fixture
def client(service: Running) -> Any:
    with service.client() as client:
        yield client


def begun(client: httpx.Client) -> str:
    location: str = client.post("/v1/tables", json=TABLE).headers["location"]
    ended(client, location)
    return location


@pytest.mark.parametrize("kind", ["IMMEDIATE", "EXCLUSIVE"])
def test_a_locked_store_is_read_and_refuses_what_would_write(
    service: Running, client: httpx.Client, kind: str
) -> None:
    location = begun(client)
    with locked(service.data / "jobs.sqlite", kind):
        for path in ("/v1/tables", location, f"{location}/events", f"{location}/result"):
            assert client.get(path).status_code == 200, path
        assert client.get("/health/live").status_code == 200
        assert client.post("/v1/designs", json=CRANE).status_code == 200
        for refused in (client.post("/v1/tables", json=TABLE), client.delete(location)):
            assert (refused.status_code, refused.json()["type"]) == (
                503,
                "urn:shapersmith:overloaded",
            )
            assert "locked" in refused.json()["detail"]
            assert int(refused.headers["retry-after"]) >= 1
    ended(client, client.post("/v1/tables", json=TABLE).headers["location"])
    assert client.delete(location).status_code == 200


@pytest.mark.parametrize(("harm", "told"), HARMS)
def test_a_store_that_is_gone_or_damaged_is_told_by_every_route(
    service: Running, client: httpx.Client, harm: Callable[[Path], None], told: str
) -> None:
    location = begun(client)
    harm(service.data / "jobs.sqlite")
    for method, path in [
        ("GET", "/v1/tables"),
        ("POST", "/v1/tables"),
        ("GET", location),
        ("DELETE", location),
        ("POST", f"{location}/resume"),
        ("GET", f"{location}/events"),
        ("GET", f"{location}/result"),
    ]:
        refused = client.request(method, path, json=TABLE if path == "/v1/tables" else None)
        assert (refused.status_code, refused.json()["type"]) == (503, "urn:shapersmith:overloaded")
        assert told in refused.json()["detail"], (method, path)
    assert client.post("/v1/designs", json=CRANE).status_code == 200


def test_a_file_that_takes_long_holds_up_nobody_and_ends_with_its_clients(
    service: Running, client: httpx.Client
) -> None:
    location = begun(client)
    name = f"{location.rpartition('/')[2]}.json"
    address = f"{location}/result?format=json"

    def leave() -> None:
        with service.client() as impatient, pytest.raises(httpx.ReadTimeout):
            impatient.get(address, timeout=3)

    answers: list[bytes] = []

    def stay() -> None:
        with service.client() as patient:
            answers.append(patient.get(address).raise_for_status().content)

    def started(ask: Callable[[], None]) -> list[threading.Thread]:
        threads = [threading.Thread(target=ask) for _ in range(4)]
        for thread in threads:
            thread.start()
        return threads

    # It takes as long as another writer, who is here, has it.
    with file_locked(lock_of(service.data / "results" / name)):
        there = set(workers(service))
        leaving = started(leave)
        assert client.get(f"{location}/result").status_code == 200
        assert client.get(location).status_code == 200
        assert client.post("/v1/designs", json=CRANE).status_code == 200
        for thread in leaving:
            thread.join()
        until(lambda: there - set(workers(service)), "a worker goes on for nobody")
        staying = started(stay)
        assert client.post("/v1/designs", json=CRANE).status_code == 200
    for thread in staying:
        thread.join()
    assert len(answers) == 4
    assert len(set(answers)) == 1


@pytest.fixture
def stored(service: Running, client: httpx.Client) -> tuple[str, str, Path]:
    """Return the store's URL, a job that is done, and where its file would be."""
    job = begun(client).rpartition("/")[2]
    return f"sqlite:///{service.data / 'jobs.sqlite'}", job, service.data / "results" / f"{job}.csv"


def test_what_a_killed_writer_left_is_removed_and_what_a_live_one_writes_is_waited_for(
    stored: tuple[str, str, Path],
) -> None:
    url, job, path = stored
    part = path.with_name(f".{path.name}.0123.part")
    part.write_bytes(b"half")
    lock_of(path).touch()
    refused: list[Any] = []
    maker = threading.Thread(
        target=lambda: refused.append(write_result_of(url, job, "csv", str(path)))
    )
    with file_locked(lock_of(path)):
        maker.start()
        maker.join(0.5)
        assert maker.is_alive()
        assert part.exists()
    maker.join()
    assert refused == [None]
    assert [one.name for one in path.parent.iterdir()] == [path.name]


def test_what_was_left_of_a_deletion_is_erased_at_the_next_start(tmp_path: Path) -> None:
    file = tmp_path / "jobs.sqlite"
    jobs = JobService(Settings(data_dir=str(tmp_path), job_workers=0))
    jobs.store.add(job())
    store = sqlite3.connect(file, timeout=60)
    store.execute("UPDATE jobs SET state = 'deleted'")
    store.commit()
    jobs.start()
    until(lambda: not store.execute("SELECT * FROM jobs").fetchall(), "the job is still there")
    jobs.close()
    store.close()


@pytest.mark.parametrize("blob", [None, b"", b"no rows", "cut", "text"])
def test_rows_that_are_damaged_are_told_and_leave_no_file(
    stored: tuple[str, str, Path], client: httpx.Client, blob: Any
) -> None:
    _, job, path = stored
    store = sqlite3.connect(path.parents[1] / "jobs.sqlite", timeout=60)
    if blob == "cut":
        ((whole,),) = store.execute("SELECT blob FROM chunks WHERE job = ? AND number = 1", (job,))
        blob = whole[: len(whole) // 2]
    store.execute("UPDATE chunks SET blob = ? WHERE job = ? AND number = 1", (blob, job))
    store.commit()
    store.close()
    refused = client.get(f"/v1/tables/{job}/result")
    assert (refused.status_code, refused.json()["type"]) == (503, "urn:shapersmith:overloaded")
    assert "chunk 1 of job" in refused.json()["detail"]
    assert not list(path.parent.iterdir())


def test_a_table_that_is_deleted_while_its_file_is_made_is_not_found(
    stored: tuple[str, str, Path], client: httpx.Client
) -> None:
    url, job, path = stored
    client.delete(f"/v1/tables/{job}").raise_for_status()
    problem = write_result_of(url, job, "csv", str(path))
    assert problem is not None
    assert problem.kind is NOT_FOUND
    assert not list(path.parent.iterdir())


def test_files_that_nobody_needs_are_removed_by_the_service(
    service: Running, stored: tuple[str, str, Path]
) -> None:
    _, _, path = stored
    os.kill(service.process.pid, signal.SIGTERM)
    service.process.wait()
    kept = path
    kept.write_bytes(b"whole")
    for name in (f".{path.name}.0123.part", f".{path.name}.lock", f"{32 * '0'}.csv"):
        path.with_name(name).write_bytes(b"")
    with file_locked(path.with_name(f".{32 * '1'}.csv.lock")):
        path.with_name(f".{32 * '1'}.csv.0123.part").write_bytes(b"")
        jobs = JobService(Settings(data_dir=str(service.data), job_workers=0))
        jobs.cleaner.clean_files()
        jobs.close()
        left = sorted(one.name for one in path.parent.iterdir())
    written = [f".{32 * '1'}.csv.0123.part", f".{32 * '1'}.csv.lock"]
    assert left == sorted([kept.name, *written])
