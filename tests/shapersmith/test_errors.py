"""Errors carry what the problem document carries."""

import json
import pickle

import pytest

import shapersmith
from service.dispatch import respond
from service.problems import KIND_OF, Problem
from shapersmith.errors import CLASS_OF
from tests.conftest import CRANE

HEAVY = {"kind": "mode", "natural_frequency_rad_s": 3.5, "damping_ratio": 0.9}
"""Too damped for humps."""

REFUSED = {
    "a field": {**CRANE, "plant": {**CRANE["plant"], "cable_length_m": -1}},
    "a rule of two": {**CRANE, "shaper": {"kind": "ei", "sample_tolerance": 0.1}},
    "a shaper that there is not": {**CRANE, "plant": HEAVY, "shaper": {"kind": "um_ei"}},
}


@pytest.mark.parametrize("request_", REFUSED.values(), ids=REFUSED)
def test_an_error_is_the_problem_document(request_: dict[str, object]) -> None:
    problem = respond("design", json.dumps(request_).encode())
    assert isinstance(problem, Problem)
    with pytest.raises(shapersmith.ShapersmithError) as caught:
        shapersmith.design(**request_)  # type: ignore[arg-type]
    error = caught.value
    assert error.document == problem.document()
    assert type(error) is CLASS_OF[problem.kind.name]
    assert (str(error), error.detail) == (problem.detail, problem.detail)
    assert (error.code, error.errors) == (problem.document().code, problem.errors)
    assert error.trace == []


def test_every_error_of_the_mathematics_has_its_class() -> None:
    assert {kind.name for kind in KIND_OF.values()} <= set(CLASS_OF)
    assert len({CLASS_OF[kind.name] for kind in KIND_OF.values()}) == len(KIND_OF)


def test_an_error_is_pickled() -> None:
    with pytest.raises(shapersmith.InvalidInputError) as caught:
        shapersmith.Mode(natural_frequency_rad_s=-1.0)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.code, str(again)) == (caught.value.code, str(caught.value))
