"""The first of the random answers; `tests.acceptance.random_answers` runs more."""

import json
from typing import Any

import numpy as np
import pytest

from service.answers import respond
from service.problems import Problem
from tests.acceptance.random_answers import OPERATIONS, random_move, random_simulation, verdict
from tests.acceptance.random_kinds import report

COUNTS = {"moves": 150, "simulations": 150, "recommendations": 12}


@pytest.mark.parametrize("what", OPERATIONS)
def test_random_answers_are_what_another_route_finds(what: str) -> None:
    found = [verdict(what, number) for number in range(COUNTS[what])]
    assert not any(one.wrong for one in found), "\n".join(report(found))
    assert sum(bool(one.refusal) for one in found) <= 0.2 * len(found)


@pytest.mark.parametrize(
    "spoilt",
    [
        {"residual": 1e-6},
        {"distance_m": 1e-6},
        {"certificate": "given"},
        {"certificate": "ideal"},
        {"warnings": "none"},
    ],
)
def test_a_move_that_is_not_what_it_says_is_told(spoilt: dict[str, Any]) -> None:
    caught = 0
    for number in range(12):
        _, request, faults = random_move(np.random.default_rng([0, number]))
        found = respond("maneuver", json.dumps(request).encode())
        if isinstance(found, Problem):
            continue
        answer = json.loads(found.model_dump_json(by_alias=True))
        assert list(faults(answer)) == []
        (name,) = spoilt
        if name == "certificate":
            same = answer[name]["actuator"] == spoilt[name]
            answer[name]["actuator"] = spoilt[name]
        elif name == "warnings":
            same = not {"actuator_ignored", "program_residual"} & {
                one["code"] for one in answer[name]
            }
            answer[name] = []
        else:
            same = False
            answer[name] += spoilt[name] * (1 if name == "residual" else answer[name])
        caught += not same
        assert same or list(faults(answer)), (number, request)
    assert caught >= 3


def test_a_simulation_without_its_warning_is_told() -> None:
    caught = 0
    for number in range(40):
        _, request, faults = random_simulation(np.random.default_rng([2, number]))
        found = respond("simulation", json.dumps(request).encode())
        if isinstance(found, Problem):
            continue
        answer = json.loads(found.model_dump_json(by_alias=True))
        codes = {one["code"] for one in answer["warnings"]}
        if codes & {"stop_not_designed", "steps_not_designed", "actuator_ignored"}:
            caught += 1
            answer["warnings"] = []
            assert list(faults(answer))
    assert caught >= 5
