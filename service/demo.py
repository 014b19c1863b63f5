"""`make demo`: serve, design the thesis's crane over HTTP, print it, write pictures, stop."""

import json
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

from schemas.designs import DesignRequest, DesignResponse
from service.files import write_whole
from service.operations import THESIS_CRANE, design_picture
from service.texts import as_table

START_WAIT_S = 60.0
STOP_WAIT_S = 30.0

SHAPERS = ("numzvd", "numzv", "umzvd")


def main(folder: Path) -> int:
    """Run the demo; pictures go to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    command = [sys.executable, "-m", "service.cli", "serve", "--port", str(port)]
    server = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        address = f"http://127.0.0.1:{port}"
        _wait_until_ready(address, server)
        for kind in SHAPERS:
            _show(address, kind, folder)
    finally:
        server.terminate()
        status = server.wait(STOP_WAIT_S)
    _say(f"The service has stopped with status {status}.")
    return status


def _wait_until_ready(address: str, server: "subprocess.Popen[bytes]") -> None:
    deadline = time.monotonic() + START_WAIT_S
    while True:
        try:
            with urllib.request.urlopen(f"{address}/health/ready") as ready:
                ready.read()
            return
        except urllib.error.URLError:
            if server.poll() is not None or time.monotonic() > deadline:
                raise
            time.sleep(0.1)


def _show(address: str, kind: str, folder: Path) -> None:
    body = json.dumps({**THESIS_CRANE, "shaper": {"kind": kind}}).encode()
    request = urllib.request.Request(
        f"{address}/v1/designs", body, {"content-type": "application/json"}
    )
    with urllib.request.urlopen(request) as answer:
        response = DesignResponse.model_validate_json(answer.read())
    _say(f"{kind} for the thesis's crane:\n\n{as_table(response)}")
    for image_format in ("png", "svg"):
        picture = folder / f"{kind}.{image_format}"
        write_whole(picture, design_picture(DesignRequest.model_validate_json(body), image_format))
        _say(f"wrote {picture}")


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
