"""What tables may not hold up: a store that is locked or gone, files that take long to make."""

import sqlite3
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.files import hold_lock as file_locked
from service.jobs.results import lock_of, write_result_of
from service.jobs.service import JobService
from service.problems import NOT_FOUND
from tests.conftest import CRANE, Running, changed, running_service
from tests.harmed_stores import HARMS, hold_locked
from tests.job_stores import job
from tests.patience import PATIENT_S
from tests.processes import until, workers
from tests.service.http.in_process import InProcess, require_problem
from tests.service.http.test_tables_over_http import TABLE, ended
from tests.tables_in_store import add_done, jobs_in


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """Yield a service with one worker, which no test harms for good; it waits less for locks."""
    log, quick = (
        tmp_path_factory.mktemp("apart") / "log",
        changed(service__jobs__database__LOCK_WAIT_S=1),
    )
    with running_service(log, command=quick, workers=1) as service:
        yield service


@pytest.fixture
def client(service: Running) -> Any:
    with service.client() as client:
        yield client


@dataclass(frozen=True, slots=True)
class Stored:
    """A table that is done: the store's URL, its file, the job, and where the job's file goes."""

    url: str
    file: Path
    job: str
    result: Path


@pytest.fixture
def jobs(tmp_path: Path) -> Iterator[JobService]:
    """Yield the table jobs of this process, which no other computes."""
    jobs = jobs_in(tmp_path)
    (tmp_path / "results").mkdir()
    yield jobs
    jobs.close()


@pytest.fixture
def here(jobs: JobService) -> InProcess:
    return InProcess(jobs)


@pytest.fixture
def stored(tmp_path: Path, jobs: JobService) -> Stored:
    job = add_done(jobs.store, TABLE)
    return Stored(jobs.store.url, tmp_path / "jobs.sqlite", job, jobs.path_of(job, "csv"))


def begun(client: httpx.Client) -> str:
    location: str = client.post("/v1/tables", json=TABLE).headers["location"]
    ended(client, location)
    return location


@pytest.mark.parametrize("kind", ["IMMEDIATE", "EXCLUSIVE"])
def test_a_locked_store_is_read_and_refuses_what_would_write(
    service: Running, client: httpx.Client, kind: str
) -> None:
    location = begun(client)
    with hold_locked(service.data / "jobs.sqlite", kind):
        for path in ("/v1/tables", location, f"{location}/events", f"{location}/result"):
            assert client.get(path).status_code == 200, path
        assert client.get("/health/live").status_code == 200
        assert client.post("/v1/designs", json=CRANE).status_code == 200
        with ThreadPoolExecutor(2) as threads:  # each waits for the lock for as long as it may
            writes = [
                threads.submit(client.post, "/v1/tables", json=TABLE),
                threads.submit(client.delete, location),
            ]
        for refused in (write.result() for write in writes):
            assert (refused.status_code, refused.json()["type"]) == (
                503,
                "urn:shapersmith:overloaded",
            )
            assert int(refused.headers["retry-after"]) >= 1
    ended(client, client.post("/v1/tables", json=TABLE).headers["location"])
    assert client.delete(location).status_code == 200


@pytest.mark.parametrize(("harm", "told"), HARMS)
def test_a_store_that_is_gone_or_damaged_is_told_by_every_route(
    here: InProcess, stored: Stored, harm: Callable[[Path], None], told: str
) -> None:
    location = f"/v1/tables/{stored.job}"
    harm(stored.file)
    for method, path in [
        ("GET", "/v1/tables"),
        ("POST", "/v1/tables"),
        ("GET", location),
        ("DELETE", location),
        ("POST", f"{location}/resume"),
        ("GET", f"{location}/events"),
        ("GET", f"{location}/result"),
    ]:
        refused = here.ask(method, path, TABLE if path == "/v1/tables" else None)
        require_problem(refused, 503, "overloaded", told)
    assert here.ask("POST", "/v1/designs", CRANE).status_code == 200


