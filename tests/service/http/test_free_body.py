"""A free body over HTTP: moves by force, pictures, and what is refused."""

from typing import Any

import numpy as np
import pytest

from schemas.maneuvers import ManeuverRequest
from service.operations.maneuver import move_picture
from service.operations.move_file import move_file
from tests.conftest import CRANE
from tests.design.pictures.drawn import line
from tests.refusals import refused
from tests.service.http.in_process import InProcess

BODY: dict[str, Any] = {
    "kind": "free_body",
    "mass_kg": 2.0,
    "modes": [{"natural_frequency_rad_s": 1.4142135623730951}],
}
MOVE: dict[str, Any] = {
    "plant": BODY,
    "actuator": {"kind": "ideal"},
    "shaper": {"kind": "umzv"},
    "force_n": 1.0,
    "distance_m": 1.0,
}


def asked(body: dict[str, Any], path: str = "maneuvers") -> dict[str, Any]:
    document: dict[str, Any] = InProcess().ask("POST", f"/v1/{path}", body).json()
    return document


def test_a_move_by_force_has_its_switches_and_a_bound() -> None:
    move = asked(MOVE)
    assert move["command"]["times_s"] == pytest.approx([0, 1.003, 2.109, 3.215, 4.218], abs=5e-4)
    assert move["command"]["amplitudes"] == [1, -2, 2, -2, 1]
    assert move["distance_m"] == pytest.approx(1.0, rel=1e-12)
    assert move["lower_bound_s"] == pytest.approx(move["duration_s"], rel=1e-9)
    assert move["burn_s"] == move["duration_s"]
    assert "least_burn_s" not in move
    halves = (*move["start"]["amplitudes"], *move["stop"]["amplitudes"])
    assert list(halves) == move["command"]["amplitudes"]


def test_a_longer_move_says_how_shortly_the_force_may_be_on() -> None:
    move = asked({**MOVE, "duration_s": 6.0})
    assert move["duration_s"] == pytest.approx(6.0)
    assert move["least_burn_s"] <= move["burn_s"] < 4.0
    levels = np.round(np.cumsum(move["command"]["amplitudes"]), 12)
    assert set(np.abs(levels)) == {0.0, 1.0}


@pytest.mark.parametrize(
    ("changes", "pointer", "code"),
    [
        ({"speed_m_s": 0.2}, "/speed_m_s", "not_for_free_body"),
        ({"pulse_s": 3.0}, "/pulse_s", "not_for_free_body"),
        ({"joint": True}, "/joint", "not_for_free_body"),
        ({"sample_time_s": 0.01}, "/sample_time_s", "not_for_free_body"),
        ({"force_n": None}, "/force_n", "field_not_given"),
        ({"distance_m": None}, "/distance_m", "field_not_given"),
        ({"actuator": CRANE["actuator"]}, "/actuator/kind", "force_through_drive"),
        ({"shaper": {"kind": "ei"}}, "/shaper/kind", "kind_not_by_force"),
        (
            {"plant": CRANE["plant"], "speed_m_s": 0.2},
            "/force_n",
            "force_on_held_plant",
        ),
        (
            {"plant": {**BODY, "modes": [*BODY["modes"], *BODY["modes"]]}},
            "/plant/modes/1",
            "modes_too_near",
        ),
    ],
)
def test_what_does_not_go_with_a_free_body_is_refused_by_field(
    changes: dict[str, Any], pointer: str, code: str
) -> None:
    (fault, *_) = asked({**MOVE, **changes})["errors"]
    assert (fault["pointer"], fault["code"]) == (pointer, code)


def test_a_plant_that_is_held_needs_a_speed() -> None:
    held = {**CRANE, "distance_m": 0.5}
    (fault,) = asked(held)["errors"]
    assert (fault["pointer"], fault["code"]) == ("/speed_m_s", "field_not_given")


def test_a_duration_below_the_least_is_infeasible() -> None:
    refusal = asked({**MOVE, "duration_s": 4.0})
    assert refusal["type"] == "urn:shapersmith:infeasible"
    assert "4.21786651 s" in refusal["detail"]


@pytest.mark.parametrize("path", ["designs", "simulations", "recommendations"])
def test_other_requests_say_where_a_free_body_is_served(path: str) -> None:
    body = {"plant": BODY, "actuator": {"kind": "ideal"}}
    if path == "designs":
        body["shaper"] = {"kind": "zv"}
    if path == "simulations":
        body["command"] = {"kind": "step"}
    (fault, *_) = asked(body, path)["errors"]
    assert (fault["pointer"], fault["code"]) == ("/plant/kind", "plant_moved_by_force")


def test_blocks_for_controllers_are_refused() -> None:
    with refused("not_for_free_body", "format"):
        move_file(ManeuverRequest.model_validate(MOVE), "st")


def test_the_sheet_draws_force_way_and_vibration() -> None:
    figure = move_picture(ManeuverRequest.model_validate({**MOVE, "distance_m": -1.0}))
    _, force_n = line(figure, "force", "force")
    assert set(force_n) == {-1.0, 0.0, 1.0}
    assert force_n[force_n != 0][0] == -1.0
    times_s, way_m = line(figure, "way", "way")
    assert way_m[times_s > 4.3] == pytest.approx(-1.0, abs=1e-12)
    times_s, mode = line(figure, "modes", "mode-0")
    assert np.abs(mode[times_s > 4.3]).max() <= 1e-9
    assert np.abs(mode).max() > 0.5
