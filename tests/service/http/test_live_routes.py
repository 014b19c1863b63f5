"""A crane driven over a WebSocket: what the route takes, sends, refuses, and how it ends."""

import json
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from service.problems import OVERLOADED, Problem
from tests.service.http.in_process import InProcess
from tests.service.http.in_process_socket import Closed, Refused, Socket
from tests.service.live.test_session import CRANE, SHAPINGS

LIVE = {**CRANE, "shaping": SHAPINGS["live"]}

ALLOWED = {"origin": "http://service"}


@contextmanager
def session(service: InProcess, first: object = LIVE, **headers: str) -> Iterator[Socket]:
    with Socket(service, "/v1/live", headers) as socket:
        socket.send(first if isinstance(first, str) else json.dumps(first))
        yield socket


def told(socket: Socket, name: str) -> Any:
    """Return the next message of a sort; states go by."""
    while True:
        message = json.loads(socket.receive())
        (sort,) = message
        if sort == name:
            return message[name]
        assert sort == "state", message


def press(socket: Socket, **direction: float) -> Any:
    socket.send(json.dumps({"direction": direction}))
    return told(socket, "plan")


def test_states_and_proven_plans_are_sent() -> None:
    with session(InProcess(), **ALLOWED) as socket:
        told(socket, "version")
        first = told(socket, "state")
        started = press(socket, x=1)
        assert started["event"] == 1
        assert started["certificate"]["verified"]
        assert started["fallback"] is None
        assert started["command"]["x"]["levels"][-1] == 1.0
        stopped = press(socket, x=0)
        assert stopped["event"] == 2
        assert stopped["command"]["x"]["levels"][-1] == 0.0
        assert started["at_s"] < stopped["at_s"] < stopped["last_switch_s"]
        assert told(socket, "state")["at_s"] > first["at_s"]


def test_an_event_that_is_refused_ends_nothing() -> None:
    with session(InProcess()) as socket:
        told(socket, "version")
        for wrong in ("", "{", '{"direction": {"x": 7}}', '{"stop": "now"}'):
            socket.send(wrong)
            problem = told(socket, "problem")
            assert problem["type"] in ("urn:shapersmith:invalid-input", "urn:shapersmith:not-json")
            assert problem["request_id"]
        socket.send(b'{"direction": {"y": 1}}')
        assert told(socket, "plan")["event"] == 1


@pytest.mark.parametrize("first", ["", "[]", '{"plant": 1}', json.dumps(LIVE | {"until_s": 1})])
def test_a_first_message_that_is_no_run_ends_the_session(first: str) -> None:
    with session(InProcess(), first) as socket:
        assert told(socket, "problem")["errors"] is not None
        with pytest.raises(Closed) as ended:
            socket.receive()
        assert ended.value.code == 1008


def test_a_page_of_another_site_is_refused() -> None:
    refused = pytest.raises(Refused, match=r"elsewhere\.example")
    with refused as found, session(InProcess(), origin="http://elsewhere.example"):
        pass
    assert found.value.status == 403
    assert found.value.document["type"] == "urn:shapersmith:forbidden"


def test_more_sessions_than_the_setting_allows_are_refused() -> None:
    service = InProcess(max_live=1)
    with session(service) as socket:
        told(socket, "version")
        with pytest.raises(Refused, match="all 1 live sessions") as found, session(service):
            pass
        assert found.value.status == 503
        assert found.value.document["type"] == "urn:shapersmith:overloaded"
        assert found.value.headers["retry-after"]
    with session(service) as socket:
        told(socket, "version")


def test_a_pool_that_is_full_refuses_an_event_and_the_plan_before_goes_on() -> None:
    service = InProcess()
    with session(service) as socket:
        told(socket, "version")
        service.pool.full = Problem(OVERLOADED, "too much work is waiting")
        socket.send('{"direction": {"x": 1}}')
        assert told(socket, "problem")["type"] == "urn:shapersmith:overloaded"
        service.pool.full = None
        assert press(socket, x=1)["event"] == 1


def stopped(records: list[logging.LogRecord]) -> list[dict[str, Any]]:
    return [record.fields for record in records if record.name == "shapersmith.live"]  # type: ignore[attr-defined]


def test_a_crane_whose_client_vanishes_stops_without_swing(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.INFO)
    with session(InProcess()) as socket:
        told(socket, "version")
        press(socket, x=1, y=-1)
    (ended,) = stopped(caplog.records)
    assert ended["why"] == "the client is gone"
    assert ended["stopped"].startswith("without swing, last switch")


def test_a_crane_that_is_not_shaped_live_is_let_go(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    with session(InProcess(), CRANE) as socket:
        told(socket, "version")
        press(socket, x=1)
    (ended,) = stopped(caplog.records)
    assert ended["stopped"].startswith("let go, last switch")


def test_a_session_without_events_ends_in_rest(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    with session(InProcess(live_idle_s=0.2)) as socket:
        told(socket, "version")
        press(socket, x=1)
        assert told(socket, "plan")["command"]["x"]["levels"][-1] == 0.0
        with pytest.raises(Closed) as closed:
            told(socket, "plan")
    assert (closed.value.code, closed.value.reason) == (1000, "no event for 0.2 s")
    (ended,) = stopped(caplog.records)
    assert ended["stopped"].startswith("without swing")