def test_a_file_that_takes_long_holds_up_nobody_and_ends_with_its_clients(
    service: Running, client: httpx.Client
) -> None:
    location = begun(client)
    name = f"{location.rpartition('/')[2]}.json"
    address = f"{location}/result?format=json"

    def leave() -> None:
        with service.client() as impatient, pytest.raises(httpx.TimeoutException):
            impatient.get(address, timeout=1)

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

        def ended_for_nobody() -> bool:
            """Return whether a worker has ended; where none had begun, ask and leave again."""
            if not there - set(workers(service)):
                leave()
            return bool(there - set(workers(service)))

        until(ended_for_nobody, "a worker goes on for nobody")
        staying = started(stay)
        assert client.post("/v1/designs", json=CRANE).status_code == 200
    for thread in staying:
        thread.join()
    assert len(answers) == 4
    assert len(set(answers)) == 1


def test_what_a_killed_writer_left_is_removed_and_what_a_live_one_writes_is_waited_for(
    stored: Stored,
) -> None:
    path = stored.result
    part = path.with_name(f".{path.name}.0123.part")
    part.write_bytes(b"half")
    lock_of(path).touch()
    refused: list[Any] = []
    maker = threading.Thread(
        target=lambda: refused.append(write_result_of(stored.url, stored.job, "csv", str(path)))
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
    jobs = jobs_in(tmp_path)
    jobs.store.add(job())
    store = sqlite3.connect(file, timeout=PATIENT_S)
    store.execute("UPDATE jobs SET state = 'deleted'")
    store.commit()
    jobs.start()
    until(lambda: not store.execute("SELECT * FROM jobs").fetchall(), "the job is still there")
    jobs.close()
    store.close()


def test_a_table_that_has_been_kept_long_enough_goes_with_its_file(
    here: InProcess, jobs: JobService, stored: Stored, tmp_path: Path
) -> None:
    young = add_done(jobs.store, TABLE)
    for one in (stored.job, young):
        assert here.ask("GET", f"/v1/tables/{one}/result").status_code == 200
    store = sqlite3.connect(stored.file, timeout=PATIENT_S)
    older = "UPDATE jobs SET last_finished = last_finished - 86400 WHERE id = ?"
    store.execute(older, (stored.job,))
    store.commit()
    store.close()
    cleaning = jobs_in(tmp_path, keep_tables_days=0.9)
    cleaning.start()
    until(lambda: jobs.store.job(stored.job) is None, "the table is still there")
    until(lambda: not stored.result.exists(), "its file is still there")
    cleaning.close()
    assert here.ask("GET", f"/v1/tables/{stored.job}").status_code == 404
    assert here.ask("GET", f"/v1/tables/{young}").status_code == 200
    assert jobs.path_of(young, "csv").exists()


@pytest.mark.parametrize("blob", [None, b"", b"no rows", "cut", "text"])
def test_rows_that_are_damaged_are_told_and_leave_no_file(
    here: InProcess, stored: Stored, blob: Any
) -> None:
    job = stored.job
    store = sqlite3.connect(stored.file, timeout=PATIENT_S)
    if blob == "cut":
        ((whole,),) = store.execute("SELECT blob FROM chunks WHERE job = ? AND number = 1", (job,))
        blob = whole[: len(whole) // 2]
    store.execute("UPDATE chunks SET blob = ? WHERE job = ? AND number = 1", (blob, job))
    store.commit()
    store.close()
    refused = here.ask("GET", f"/v1/tables/{job}/result")
    require_problem(refused, 503, "overloaded", "chunk 1 of job")
    assert not list(stored.result.parent.iterdir())


def test_a_table_that_is_deleted_while_its_file_is_made_is_not_found(
    here: InProcess, stored: Stored
) -> None:
    here.ask("DELETE", f"/v1/tables/{stored.job}").raise_for_status()
    problem = write_result_of(stored.url, stored.job, "csv", str(stored.result))
    assert problem is not None
    assert problem.kind is NOT_FOUND
    assert not list(stored.result.parent.iterdir())


def test_files_that_nobody_needs_are_removed_by_the_service(
    jobs: JobService, stored: Stored
) -> None:
    path = kept = stored.result
    kept.write_bytes(b"whole")
    for name in (f".{path.name}.0123.part", f".{path.name}.lock", f"{32 * '0'}.csv"):
        path.with_name(name).write_bytes(b"")
    with file_locked(path.with_name(f".{32 * '1'}.csv.lock")):
        path.with_name(f".{32 * '1'}.csv.0123.part").write_bytes(b"")
        jobs.cleaner.clean_files()
        left = sorted(one.name for one in path.parent.iterdir())
    written = [f".{32 * '1'}.csv.0123.part", f".{32 * '1'}.csv.lock"]
    assert left == sorted([kept.name, *written])
