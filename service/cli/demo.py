"""`make demo`: serve, design the thesis's crane over HTTP, print it, write pictures, stop."""

import json
import os
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

from design.pictures.files import figure_bytes
from schemas.design_request import DesignRequest
from schemas.designs import DesignResponse
from schemas.problems import ProblemDocument
from service.catalogue import THESIS_CRANE
from service.cli.given_files import PICTURES
from service.cli.rendering import as_table
from service.files import write_whole
from service.operations.design_picture import design_picture

SLOW_START_S = 5.0
"""When a start is called slow [s]."""

START_WAIT_S = 300.0
"""How long the service may take to start: a cold machine compiles and loads its solvers [s]."""

STOP_WAIT_S = 60.0

SHAPERS = ("numzvd", "numzv", "umzvd")


class DemoError(Exception):
    """The service did not answer; the message says why."""


def main(folder: Path) -> int:
    """Run the demo; pictures, the service's log and its data go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    command = [sys.executable, "-m", "service", "serve", "--port", str(port)]
    log = folder / "service.log"
    environment = {**os.environ, "SHAPERSMITH_DATA_DIR": str(folder / "data")}
    with log.open("wb") as stderr:
        server = subprocess.Popen(command, stderr=stderr, env=environment)
    fault = None
    try:
        address = f"http://127.0.0.1:{port}"
        _wait_until_ready(address, server)
        for kind in SHAPERS:
            _show(address, kind, folder)
    except DemoError as error:
        fault = error
    finally:
        server.terminate()
        status = server.wait(STOP_WAIT_S)
    if fault is not None:
        _say(f"The demo ends here: {fault}. The service's log is {log}.")
        return 1
    _say(f"The service has stopped with status {status}.")
    return status


def _wait_until_ready(address: str, server: "subprocess.Popen[bytes]") -> None:
    """Wait until the service answers; a start that takes long is reported once."""
    started = time.monotonic()
    slow = False
    while True:
        try:
            _ask(f"{address}/health/ready")
            return
        except DemoError as error:
            reason = error
        waited = time.monotonic() - started
        if server.poll() is not None:
            raise DemoError(f"the service ended with status {server.returncode}")
        if waited > START_WAIT_S:
            raise DemoError(f"the service was not ready in {waited:.0f} s: {reason}")
        if waited > SLOW_START_S and not slow:
            _say(f"The service is starting; waiting up to {START_WAIT_S:.0f} s.")
            slow = True
        time.sleep(0.1)


def _ask(request: str | urllib.request.Request) -> bytes:
    """Return what the service answers.

    Raises
    ------
    DemoError
        If it does not, with the detail of its problem document where it sent one.
    """
    try:
        with urllib.request.urlopen(request) as answer:
            content: bytes = answer.read()
    except urllib.error.HTTPError as error:
        with error:
            problem = ProblemDocument.model_validate_json(error.read())
        raise DemoError(f"{error.code}, {problem.detail}") from None
    except urllib.error.URLError as error:
        raise DemoError(str(error.reason)) from None
    return content


def _show(address: str, kind: str, folder: Path) -> None:
    body = json.dumps({**THESIS_CRANE, "shaper": {"kind": kind}}).encode()
    request = urllib.request.Request(
        f"{address}/v1/designs", body, {"content-type": "application/json"}
    )
    response = DesignResponse.model_validate_json(_ask(request))
    _say(f"{kind} for the crane of Kim's thesis (2011):\n\n{as_table(response, body)}")
    figure = design_picture(DesignRequest.model_validate_json(body))
    for suffix, image_format in PICTURES.items():
        picture = folder / f"{kind}{suffix}"
        write_whole(picture, figure_bytes(figure, image_format))
        _say(f"wrote {picture}")


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
