"""Recommendations over HTTP and on the command line."""

import csv
import io
import json
import math
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE
from tests.service.cli.commands import shapersmith, shapersmith_apart

JSON = {"content-type": "application/json"}
ASKED: dict[str, Any] = {
    "plant": CRANE["plant"],
    "actuator": CRANE["actuator"],
    "half_width": 0.18,
    "max_duration_s": 1.8,
}


def test_the_fastest_is_recommended_with_its_runners_up_and_reasons(client: httpx.Client) -> None:
    answer = client.post("/v1/recommendations", json=ASKED)
    assert answer.status_code == 200
    body = answer.json()
    best = body["recommended"]
    assert (best["name"], best["shaper"]) == ("num_si", {"kind": "num_si", "half_width": 0.18})
    assert best["duration_s"] == pytest.approx(1.3174919, abs=1e-6)
    assert best["meets_all"]
    further = {one["name"]: one for one in body["runners_up"]}
    assert {"si", "ei"} <= set(further)
    assert further["si"]["lower_bound_s"] <= further["si"]["duration_s"]
    durations = [one["duration_s"] for one in (best, *body["runners_up"])]
    assert durations == sorted(durations)
    told = {one["name"]: one for one in body["others"]}
    (missed,) = [one for one in told["numzvd"]["requirements"] if not one["met"]]
    assert missed["requirement"] == "tolerance"
    assert missed["value"] == told["numzvd"]["worst_residual"] > missed["limit"] == 0.05
    assert "has a residual of up to 10.4 %" in missed["reason"]
    assert (
        "serves no actuator of kind second_order"
        in {one["name"]: one["reason"] for one in body["refused"]}["umzvc"]
    )
    assert body["band"] == {"lower_ratio": 1 - 0.18, "upper_ratio": 1 + 0.18}
    assert client.post("/v1/recommendations", json=ASKED).content == answer.content


def test_each_candidate_is_what_a_design_of_it_is(client: httpx.Client) -> None:
    request = {
        "plant": {
            "kind": "mode",
            "natural_frequency_rad_s": 2 * math.pi * 45,
            "damping_ratio": 0.06,
        },
        "actuator": {"kind": "ideal"},
        "lower_ratio": 0.9,
        "upper_ratio": 1.2,
        "damping": {"from": 0.05, "to": 0.1},
        "sample_time_s": 0.0005,
        "tolerance": 0.1,
    }
    body = client.post("/v1/recommendations", json=request).json()
    (mode,) = body["designed_for"]
    for one in (body["recommended"], *body["runners_up"], *body["others"]):
        asked = {
            "plant": {"kind": "mode", **mode},
            "actuator": request["actuator"],
            "shaper": one["shaper"],
            "sensitivity": None,
        }
        design = client.post("/v1/designs", json=asked).json()
        assert design["shaper"]["impulses"] == one["impulses"], one["name"]
        # Its own tolerance on samples is not what was asked: a verdict says how that is kept.
        own = [told for told in design["warnings"] if told["code"] != "tolerance_not_kept"]
        assert own == one["warnings"]


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"half_width": 1.2}, "/half_width", "out_of_range"),
        (
            {"half_width": None, "lower_ratio": -0.1, "upper_ratio": 1.1},
            "/lower_ratio",
            "out_of_range",
        ),
        ({"half_width": None, "lower_ratio": 0.9}, "/upper_ratio", "band_half_said"),
        ({"tolerance": 1.0}, "/tolerance", "out_of_range"),
        ({"tolerance": "0.05"}, "/tolerance", "wrong_type"),
        ({"tolerance": float("nan")}, "/tolerance", "not_finite"),
        ({"max_duration_s": 0}, "/max_duration_s", "out_of_range"),
        ({"sign": "negative"}, "/sign", "not_one_of"),
        (
            {"damping": {"from": 0.1, "to": 0.2}},
            "/plant/damping_ratio",
            "damping_outside_its_range",
        ),
        ({"damping": {"from": 0.0}}, "/damping/to", "missing"),
        ({"damping": {"from": 0.1, "to": 0.0}}, "/damping/to", "range_below_start"),
        ({"highest_command": 0.5}, "/highest_command", "out_of_range"),
        ({"nonsense": 1}, "/nonsense", "extra_forbidden"),
        (
            {"plant": {"kind": "modes", "modes": [{"natural_frequency_rad_s": 3.5}] * 2}},
            "/plant/modes/1",
            "modes_too_near",
        ),
    ],
)
def test_nonsense_is_refused_by_name(
    client: httpx.Client, change: dict[str, Any], pointer: str, code: str
) -> None:
    answer = client.post(
        "/v1/recommendations", content=json.dumps({**ASKED, **change}), headers=JSON
    )
    body = answer.json()
    assert (answer.status_code, body["type"]) == (422, "urn:shapersmith:invalid-input")
    assert [fault["pointer"] for fault in body["errors"]] == [pointer]
    assert [fault["code"] for fault in body["errors"]] == [code]


