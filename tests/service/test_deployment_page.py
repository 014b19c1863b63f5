"""Files of the page on deployment leave the service the time and room that its settings give."""

import configparser
import re
from pathlib import Path

import pytest

from service.http.server import SHUTDOWN_MARGIN_S
from service.settings import Settings
from tests.pages.reading import blocks

FILES = {block.file: block.text for block in blocks("docs/deployment.md") if block.file}

SETTINGS = Settings()

EVENTS = "location ~"
"""Begins the part of the proxy that passes streams on, with limits of its own."""


def test_the_proxy_waits_for_whatever_the_service_may_take() -> None:
    usual, _, events = FILES["shapersmith.conf"].partition(EVENTS)
    (wait_s,) = re.findall(r"proxy_read_timeout (\d+)s;", usual)
    before_locations = usual.partition("location")[0]
    assert f"proxy_read_timeout {wait_s}s;" in before_locations  # so that all of them inherit it
    longest_s = max(SETTINGS.time_limit_s, SETTINGS.batch_limit_s, SETTINGS.export_limit_s)
    assert float(wait_s) > longest_s
    assert "proxy_read_timeout 1h;" in events


def test_every_part_of_the_proxy_says_whose_request_it_is() -> None:
    before, _, locations = FILES["shapersmith.conf"].partition("location")
    assert "proxy_set_header X-Forwarded-For $remote_addr;" in before
    assert "proxy_set_header" not in locations  # one there would drop all of those before


def test_the_proxy_takes_the_largest_body() -> None:
    (megabytes,) = re.findall(r"client_max_body_size (\d+)m;", FILES["shapersmith.conf"])
    largest = max(SETTINGS.max_table_bytes, SETTINGS.max_batch_bytes, SETTINGS.max_body_bytes)
    assert int(megabytes) * 1024**2 >= largest


def test_systemd_waits_until_requests_are_finished() -> None:
    unit = configparser.ConfigParser(strict=False, interpolation=None)
    unit.optionxform = str  # type: ignore[assignment, method-assign]
    unit.read_string(FILES["shapersmith.service"])
    service = unit["Service"]
    assert float(service["TimeoutStopSec"]) >= SETTINGS.time_limit_s + SHUTDOWN_MARGIN_S
    state = Path("/var/lib") / service["StateDirectory"]
    assert f"SHAPERSMITH_DATA_DIR={state}" in FILES["shapersmith.service"]
    assert "--host 127.0.0.1" in service["ExecStart"]


@pytest.mark.parametrize("name", ["shapersmith.conf", "shapersmith.service"])
def test_the_service_is_where_the_proxy_looks_for_it(name: str) -> None:
    port = {"shapersmith.conf": "server 127.0.0.1:8000;", "shapersmith.service": "--port 8000"}
    assert port[name] in FILES[name]
