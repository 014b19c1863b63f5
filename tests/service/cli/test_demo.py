"""`make demo` as a user runs it, and what it says of a service that does not answer."""

import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from service.cli import demo
from service.problems import OVERLOADED, Problem
from tests.patience import PATIENT_S


def test_the_demo_designs_prints_draws_and_stops(tmp_path: Path) -> None:
    folder = tmp_path / "demo-output"
    done = subprocess.run(
        [sys.executable, "-m", "service.cli.demo", str(folder)],
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENT_S,
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert done.stdout.endswith("The service has stopped with status 0.\n")
    for kind in demo.SHAPERS:
        assert f"{kind} for the crane of Kim's thesis (2011):" in done.stdout
        assert (folder / f"{kind}.png").read_bytes().startswith(b"\x89PNG")
        assert "</svg>" in (folder / f"{kind}.svg").read_text()
    # The first table is that of the README: numzvd.
    assert re.search(r"^5 +1\.3181200\d +1$", done.stdout, re.MULTILINE)
    assert "certificate verified: residual" in done.stdout


@pytest.fixture
def overloaded() -> Iterator[str]:
    """Serve nothing but the service's own 503."""
    refusal = Problem(OVERLOADED, "no worker is ready").document("id-1").model_dump_json().encode()

    class Refusing(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(503)
            self.end_headers()
            self.wfile.write(refusal)

        def log_message(self, format: str, *args: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Refusing) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


class Clock:
    """A clock that moves when somebody sleeps, by as much each time, however long that was."""

    def __init__(self, step_s: float) -> None:
        self._now_s, self._step_s = 0.0, step_s

    def monotonic(self) -> float:
        return self._now_s

    def sleep(self, seconds: float) -> None:
        del seconds
        self._now_s += self._step_s


def test_a_slow_start_is_said_once_and_its_reason_where_it_fails(
    overloaded: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(demo, "time", Clock(step_s=demo.SLOW_START_S))
    with subprocess.Popen(["sleep", "600"]) as server:
        try:
            with pytest.raises(demo.DemoError, match=r"not ready in .* s: 503, no worker is ready"):
                demo._wait_until_ready(overloaded, server)
        finally:
            server.kill()
    told = capsys.readouterr().out
    assert told.count("The service is starting; waiting up to 300 s.") == 1


def test_a_service_that_has_ended_is_not_waited_for() -> None:
    with subprocess.Popen(["false"]) as server:
        server.wait()
        with pytest.raises(demo.DemoError, match="the service ended with status 1"):
            demo._wait_until_ready("http://127.0.0.1:9", server)