def test_limits_that_nothing_meets_name_the_nearest(client: httpx.Client) -> None:
    answer = client.post("/v1/recommendations", json={**ASKED, "max_duration_s": 1.0})
    body = answer.json()
    assert (answer.status_code, body["type"]) == (422, "urn:shapersmith:infeasible")
    nearest = {fault["pointer"]: fault["detail"] for fault in body["errors"]}
    assert set(nearest) == {"/tolerance", "/max_duration_s"}
    assert "takes 1.317 s, num_si" in nearest["/max_duration_s"]
    assert nearest["/tolerance"] in body["detail"]


def test_a_drive_that_rings_within_the_ranges_leaves_null_and_says_so(
    client: httpx.Client,
) -> None:
    request = {
        "plant": {"kind": "mode", "natural_frequency_rad_s": 3.5, "damping_ratio": 0.1},
        "actuator": {
            "kind": "second_order",
            "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
            "decel": {"natural_frequency_rad_s": 3.6, "damping_ratio": 0.15},
        },
        "damping": {"from": 0.05, "to": 0.2},
        "half_width": 0.1,
    }
    body = client.post("/v1/recommendations", json=request).json()
    assert all(amplitude > 0 for amplitude in body["recommended"]["impulses"]["amplitudes"])
    (umzv,) = [one for one in body["others"] if one["name"] == "umzv"]
    assert umzv["worst_residual"] is None
    reason = umzv["requirements"][0]["reason"]
    assert reason.startswith(
        "has a residual without bound, as the decelerating set resonates there, from 0.9"
    )


def test_the_command_prints_what_the_service_answers(client: httpx.Client) -> None:
    told = shapersmith_apart("recommend", "-", given=ASKED)
    assert (told.returncode, told.stderr) == (0, "")
    assert json.loads(told.stdout) == client.post("/v1/recommendations", json=ASKED).json()
    refused = shapersmith("recommend", "-", given={**ASKED, "max_duration_s": 1.0})
    assert (refused.returncode, refused.stdout) == (3, "")
    assert refused.stderr.startswith("shapersmith: infeasible: none of ")
    assert refused.stderr.count("\n") == 1


def test_the_table_ranks_and_says_what_each_misses() -> None:
    table = shapersmith("recommend", "-", "--format", "table", given=ASKED).stdout
    lines = table.splitlines()
    assert lines[0].split()[:3] == ["rank", "shaper", "duration_s"]
    assert lines[1].split()[:3] == ["1", "num_si", "1.317"]
    assert any(line.startswith("-") and line.endswith("tolerance") for line in lines)
    assert "why         num_si is the fastest of " in table
    assert "refused     umzvc: serves no actuator" in table
    text = shapersmith("recommend", "-", "--format", "csv", given=ASKED).stdout
    rows = list(csv.DictReader(io.StringIO(text)))
    meeting = [row for row in rows if row["rank"] != "-"]
    assert [row["rank"] for row in meeting] == [str(n) for n in range(1, len(meeting) + 1)]
    assert all(row["misses"] for row in rows[len(meeting) :])
    assert float(rows[0]["duration_s"]) == pytest.approx(1.3174918952, abs=1e-9)


def test_a_firmware_is_answered_with_its_lines_and_others_have_none(client: httpx.Client) -> None:
    printer = {"kind": "mode", "natural_frequency_hz": 45, "damping_ratio": 0.06}
    request = {"plant": printer, "actuator": {"kind": "ideal"}, "half_width": 0.3}
    plain = client.post("/v1/recommendations", json=request)
    assert b"firmware" not in plain.content
    answer = client.post("/v1/recommendations", json={**request, "firmware": "klipper"}).json()
    assert "[input_shaper]" in answer["firmware_lines"]
    verdicts = [one["requirement"] for one in answer["recommended"]["requirements"]]
    assert verdicts[-1] == "firmware"
    text = shapersmith("recommend", "-", "--format", "table", given={**request, "firmware": "rrf"})
    assert text.stdout.splitlines()[-2].startswith('M593 P"custom" H')
    wrong = client.post("/v1/recommendations", json={**request, "firmware": "kliper"}).json()
    assert wrong["errors"][0]["pointer"] == "/firmware"
    assert wrong["errors"][0]["detail"].endswith("; did you mean klipper?")
