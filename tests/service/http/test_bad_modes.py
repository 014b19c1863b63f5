"""Several modes: what serves one says so, and bad lists are named."""

import httpx
import pytest

from tests.service.http.changed_request import changed

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


@pytest.mark.parametrize(
    ("modes", "pointer", "code"),
    [
        (
            [{"natural_frequency_rad_s": 1.0 + number} for number in range(7)],
            "/plant/modes",
            "too_long",
        ),
        ([], "/plant/modes", "too_short"),
        ([{"natural_frequency_rad_s": 3.5}] * 2, "/plant/modes/1", "modes_too_near"),
        (
            [{"natural_frequency_rad_s": 1.0}, {"natural_frequency_rad_s": 1001.0}],
            "/plant/modes/1/natural_frequency_rad_s",
            "modes_too_far",
        ),
    ],
)
def test_bad_lists_of_modes_are_named(
    client: httpx.Client, modes: list[dict[str, float]], pointer: str, code: str
) -> None:
    request = changed("/shaper", {"kind": "multi_zv"}) | {
        "plant": {"kind": "modes", "modes": modes}
    }
    answer = client.post("/v1/designs", json=request)
    assert answer.status_code == 422
    fault = answer.json()["errors"][0]
    assert fault["pointer"] == pointer
    assert fault["code"] == code


def test_what_serves_one_mode_says_so_of_several(client: httpx.Client) -> None:
    request = changed("/shaper", {"kind": "convolved", "base": "umzv", "sample_time_s": 0.01})
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
    assert answer.json()["code"] == "convolved_beyond_full_speed"
    assert "from -1 to 2 of full speed, beyond 0 to 1" in answer.json()["detail"]


def test_one_mode_in_a_list_is_served(client: httpx.Client) -> None:
    modes = {"kind": "modes", "modes": [{"natural_frequency_rad_s": 3.5}]}
    assert client.post("/v1/designs", json=changed("/plant", modes)).status_code == 200


def test_a_shaper_that_does_not_serve_the_actuator_is_refused(client: httpx.Client) -> None:
    answer = client.post("/v1/designs", json=changed("/shaper", {"kind": "umzvc"}))
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/actuator/kind"
