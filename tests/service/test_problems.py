"""Every error has its problem."""

from typing import Any

import pytest

from design.errors import DesignError, InvalidInputError
from service.problems import KIND_OF, Problem, pointer, problem_of_design


def leaves(cls: type[DesignError]) -> set[type[DesignError]]:
    children = cls.__subclasses__()
    return {cls} if not children else set().union(*map(leaves, children))


def test_every_error_of_the_mathematics_has_a_problem() -> None:
    assert leaves(DesignError) == set(KIND_OF)


@pytest.mark.parametrize("error", sorted(KIND_OF, key=str))
def test_an_error_becomes_a_document_with_its_status(error: type[DesignError]) -> None:
    made = InvalidInputError("a.b", 3, "even") if error is InvalidInputError else error("why")
    document = problem_of_design(made).document("id-1")
    assert document.status == KIND_OF[error].http
    assert document.request_id == "id-1"
    assert "why" in document.detail or "/a/b: must be even, got 3" in document.detail


@pytest.mark.parametrize(
    ("location", "body", "expected"),
    [
        (("plant", "mode", "damping_ratio"), {"plant": {"kind": "mode"}}, "/plant/damping_ratio"),
        (("plant", "mode"), {"plant": {"kind": "mode", "mode": 1}}, "/plant/mode"),
        (("modes", 1, "x"), {"modes": [{}, {}]}, "/modes/1/x"),
        (("a", "modes", "modes", 1), {"a": {"kind": "modes", "modes": [{}, {}]}}, "/a/modes/1"),
        (("a", "modes", "x"), {"a": {"kind": "modes", "modes": [{}], "x": 1}}, "/a/x"),
        (("a/b~c",), {}, "/a~1b~0c"),
        ((), {}, ""),
    ],
)
def test_a_pointer_leaves_the_tags_of_unions_out(
    location: tuple[int | str, ...], body: Any, expected: str
) -> None:
    assert pointer(location, body) == expected


def test_a_long_value_is_echoed_in_part() -> None:
    problem: Problem = problem_of_design(InvalidInputError("x", "y" * 1000, "short"))
    assert len(problem.detail) < 150
