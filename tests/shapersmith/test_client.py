"""A client answers what the functions answer, and imports no solver for it."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from threading import Thread

import pytest

import shapersmith
from service.operations.table import TABLE
from shapersmith.here import HERE
from tests.conftest import CRANE, Running, free_port
from tests.patience import PATIENT_S
from tests.shapersmith.requests import REQUESTS, call

SOLVERS = {"casadi", "clarabel", "scipy", "cvxpy", "numba", "matplotlib"}

PROGRAM = """
import sys, shapersmith
crane = shapersmith.Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
drive = shapersmith.FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
found = shapersmith.Client(sys.argv[1], timeout_s=float(sys.argv[2])).design(crane, drive, "numzv")
print(found, found.times_s, found._repr_html_())
print("", *sys.modules, sep="\\n", file=sys.stderr)
"""


@pytest.fixture(autouse=True)
def no_proxy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep calls to this machine from a proxy that the environment may name."""
    monkeypatch.setenv("no_proxy", "127.0.0.1")


@pytest.fixture
def remote(service: Running) -> shapersmith.Client:
    return shapersmith.Client(f"{service.address}/", timeout_s=PATIENT_S)


@pytest.mark.parametrize("operation", TABLE)
def test_a_service_answers_what_is_computed_here(
    remote: shapersmith.Client, operation: str
) -> None:
    request = REQUESTS[operation]
    far, near = call(remote, operation)(**request), call(HERE, operation)(**request)
    assert type(far) is type(near)
    assert far.to_dict() == near.to_dict()


def test_an_error_of_the_service_is_that_of_here(remote: shapersmith.Client) -> None:
    wrong = {**CRANE, "shaper": {"kind": "ei", "sample_tolerance": 0.1}}
    errors = []
    for calls in (remote, HERE):
        with pytest.raises(shapersmith.InvalidInputError) as caught:
            calls.design(**wrong)
        errors.append(caught.value)
    far, near = errors
    assert (far.code, far.detail, far.errors) == (near.code, near.detail, near.errors)
    assert far.document.request_id
    assert near.document.request_id is None


def test_a_call_imports_no_solver(service: Running) -> None:
    command = [sys.executable, "-c", PROGRAM, service.address, str(PATIENT_S)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "numzv" in done.stdout
    imported = set(done.stderr.split())
    assert "shapersmith.client" in imported
    assert not imported & SOLVERS


def test_no_answer_is_an_error_of_its_own() -> None:
    nobody = shapersmith.Client(f"http://127.0.0.1:{free_port()}")
    with pytest.raises(shapersmith.UnreachableError, match="no answer from") as caught:
        nobody.design(**CRANE)
    assert caught.value.code == "unreachable"


@contextmanager
def stranger(status: int, body: bytes, missing: int = 0) -> Iterator[str]:
    """Serve one answer that is none of shapersmith, or breaks off, and yield the address."""

    class Answering(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.rfile.read(int(self.headers["content-length"]))
            self.send_response(status)
            self.send_header("content-length", str(len(body) + missing))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Answering) as server:
        thread = Thread(target=server.handle_request)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}"
        thread.join()


@pytest.mark.parametrize(("status", "body"), [(200, b"{}"), (502, b"<h1>Bad Gateway</h1>")])
def test_what_is_no_answer_of_shapersmith_is_said(status: int, body: bytes) -> None:
    with (
        stranger(status, body) as address,
        pytest.raises(
            shapersmith.ServiceError, match="is no shapersmith of this version"
        ) as caught,
    ):
        shapersmith.Client(address).design(**CRANE)
    assert caught.value.code == "strange_answer"


@pytest.mark.parametrize("status", [200, 502])
def test_an_answer_that_breaks_off_is_none(status: int) -> None:
    with (
        stranger(status, b"{}", missing=1) as address,
        pytest.raises(shapersmith.UnreachableError, match="IncompleteRead"),
    ):
        shapersmith.Client(address).design(**CRANE)
