"""The first of the random answers; `tests.acceptance.random_answers` runs more."""

import json
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from service.dispatch import respond
from service.problems import Problem
from tests.acceptance.random_answers import OPERATIONS, generator, verdict
from tests.acceptance.random_kinds import report

COUNTS = {"moves": 150, "simulations": 150, "recommendations": 12}


@pytest.mark.parametrize("what", COUNTS)
def test_random_answers_are_what_another_route_finds(what: str) -> None:
    found = [verdict(what, number) for number in range(COUNTS[what])]
    assert not any(one.wrong for one in found), "\n".join(report(found))
    assert sum(bool(one.refusal) for one in found) <= 0.2 * len(found)


def answers(what: str, count: int) -> Iterator[tuple[Any, Callable[[Any], Iterator[str]]]]:
    """Yield the first answers that are none of a problem, each with what finds its faults."""
    operation, drawn = OPERATIONS[what]
    for number in range(count):
        _, request, faults = drawn(generator(what, number))
        found = respond(operation, json.dumps(request).encode())
        if not isinstance(found, Problem):
            yield json.loads(found.model_dump_json(by_alias=True)), faults


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
    for answer, faults in answers("moves", 12):
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
        assert same or list(faults(answer))
    assert caught >= 3


def test_a_simulation_without_its_warning_is_told() -> None:
    caught = 0
    for answer, faults in answers("simulations", 40):
        codes = {one["code"] for one in answer["warnings"]}
        if codes & {"stop_not_designed", "steps_not_designed", "actuator_ignored"}:
            caught += 1
            answer["warnings"] = []
            assert list(faults(answer))
    assert caught >= 5
