"""The service as a process: workers, limits, signals, log."""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE, Running, changed, running_service
from tests.patience import PATIENT_S
from tests.processes import TICKS_PER_SECOND, children, end, running, until, workers
from tests.service.cli.commands import shapersmith

ENDLESS: dict[str, Any] = {
    "plant": {
        "kind": "modes",
        "modes": [
            {"natural_frequency_rad_s": frequency, "damping_ratio": 0.01}
            for frequency in (1.0, 1.7, 2.9, 4.1, 6.3, 8.8)
        ],
    },
    "actuator": {"kind": "ideal"},
    "shaper": {"kind": "convolved", "base": "zvdd"},
    "sensitivity": {"from_ratio": 0.3, "to_ratio": 1.8},
}
"""Ten seconds of work and more: 4,096 impulses, and what they leave over a band."""

SLOW: dict[str, Any] = {
    **ENDLESS,
    "plant": {**ENDLESS["plant"], "modes": ENDLESS["plant"]["modes"][:5]},
}
"""A second of work and more: 1,024 impulses."""

WORKED_S = 0.2
"""Processor time that a worker has not used before its first task: it is born with its solvers
built [s]."""


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """Yield a service with one worker, for tests that it survives."""
    log = tmp_path_factory.mktemp("alone") / "log"
    with running_service(log, job_workers=0, workers=1) as service:
        yield service


