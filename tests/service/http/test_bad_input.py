"""Nonsense in, a clear problem out."""

import copy
import json
from typing import Any

import httpx
import pytest

from tests.conftest import CRANE

JSON = {"content-type": "application/json"}
NATURAL = "/actuator/accel/natural_frequency_rad_s"


def changed(pointer: str, value: Any) -> dict[str, Any]:
    """Return the crane with one field set."""
    request = copy.deepcopy(CRANE)
    *path, last = pointer.strip("/").split("/")
    here = request
    for step in path:
        here = here.setdefault(step, {})
    here[last] = value
    return request


FAULTS = [
    pytest.param("/plant/cable_length_m", -0.8, "greater than 0", "out_of_range", id="negative"),
    pytest.param("/plant/cable_length_m", 0, "greater than 0", "out_of_range", id="zero"),
    pytest.param(
        "/plant/cable_length_m", True, "valid number, got True", "wrong_type", id="boolean"
    ),
    pytest.param(
        "/plant/cable_length_m", "0.8", "valid number, got '0.8'", "wrong_type", id="string"
    ),
    pytest.param("/plant/cable_length_m", None, "valid number", "wrong_type", id="null"),
    pytest.param("/plant/cable_length_m", [1], "valid number", "wrong_type", id="list"),
    pytest.param(
        "/plant/damping_ratio", 1, "less than or equal to 0.99", "out_of_range", id="damping-1"
    ),
    pytest.param(
        "/plant/damping_ratio",
        -1e-9,
        "greater than or equal to 0",
        "out_of_range",
        id="damping-below-0",
    ),
    pytest.param(NATURAL, float("nan"), "finite number", "not_finite", id="nan"),
    pytest.param(NATURAL, float("inf"), "finite number", "not_finite", id="infinity"),
    pytest.param(
        "/actuator/decel/damping_ratio",
        9,
        "less than or equal to 5",
        "out_of_range",
        id="actuator-damping",
    ),
    pytest.param(
        "/actuator/model", "other", "'superposed' or 'switched'", "not_one_of", id="model"
    ),
    pytest.param("/plant/colour", "red", "Extra inputs", "extra_forbidden", id="unknown-field"),
    pytest.param("/nonsense", 1, "Extra inputs", "extra_forbidden", id="unknown-top-field"),
    pytest.param(
        "/sensitivity/points", 10**7, "less than or equal to 20001", "out_of_range", id="points"
    ),
    pytest.param(
        "/sensitivity/points", 1, "greater than or equal to 2", "out_of_range", id="one-point"
    ),
    pytest.param(
        "/sensitivity/to_ratio",
        0.4,
        "greater than from_ratio",
        "ratios_reversed",
        id="ratios-reversed",
    ),
    pytest.param("/sensitivity/tolerance", 1, "less than 1", "out_of_range", id="tolerance"),
    pytest.param("/shaper/settle", 1, "valid boolean", "wrong_type", id="settle"),
    pytest.param(
        "/shaper/max_duration_periods",
        1e9,
        "less than or equal to 100",
        "out_of_range",
        id="horizon",
    ),
]


@pytest.mark.parametrize(("pointer", "value", "rule", "code"), FAULTS)
def test_a_fault_is_named_by_field_rule_and_value(
    client: httpx.Client, pointer: str, value: Any, rule: str, code: str
) -> None:
    answer = client.post("/v1/designs", content=json.dumps(changed(pointer, value)), headers=JSON)
    body = answer.json()
    assert (answer.status_code, body["type"]) == (422, "urn:shapersmith:invalid-input")
    assert answer.headers["content-type"] == "application/problem+json"
    assert [fault["pointer"] for fault in body["errors"]] == [pointer]
    assert rule in body["errors"][0]["detail"]
    assert [body["code"], body["errors"][0]["code"]] == [code, code]
    assert body["request_id"] == answer.headers["x-request-id"]


@pytest.mark.parametrize(
    ("pointer", "value", "code"),
    [
        pytest.param("/plant", {"kind": "bridge"}, "unknown_kind", id="kind-of-plant"),
        pytest.param("/plant", {}, "no_kind", id="no-kind"),
        pytest.param("/actuator", {"kind": "hydraulic"}, "unknown_kind", id="kind-of-actuator"),
        pytest.param("/shaper", {"kind": "magic"}, "unknown_kind", id="kind-of-shaper"),
        pytest.param("/shaper", 3, "wrong_type", id="no-object"),
    ],
)
def test_an_unknown_kind_is_named(
    client: httpx.Client, pointer: str, value: Any, code: str
) -> None:
    answer = client.post("/v1/designs", json=changed(pointer, value))
    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]
    assert [fault["code"] for fault in answer.json()["errors"]] == [code]


