"""The residual where the drive is off, over HTTP and in Python."""

from typing import Any

import httpx
import pytest

import shapersmith
from tests.conftest import CRANE
from tests.service.http.changed_request import changed


def asked(client: httpx.Client, drive: Any, **more: Any) -> httpx.Response:
    request = changed("/actuator/model", "switched")
    found = client.post("/v1/designs", json=request).json()
    body = {
        "impulses": found["shaper"]["impulses"],
        "plant": request["plant"],
        "actuator": request["actuator"],
        "drive": drive,
    }
    return client.post("/v1/sensitivity", json=body | more)


def test_a_curve_over_the_share_that_a_drive_is_off_is_told(client: httpx.Client) -> None:
    told = asked(client, {}).json()["drive"]
    assert told["off_by"] == pytest.approx([0, 0.1, 0.2])
    assert told["residual"][1:] == pytest.approx([0.0303, 0.0673], rel=0.01)
    assert told["worst_drive"]["accel.damping_ratio"] == pytest.approx(1.2)
    assert "drive" not in asked(client, None).json()


def test_a_design_tells_it_too_where_asked(client: httpx.Client) -> None:
    request = changed("/actuator/model", "switched")
    whole = client.post("/v1/designs", json=request | {"drive": {"to": 0.2}}).json()
    beside = asked(client, {"to": 0.2}).json()
    assert whole["drive"] == beside["drive"]
    assert "drive" not in client.post("/v1/designs", json=request).json()
    ideal = {"drive": {}, "actuator": {"kind": "ideal"}}
    answer = client.post("/v1/designs", json=request | ideal)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/drive"


def test_what_cannot_be_off_is_refused_by_name(client: httpx.Client) -> None:
    answer = asked(client, {}, actuator={"kind": "ideal"})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/drive"
    answer = asked(client, {"to": 0.7})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/drive/to"


def test_python_takes_it_by_name() -> None:
    impulses = shapersmith.Impulses(times_s=[0, 0.5], amplitudes=[0.5, 0.5])
    off = shapersmith.DriveRange(to=0.1, points=2)
    plant, drive = CRANE["plant"], CRANE["actuator"]
    curve = shapersmith.sensitivity(impulses, plant, drive, drive=off).drive
    assert curve is not None
    # Positive impulses are exact behind any drive: only the plant's own part remains.
    assert curve.residual[0] == pytest.approx(curve.residual[1], abs=1e-12)
