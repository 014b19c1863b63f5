"""Every error has its problem."""

import pickle
from typing import Any, get_args

import pytest
from pydantic_core.core_schema import ErrorType

from design.errors import DesignError, InvalidInputError
from schemas.problems import FieldFault
from service.given_names import pointer
from service.problems import (
    CODE_OF_TYPE,
    KIND_OF,
    OVERLOADED,
    Problem,
    invalid_fields,
    problem_of_design,
)
from service.repeated_names import RepeatedNameError
from service.strict_json import loads


def leaves(cls: type[DesignError]) -> set[type[DesignError]]:
    children = cls.__subclasses__()
    return {cls} if not children else set().union(*map(leaves, children))


def test_every_error_of_the_mathematics_has_a_problem() -> None:
    assert leaves(DesignError) == set(KIND_OF)


@pytest.mark.parametrize("error", sorted(KIND_OF, key=str))
def test_an_error_becomes_a_document_with_its_status(error: type[DesignError]) -> None:
    made = (
        InvalidInputError("a.b", 3, "even", "odd")
        if error is InvalidInputError
        else error("why", "odd")
    )
    document = problem_of_design(made).document("id-1")
    assert document.status == KIND_OF[error].http
    assert (document.code, document.request_id) == ("odd", "id-1")
    assert [fault.code for fault in document.errors] == ["odd"] * len(document.errors)
    assert "why" in document.detail or "/a/b: must be even, got 3" in document.detail


@pytest.mark.parametrize(
    ("location", "body", "expected"),
    [
        (("plant", "mode", "damping_ratio"), {"plant": {"kind": "mode"}}, "/plant/damping_ratio"),
        (("plant", "mode"), {"plant": {"kind": "mode", "mode": 1}}, "/plant/mode"),
        (("modes", 1, "x"), {"modes": [{}, {}]}, "/modes/1/x"),
        (("a", "modes", "modes", 1), {"a": {"kind": "modes", "modes": [{}, {}]}}, "/a/modes/1"),
        (("a", "modes", "x"), {"a": {"kind": "modes", "modes": [{}], "x": 1}}, "/a/x"),
        (("initial", "AngleSwingIn", "rate"), {"initial": {"angle_rad": 1}}, "/initial/rate"),
        (("initial", "AngleSwingIn"), {"initial": 3}, "/initial"),
        (("initial", "AngleSwingIn"), {"initial": [3]}, "/initial"),
        (("a/b~c",), {}, "/a~1b~0c"),
        ((), {}, ""),
    ],
)
def test_a_pointer_leaves_the_tags_of_unions_out(
    location: tuple[int | str, ...], body: Any, expected: str
) -> None:
    assert pointer(location, body) == expected


@pytest.mark.parametrize(
    ("name", "pointer", "dotted"),
    [
        ("plant.modes.1.damping_ratio", "/plant/modes/1/damping_ratio", "plant.modes.1"),
        (("designs", "0", "plant", "a.b"), "/designs/0/plant/a.b", "designs.0.plant.a.b"),
        (("designs", "0", "a/b~c"), "/designs/0/a~1b~0c", "designs.0.a/b~c"),
        (("", "x"), "//x", ".x"),
    ],
)
def test_a_name_that_somebody_chose_is_pointed_at_whatever_it_holds(
    name: str | tuple[str, ...], pointer: str, dotted: str
) -> None:
    error = pickle.loads(pickle.dumps(InvalidInputError(name, 1, "2", "one").within("outer.0")))
    (fault,) = problem_of_design(error).errors
    assert fault.pointer == f"/outer/0{pointer}"
    assert str(error).startswith(f"outer.0.{dotted}")


@pytest.mark.parametrize(
    ("text", "pointer"),
    [
        ('{"a": 1, "a": 2}', "/a"),
        ('{"a": 1, "b": {"c": 1, "c": 1}}', "/b/c"),
        ('[{"x": 1}, [{"y/z~": 1, "y/z~": {}}]]', "/1/0/y~1z~0"),
        ('{"": 1, "b": 2, "": 3}', "/"),
        ('{"a": {"x": 1, "x": 1}, "b": 1, "b": 2}', "/b"),  # the outer first
        ('{"\\u0061": 1, "a": 2}', "/a"),
    ],
)
def test_a_name_that_stands_twice_is_found(text: str, pointer: str) -> None:
    with pytest.raises(RepeatedNameError, match="must be given once") as caught:
        loads(text)
    assert caught.value.pointer == pointer
    with pytest.raises(RepeatedNameError):
        loads(text.encode())


def test_names_in_different_objects_are_different() -> None:
    loads('{"a": {"a": [{"a": 1}, {"a": 1}]}, "A": 1}')
    assert loads('{"a": 1}') == {"a": 1}
    with pytest.raises(ValueError, match="NaN is no JSON number"):
        loads('{"a": NaN}')


def test_a_problem_has_the_code_that_its_faults_have_in_common_or_that_of_its_kind() -> None:
    one, other = (FieldFault(pointer="/x", code=code, detail="") for code in ("missing", "odd"))
    assert invalid_fields("", (one, one)).document().code == "missing"
    assert invalid_fields("", (one, other)).document().code == "invalid_input"
    assert Problem(OVERLOADED, "").document().code == "overloaded"


def test_the_table_of_codes_knows_only_types_that_there_are() -> None:
    assert set(CODE_OF_TYPE) <= set(get_args(ErrorType))


def test_a_long_value_is_echoed_in_part() -> None:
    problem: Problem = problem_of_design(InvalidInputError("x", "y" * 1000, "short", "long"))
    assert len(problem.detail) < 150