def test_every_fault_of_a_request_is_told_at_once(client: httpx.Client) -> None:
    request = changed("/plant/damping_ratio", 2)
    del request["shaper"]
    faults = client.post("/v1/designs", json=request).json()["errors"]
    told = {fault["pointer"]: fault["code"] for fault in faults}
    assert told == {"/plant/damping_ratio": "out_of_range", "/shaper": "missing"}


TWO_MODES = {
    "kind": "modes",
    "modes": [{"natural_frequency_rad_s": 3.5}, {"natural_frequency_rad_s": 9.4}],
}


def test_several_modes_are_refused_by_a_shaper_of_one(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", json=changed("/plant", TWO_MODES))
    body = answer.json()
    assert answer.status_code == 422
    assert body["errors"][0]["pointer"] == "/plant/modes"
    assert body["code"] == body["errors"][0]["code"] == "kind_of_one_mode"
    assert "got '2 modes'" in body["detail"]


@pytest.mark.parametrize(
    ("modes", "pointer", "text"),
    [
        ([{"natural_frequency_rad_s": 1.0 + number} for number in range(7)], "/plant/modes", "6"),
        ([], "/plant/modes", "1"),
        ([{"natural_frequency_rad_s": 3.5}] * 2, "/plant/modes/1", "modes so near are one"),
        (
            [{"natural_frequency_rad_s": 1.0}, {"natural_frequency_rad_s": 1001.0}],
            "/plant/modes/1/natural_frequency_rad_s",
            "within 1000 times of modes.0",
        ),
    ],
)
def test_bad_lists_of_modes_are_named(
    client: httpx.Client, modes: list[dict[str, float]], pointer: str, text: str
) -> None:
    request = changed("/shaper", {"kind": "multi_zv"}) | {
        "plant": {"kind": "modes", "modes": modes}
    }
    answer = client.post("/v1/designs", json=request)
    assert answer.status_code == 422
    fault = answer.json()["errors"][0]
    assert fault["pointer"] == pointer
    assert text in fault["detail"]


def test_what_serves_one_mode_says_so_of_several(client: httpx.Client) -> None:
    request = changed("/shaper", {"kind": "multi_umzv", "sample_time_s": 0.01})
    answer = client.post("/v1/designs", json=request | {"plant": TWO_MODES})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/shaper/sample_time_s"
    move = changed("/shaper", {"kind": "multi_umzv"}) | {
        "plant": TWO_MODES,
        "speed_m_s": 0.2,
        "distance_m": 1.0,
    }
    for route in ("/v1/maneuvers",):
        answer = client.post(route, json=move)
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["pointer"] == "/plant/modes"


def test_convolved_commands_beyond_their_range_are_refused_with_their_level(
    client: httpx.Client,
) -> None:
    request = changed("/shaper", {"kind": "convolved", "base": "umzvd"}) | {"plant": TWO_MODES}
    answer = client.post("/v1/designs", json=request)
    assert answer.status_code == 422
    assert answer.json()["type"] == "urn:shapersmith:infeasible"
    assert "from -1 to 2 of full speed, beyond 0 to 1" in answer.json()["detail"]


def test_one_mode_in_a_list_is_served(client: httpx.Client) -> None:
    modes = {"kind": "modes", "modes": [{"natural_frequency_rad_s": 3.5}]}
    assert client.post("/v1/designs", json=changed("/plant", modes)).status_code == 200


def test_a_shaper_that_does_not_serve_the_actuator_is_refused(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", json=changed("/shaper", {"kind": "umzvc"}))
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/actuator/kind"


def test_an_overflowing_number_is_not_finite(client: httpx.Client) -> None:
    text = json.dumps(changed(NATURAL, 12345.5)).replace("12345.5", "1e400")
    answer = client.post("/v1/designs", content=text, headers=JSON)
    assert answer.status_code == 422
    assert answer.json()["errors"] == [
        {
            "pointer": NATURAL,
            "code": "not_finite",
            "detail": "Input should be a finite number, got inf",
        }
    ]


@pytest.mark.parametrize(
    "body",
    [
        pytest.param(b"", id="empty"),
        pytest.param(b"{", id="cut"),
        pytest.param(b"plant: crane", id="yaml"),
        pytest.param(b"[" * 100_000, id="deep-list"),
        pytest.param(b'{"plant":' * 100_000, id="deep-object"),
        pytest.param(b"\xff\xfe\x00", id="not-utf-8"),
        pytest.param(b'{"plant": "\xe9"}', id="latin-1"),
    ],
)
@pytest.mark.parametrize("path", ["/v1/designs", "/v1/sensitivity", "/v1/fits"])
def test_what_is_no_json_is_told_so(client: httpx.Client, path: str, body: bytes) -> None:
    answer = client.post(path, content=body, headers=JSON)
    assert (answer.status_code, answer.json()["type"]) == (400, "urn:shapersmith:not-json")


@pytest.mark.parametrize("body", [b"[]", b"3", b"null", b'"crane"'])
def test_json_that_is_no_object_is_invalid(client: httpx.Client, body: bytes) -> None:
    answer = client.post("/v1/designs", content=body, headers=JSON)
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:shapersmith:invalid-input")


def test_a_body_over_its_limit_is_refused(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", content=b" " * 2_000_000, headers=JSON)
    assert (answer.status_code, answer.json()["type"]) == (413, "urn:shapersmith:too-large")
    assert "1048576 bytes" in answer.json()["detail"]


def test_a_batch_over_its_lines_is_refused(client: httpx.Client) -> None:
    answer = client.post("/v1/designs/batch", content=b"{}\n" * 1001)
    assert (answer.status_code, answer.json()["type"]) == (413, "urn:shapersmith:too-large")


def test_another_media_type_is_refused(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", content=b"<a/>", headers={"content-type": "text/xml"})
    assert (answer.status_code, answer.json()["type"]) == (
        415,
        "urn:shapersmith:unsupported-media-type",
    )


def test_unknown_routes_and_methods_are_problems_too(client: httpx.Client) -> None:
    missing = client.get("/v1/nothing")
    assert (missing.status_code, missing.json()["type"]) == (404, "urn:shapersmith:not-found")
    wrong = client.put("/v1/designs")
    assert (wrong.status_code, wrong.json()["type"]) == (405, "urn:shapersmith:method-not-allowed")
    assert wrong.headers["allow"] == "POST"


def test_an_infeasible_design_says_which_condition_fails(client: httpx.Client) -> None:
    # One lag at the plant's own frequency, so that |G_decel/G_accel| is 2.5 there.
    actuator = {
        "kind": "second_order",
        "accel": {"natural_frequency_rad_s": 1.0, "damping_ratio": 1.25},
        "decel": {"natural_frequency_rad_s": 1000.0, "damping_ratio": 0.5},
    }
    request = {
        "plant": {"kind": "mode", "natural_frequency_rad_s": 1.0},
        "actuator": actuator,
        "shaper": {"kind": "numzv"},
    }
    answer = client.post("/v1/designs", json=request)
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:shapersmith:infeasible")
    assert answer.json()["code"] == "alpha_above_two"
    assert "is 2.5" in answer.json()["detail"]
    assert "alpha <= 2" in answer.json()["detail"]


def test_a_search_without_result_says_how_far_it_went(client: httpx.Client) -> None:
    short = changed("/shaper", {"kind": "numzvd", "max_duration_periods": 0.5})
    answer = client.post("/v1/designs", json=short)
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:shapersmith:infeasible")
    detail = answer.json()["detail"]
    assert "duration <= 0.5 periods in 1026 starts" in detail
    assert "nearest miss" in detail


@pytest.mark.parametrize(
    ("fit", "pointer"),
    [
        pytest.param({"from": 1, "to": 2, "degree": 2}, "/fit/over", id="no-field"),
        pytest.param(
            {"over": "/plant/natural_frequency_rad_s", "from": 1, "to": 2, "degree": 2},
            "/fit/over",
            id="not-of-this-plant",
        ),
        pytest.param(
            {"over": "/plant/cable_length_m", "from": 2, "to": 1, "degree": 2},
            "/fit/to",
            id="reversed",
        ),
        pytest.param(
            {"over": "/plant/cable_length_m", "from": 1, "to": 2}, "/fit/degree", id="none"
        ),
        pytest.param(
            {"over": "/plant/cable_length_m", "from": 1, "to": 2, "degree": 21},
            "/fit/degree",
            id="degree",
        ),
        pytest.param(
            {"over": "/plant/cable_length_m", "from": 0, "to": 2, "degree": 2},
            "/fit/from",
            id="from-zero",
        ),
        pytest.param(
            {"over": "/plant/damping_ratio", "from": 0, "to": 1, "degree": 2},
            "/fit/to",
            id="beyond-the-field",
        ),
    ],
)
@pytest.mark.parametrize("path", ["/v1/designs", "/v1/fits"])
def test_a_faulty_fit_is_named(
    client: httpx.Client, path: str, fit: dict[str, Any], pointer: str
) -> None:
    answer = client.post(path, json={**CRANE, "fit": fit})
    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]


@pytest.mark.parametrize(
    ("impulses", "pointer"),
    [
        pytest.param({"times_s": [0, 1], "amplitudes": [1]}, "/impulses/amplitudes", id="lengths"),
        pytest.param({"times_s": [0, -1], "amplitudes": [1, 1]}, "/impulses/times_s/1", id="back"),
        pytest.param({"times_s": [], "amplitudes": []}, "/impulses/times_s", id="empty"),
        pytest.param({"times_s": [0], "amplitudes": [0]}, "/impulses/amplitudes", id="all-zero"),
    ],
)
def test_faulty_impulses_are_named(
    client: httpx.Client, impulses: dict[str, Any], pointer: str
) -> None:
    request = {"impulses": impulses, "plant": CRANE["plant"], "actuator": CRANE["actuator"]}
    answer = client.post("/v1/sensitivity", json=request)
    assert answer.status_code == 422
    assert pointer in [fault["pointer"] for fault in answer.json()["errors"]]


def test_a_fit_behind_a_real_actuator_is_judged_there(client: httpx.Client) -> None:
    fit = {"over": "/plant/cable_length_m", "from": 0.75, "to": 0.85, "degree": 2}
    request = {**CRANE, "shaper": {"kind": "umzvd"}, "fit": fit}
    body = client.post("/v1/designs", json=request).json()
    # A shaper that knows no actuator leaves much there, however good its fit.
    assert body["fit"]["worst_residual"] >= body["residual"] > 0.02


def test_extremes_within_the_rules_are_finite_or_refused(client: httpx.Client) -> None:
    for amplitude, low, high in ((1e12, 1e-6, 1e6), (1e-12, 0.5, 1.5), (1.0, 1e-6, 1e-5)):
        request = {
            "impulses": {"times_s": [0, 1e-9, 5e4], "amplitudes": [amplitude, 0, amplitude]},
            "plant": CRANE["plant"],
            "actuator": CRANE["actuator"],
            "from_ratio": low,
            "to_ratio": high,
        }
        answer = client.post("/v1/sensitivity", json=request)
        assert answer.status_code == 200
        told = answer.json()
        assert None not in [told["residual"], *told["sensitivity"]["residual"]]


def test_many_faults_are_told_in_part(client: httpx.Client) -> None:
    request = {**CRANE, **{f"field_{n}": n for n in range(5000)}}
    answer = client.post("/v1/designs", json=request)
    assert len(answer.json()["errors"]) == 20
    assert "and 4980 more" in answer.json()["detail"]
    long_kind = client.post("/v1/designs", json=changed("/plant", {"kind": "x" * 100_000}))
    assert len(long_kind.content) < 3000


def test_an_empty_batch_is_no_json(client: httpx.Client) -> None:
    assert client.post("/v1/designs/batch", content=b"\n\n").status_code == 400


@pytest.mark.parametrize(
    ("then", "pointer"),
    [
        (
            {
                "kind": "first_order",
                "accel_time_constant_s": 0.1,
                "decel_time_constant_s": 1e4,
            },
            "/actuator/then/decel_time_constant_s",
        ),
        (
            {
                "kind": "second_order",
                "accel": {"natural_frequency_rad_s": 1e-3, "damping_ratio": 1},
                "decel": {"natural_frequency_rad_s": 20, "damping_ratio": 1},
            },
            "/actuator/then/accel",
        ),
    ],
)
def test_a_set_behind_limits_is_pointed_at_where_it_is(
    client: httpx.Client, then: dict[str, Any], pointer: str
) -> None:
    limited = {
        "kind": "rate_limited",
        "accel_limit_m_s2": 1.0,
        "decel_limit_m_s2": 1.0,
        "speed_m_s": 0.1,
        "then": then,
    }
    answer = client.post("/v1/designs", json={**CRANE, "actuator": limited})
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]


SENSITIVITY = {
    "plant": CRANE["plant"],
    "actuator": CRANE["actuator"],
    "impulses": {"times_s": [0, 0.9], "amplitudes": [0.5, 0.5]},
}
TABLE = {"design": CRANE, "axes": [{"field": "/plant/cable_length_m", "values": [0.7, 0.8]}]}


@pytest.mark.parametrize(
    ("path", "request_", "outer", "name", "pointer"),
    [
        ("/v1/designs", CRANE, '"shaper": {', '"kind": "umzv"', "/shaper/kind"),
        ("/v1/designs", CRANE, '"accel": {', '"damping_ratio": 1', "/actuator/accel/damping_ratio"),
        ("/v1/sensitivity", SENSITIVITY, "{", '"plant": {}', "/plant"),
        ("/v1/sensitivity", SENSITIVITY, '"impulses": {', '"times_s": 1', "/impulses/times_s"),
        ("/v1/tables", TABLE, '"axes": [{', '"field": ""', "/axes/0/field"),
    ],
)
def test_a_name_given_twice_is_refused_by_its_pointer(
    client: httpx.Client,
    path: str,
    request_: dict[str, Any],
    outer: str,
    name: str,
    pointer: str,
) -> None:
    text = json.dumps(request_)
    assert outer in text
    repeated = text.replace(outer, f"{outer}{name}, ", 1)
    assert client.post(path, content=text, headers=JSON).is_success
    answer = client.post(path, content=repeated, headers=JSON)
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:shapersmith:invalid-input")
    assert answer.json()["errors"] == [
        {"pointer": pointer, "code": "name_repeated", "detail": "must be given once"}
    ]


def test_a_name_given_twice_in_a_line_of_a_batch_spoils_that_line_alone(
    client: httpx.Client,
) -> None:
    line = json.dumps(CRANE)
    twice = line.replace('"shaper": {', '"shaper": {"kind": "umzv", ', 1)
    told = client.post("/v1/designs/batch", content=f"{line}\n{twice}\n{line}\n").text.splitlines()
    problem = json.loads(told[1])
    assert problem["errors"] == [
        {"pointer": "/shaper/kind", "code": "name_repeated", "detail": "must be given once"}
    ]
    assert told[0] == told[2]


@pytest.mark.parametrize("name", ["a.b", "a/b", "~", "m~n", "", "0", "a.b/c~d"])
def test_names_of_any_letters_are_pointed_at(client: httpx.Client, name: str) -> None:
    escaped = name.replace("~", "~0").replace("/", "~1")
    answer = client.post("/v1/designs", json=changed("/plant", {**CRANE["plant"], name: 1}))
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [f"/plant/{escaped}"]
    for value in (1.0, "x"):
        table = {"design": CRANE, "designs": [{"plant": {name: value}}]}
        answer = client.post("/v1/tables", json=table)
        pointers = [fault["pointer"] for fault in answer.json()["errors"]]
        assert pointers == [f"/designs/0/plant/{escaped}"]


def test_a_number_of_many_digits_is_named(client: httpx.Client) -> None:
    text = json.dumps(changed(NATURAL, 12345.5)).replace("12345.5", "1" * 4000)
    answer = client.post("/v1/designs", content=text, headers=JSON)
    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [NATURAL]


@pytest.mark.parametrize(
    ("command", "pointer"),
    [
        (
            {"kind": "impulses", "impulses": {"times_s": [1, 0], "amplitudes": [1, 1]}},
            "/command/impulses/times_s/1",
        ),
        (
            {"kind": "impulses", "impulses": {"times_s": [0, 0], "amplitudes": [1, -1]}},
            "/command/impulses/amplitudes",
        ),
        (
            {"kind": "list", "times_s": [0, 1], "velocity_m_s": [0.1, 1e300]},
            "/command/velocity_m_s/1",
        ),
        (
            {"kind": "list", "times_s": [0, 1e300], "velocity_m_s": [0.1, 1]},
            "/command/times_s/1",
        ),
        (
            {"kind": "list", "times_s": [0, 0], "velocity_m_s": [0.1, 0]},
            "/command/velocity_m_s",
        ),
        (
            {"kind": "sampled", "sample_time_s": 0.1, "velocity_m_s": [1e13]},
            "/command/velocity_m_s/0",
        ),
    ],
)
def test_a_faulty_command_is_named_in_the_request(
    client: httpx.Client, command: dict[str, Any], pointer: str
) -> None:
    request = {"plant": CRANE["plant"], "actuator": CRANE["actuator"], "command": command}
    answer = client.post("/v1/simulations", json=request)
    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == [pointer]