@pytest.fixture(scope="module")
def hasty(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """Yield a service that ends work after a second."""
    log = tmp_path_factory.mktemp("hasty") / "log"
    with running_service(log, job_workers=0, workers=1, time_limit_s=1.0) as service:
        yield service


def asking(service: Running, path: str, body: bytes) -> socket.socket:
    """Return a connection that has asked."""
    connection = socket.create_connection(("127.0.0.1", service.port))
    head = f"POST {path} HTTP/1.1\r\nhost: x\r\ncontent-length: {len(body)}\r\n\r\n"
    connection.sendall(head.encode() + body)
    return connection


def at_work(
    service: Running, before: dict[int, float], used_s: float = 4.5 / TICKS_PER_SECOND
) -> int:
    """Return a worker that has worked since, waiting for one; a ready worker that waits does not.

    Four ticks of the processor's clock are work: to be born takes fewer.
    """
    return until(
        lambda: next(
            (pid for pid, used in workers(service).items() if used > before.get(pid, 0.0) + used_s),
            0,
        ),
        "no worker is at work",
    )


def test_a_design_that_hits_its_time_limit_is_ended_and_the_worker_replaced(hasty: Running) -> None:
    with hasty.client() as client:
        late = client.post("/v1/designs", json=ENDLESS)
        assert (late.status_code, late.json()["type"]) == (504, "urn:shapersmith:time-limit")
        # As many times as it takes: on a busy machine the limit may end what is small, too.
        until(lambda: client.post("/v1/designs", json=CRANE).is_success, "no worker answers")


def test_one_late_line_spoils_no_other_of_its_batch(hasty: Running) -> None:
    lines = "\n".join(map(json.dumps, [CRANE, ENDLESS, CRANE]))
    with hasty.client() as client:

        def only_the_late_line_fails() -> bool:
            told = client.post("/v1/designs/batch", content=lines).text.splitlines()
            first, late, last = [json.loads(line).get("status", 200) for line in told]
            assert late == 504
            return (first, last) == (200, 200)

        # As many times as it takes: on a busy machine the limit may end what is small, too.
        until(only_the_late_line_fails, "other lines of its batch fail")


def test_a_worker_killed_while_it_solves_is_replaced_and_its_request_retried(
    alone: Running,
) -> None:
    with alone.client() as client:
        answers: list[httpx.Response] = []
        before = workers(alone)
        thread = threading.Thread(
            target=lambda: answers.append(client.post("/v1/designs", json=SLOW))
        )
        thread.start()
        victim = at_work(alone, before)
        os.kill(victim, signal.SIGKILL)
        thread.join(PATIENT_S)
        assert answers[0].status_code == 200  # by the second worker
        assert victim not in workers(alone)
        assert client.post("/v1/designs", json=CRANE).status_code == 200
    assert f"worker {victim} died at a task" in alone.log.read_text()


def test_a_request_that_crashes_every_worker_is_given_up_at_the_second(alone: Running) -> None:
    crashed = "died at a task: killed by SIGSEGV"
    already = alone.log.read_text().count(crashed)
    with alone.client() as client:
        before = workers(alone)
        answers: list[httpx.Response] = []
        thread = threading.Thread(
            target=lambda: answers.append(client.post("/v1/designs", json=ENDLESS))
        )
        thread.start()
        while thread.is_alive():
            for pid, used in workers(alone).items():
                if used > before.get(pid, 0.0) + WORKED_S:
                    end(pid, signal.SIGSEGV)
            thread.join(0.05)
        assert (answers[0].status_code, answers[0].json()["type"]) == (
            500,
            "urn:shapersmith:internal",
        )
        assert client.post("/v1/designs", json=CRANE).status_code == 200
    assert alone.log.read_text().count(crashed) == already + 2


def cut_off(client: httpx.Client) -> threading.Thread:
    """Return a thread that asks for endless work, and is cut off when the service is killed."""

    def post() -> None:
        with pytest.raises(httpx.TransportError):
            client.post("/v1/designs", json=ENDLESS)

    thread = threading.Thread(target=post)
    thread.start()
    return thread


def test_too_much_waiting_work_is_refused_with_a_time_to_retry(tmp_path: Path) -> None:
    with (
        running_service(tmp_path / "log", job_workers=0, workers=1, max_pending=1) as service,
        service.client() as client,
    ):
        before = workers(service)
        thread = cut_off(client)
        at_work(service, before)
        refused = client.post("/v1/designs", json=CRANE)
        service.process.kill()
        thread.join(PATIENT_S)
    assert (refused.status_code, refused.json()["type"]) == (503, "urn:shapersmith:overloaded")
    assert int(refused.headers["retry-after"]) >= 1


def _refuses(service: Running) -> bool:
    try:
        with service.client() as late:
            late.get("/health/live")
    except httpx.TransportError:
        return True
    return False


def test_sigterm_finishes_what_runs_refuses_what_is_new_and_exits_0(tmp_path: Path) -> None:
    with (
        running_service(tmp_path / "log", job_workers=0, workers=1) as service,
        service.client() as client,
    ):
        answers: list[httpx.Response] = []
        before = workers(service)
        thread = threading.Thread(
            target=lambda: answers.append(client.post("/v1/designs", json=SLOW))
        )
        thread.start()
        at_work(service, before)
        below = children(service.process.pid)
        service.process.send_signal(signal.SIGTERM)
        until(lambda: _refuses(service), "the service takes what is new")
        thread.join(PATIENT_S)
        assert answers[0].status_code == 200
        assert service.process.wait(PATIENT_S) == 0
    assert below
    # The fork server sees the end of its parent a little later.
    until(lambda: not running(below), "workers outlive the service")


def test_workers_end_with_their_parent_in_the_middle_of_a_solve(tmp_path: Path) -> None:
    with (
        running_service(tmp_path / "log", job_workers=0, workers=2) as service,
        service.client() as client,
    ):
        before = workers(service)
        thread = cut_off(client)
        at_work(service, before)
        below = children(service.process.pid)
        service.process.kill()
        until(lambda: not running(below), "workers outlive their parent")
        thread.join(PATIENT_S)
    assert len(below) >= 2


def test_the_log_has_one_json_line_a_request(alone: Running) -> None:
    with alone.client() as client:
        client.post("/v1/designs", json=CRANE, headers={"x-request-id": "one"})
        client.get("/v1/nothing", headers={"x-request-id": "two"})
    until(lambda: '"two"' in alone.log.read_text(), "no line in the log")
    lines = [json.loads(line) for line in alone.log.read_text().splitlines()]
    told = {line["request_id"]: line for line in lines if line["logger"] == "shapersmith.access"}
    assert (told["one"]["method"], told["one"]["path"], told["one"]["status"]) == (
        "POST",
        "/v1/designs",
        200,
    )
    assert told["one"]["duration_ms"] > 0
    assert told["two"]["status"] == 404
    assert sum(line.get("request_id") == "one" for line in lines) == 1


def test_a_taken_port_is_one_readable_line(service: Running) -> None:
    second = subprocess.run(
        [sys.executable, "-m", "service", "serve", "--port", str(service.port)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert second.returncode == 1
    assert second.stderr == (
        f"shapersmith: cannot serve on 127.0.0.1 port {service.port}: Address already in use\n"
    )


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("WORKERS", "none", "SHAPERSMITH_WORKERS"),
        ("TIME_LIMIT_S", "-1", "SHAPERSMITH_TIME_LIMIT_S"),
        ("COLOUR", "red", "SHAPERSMITH_COLOUR"),
    ],
)
def test_a_faulty_setting_is_named(
    name: str, value: str, told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(f"SHAPERSMITH_{name}", value)
    started = shapersmith("serve", "--port", 0)
    assert started.returncode == 2
    assert told in started.stderr
    assert started.stderr.count("\n") == 1


def test_a_client_that_leaves_early_is_no_error_of_the_service(alone: Running) -> None:
    already = len(alone.log.read_text())
    with socket.create_connection(("127.0.0.1", alone.port)) as half:
        half.sendall(
            b"POST /v1/designs HTTP/1.1\r\nhost: x\r\nx-request-id: half\r\n"
            b"content-length: 500\r\n\r\n{"
        )
    until(lambda: '"half"' in alone.log.read_text(), "no line in the log")
    lines = [json.loads(line) for line in alone.log.read_text()[already:].splitlines()]
    assert [line["status"] for line in lines if line.get("request_id") == "half"] == [499]
    assert not [line for line in lines if line["level"] == "error"]


def test_a_busy_service_is_ready_and_alive(alone: Running) -> None:
    before = workers(alone)
    with asking(alone, "/v1/designs", json.dumps(ENDLESS).encode()), alone.client() as client:
        busy = at_work(alone, before)
        assert client.get("/health/ready").status_code == 200
        assert busy in workers(alone)  # it answers while it works
    until(lambda: busy not in workers(alone), "its work goes on")


def test_sigterm_does_not_wait_for_a_body_that_never_comes(tmp_path: Path) -> None:
    log = tmp_path / "log"
    quick = changed(service__http__server__SHUTDOWN_MARGIN_S=0)
    with (
        running_service(log, command=quick, job_workers=0, workers=1, time_limit_s=0.5) as service,
        socket.create_connection(("127.0.0.1", service.port)) as half,
    ):
        half.sendall(b"POST /v1/designs HTTP/1.1\r\nhost: x\r\ncontent-length: 500\r\n\r\n{")
        with service.client() as client:
            client.get("/health/live")  # what was sent before has been read
        service.process.send_signal(signal.SIGTERM)
        assert service.process.wait(PATIENT_S) == 0
    assert '"status": 408' not in log.read_text()  # which it is when the body was waited for
