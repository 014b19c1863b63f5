"""Live sessions of a real service, by a client of another maker."""

import json
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from tests.conftest import Running, running_service
from tests.patience import PATIENT_S
from tests.processes import until
from tests.service.http.test_live_routes import LIVE


def opened(service: Running, **more: Any) -> ClientConnection:
    socket: ClientConnection = connect(
        f"ws://127.0.0.1:{service.port}/v1/live",
        open_timeout=PATIENT_S,
        ping_interval=None,
        proxy=None,
        **more,
    )
    return socket


def told(socket: ClientConnection, name: str) -> Any:
    while True:
        message = json.loads(socket.recv(PATIENT_S))
        if name in message:
            return message[name]


def ended(service: Running) -> list[dict[str, Any]]:
    lines = [json.loads(line) for line in service.log.read_text().splitlines()]
    return [line for line in lines if line.get("logger") == "shapersmith.live"]


def test_a_crane_is_driven_and_stops_when_its_client_vanishes(service: Running) -> None:
    before = len(ended(service))
    with opened(service) as socket:
        socket.send(json.dumps(LIVE))
        told(socket, "version")
        socket.send('{"direction": {"x": 1}}')
        plan = told(socket, "plan")
        assert plan["certificate"]["verified"]
        while told(socket, "state")["at_s"] < plan["at_s"] + 0.2:
            continue
        assert told(socket, "state")["x"]["position_m"] > 0
        socket.socket.shutdown(2)
    (end,) = until(lambda: ended(service)[before:], "the session did not end")
    assert end["why"] == "the client is gone"
    assert end["stopped"].startswith("without swing, last switch")


def test_a_service_that_ends_says_so(tmp_path: Any) -> None:
    with running_service(tmp_path / "log", job_workers=0, workers=1) as service:
        with opened(service) as socket:
            socket.send(json.dumps(LIVE))
            told(socket, "version")
            service.process.terminate()
            with pytest.raises(ConnectionClosed) as closed:
                told(socket, "plan")
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code in (1001, 1012)
        assert service.process.wait(PATIENT_S) == 0


def test_a_message_beyond_the_largest_body_ends_the_session(service: Running) -> None:
    with opened(service) as socket:
        socket.send(json.dumps(LIVE | {"padding": "x" * 2**20}))
        with pytest.raises(ConnectionClosed) as closed:
            told(socket, "version")
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1009


def test_a_page_of_another_site_gets_a_problem_document(service: Running) -> None:
    with pytest.raises(InvalidStatus) as refused:
        opened(service, origin="http://elsewhere.example")
    response = refused.value.response
    assert response.status_code == 403
    assert json.loads(response.body)["type"] == "urn:shapersmith:forbidden"
