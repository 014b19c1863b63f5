"""What the page on deployment gives to copy: the proxy waits for all work, waiting is quiet."""

import re
import subprocess
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest

from service.settings import Settings
from tests.pages.reading import blocks

READY = b'{"status":"ready","version":"0.1.0"}'


def read_timeout_s(path: str) -> float:
    """Return how long the page's nginx waits for an answer, by nginx's rules of locations."""
    (text,) = [one.text for one in blocks("docs/deployment.md") if one.file == "shapersmith.conf"]
    server = text[text.index("server {") :]
    locations = re.findall(r"(?s)location (~ )?(\S+) \{(.*?)\}", server)
    of_server = re.sub(r"(?s)location .*?\}", "", server)
    by_pattern = [body for mark, name, body in locations if mark and re.search(name, path)]
    by_prefix = sorted(
        (len(name), body) for mark, name, body in locations if not mark and path.startswith(name)
    )
    taken = by_pattern[0] if by_pattern else by_prefix[-1][1]
    for body in (taken, of_server):
        found = re.search(r"proxy_read_timeout (\d+)(s|h);", body)
        if found is not None:
            return float(found[1]) * {"s": 1, "h": 3600}[found[2]]
    return 60.0  # nginx's own


@pytest.mark.parametrize(
    ("path", "limit"),
    [
        ("/v1/designs", "time_limit_s"),
        ("/v1/designs/batch", "batch_limit_s"),
        ("/v1/maneuvers", "time_limit_s"),
        ("/v1/tables/0a1b/rows", "export_limit_s"),
        ("/v1/tables/0a1b/events", "export_limit_s"),
    ],
)
def test_the_proxy_waits_longer_than_the_work_may_take(path: str, limit: str) -> None:
    assert read_timeout_s(path) > float(getattr(Settings(), limit))


@pytest.mark.parametrize("page", ["docs/install.md", "docs/deployment.md"])
def test_waiting_for_the_service_prints_nothing_but_its_answer(page: str) -> None:
    answers = [(502, b"<html>Bad Gateway</html>"), (503, b'{"title": "starting"}'), (200, READY)]

    class Starting(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            status, body = answers.pop(0)
            self.send_response(status)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            """Say nothing on stderr."""

    (line,) = [
        command.line
        for block in blocks(page)
        for command in block.commands
        if "health/ready" in command.line
    ]
    with HTTPServer(("127.0.0.1", 0), Starting) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        port = server.server_address[1]
        typed = re.sub(r"127\.0\.0\.1:\d+", f"127.0.0.1:{port}", line)
        ran = subprocess.run(["bash", "-c", typed], capture_output=True, check=True)
        server.shutdown()
    assert ran.stdout == READY
    assert not answers
