"""Which model of a union is meant is asked for by the field's own name, wherever it is missing."""

import copy
import json
from collections.abc import Iterator
from typing import Any

import pytest

from schemas.fields_at import TAGS
from schemas.pointers import json_pointer
from service.dispatch import respond
from service.http.examples import EXAMPLES
from service.operations.table import TABLE
from service.problems import INVALID, Problem

WRONG: list[Any] = ["nonsense", 3, None, [], {}, True]


def tagged(here: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], str]]:
    """Yield where an object has a tag, and which."""
    if isinstance(here, dict):
        yield from ((path, tag) for tag in TAGS if tag in here)
        for name, inner in here.items():
            yield from tagged(inner, (*path, name))
    elif isinstance(here, list):
        for number, inner in enumerate(here):
            yield from tagged(inner, (*path, str(number)))


CASES = [
    (operation, example.value, path, tag)
    for operation, row in TABLE.items()
    for example in EXAMPLES[row.command].values()
    for path, tag in tagged(example.value)
]


def at(body: Any, path: tuple[str, ...]) -> Any:
    """Return the object at a path."""
    for step in path:
        body = body[int(step)] if isinstance(body, list) else body[step]
    return body


def test_both_tags_are_tried() -> None:
    assert {tag for *_, tag in CASES} == set(TAGS)


@pytest.mark.parametrize(("operation", "body", "path", "tag"), CASES)
def test_a_tag_that_is_missing_or_wrong_is_refused_by_its_name(
    operation: str, body: Any, path: tuple[str, ...], tag: str
) -> None:
    for wrong in [..., *WRONG]:
        changed = copy.deepcopy(body)
        del at(changed, path)[tag]
        if wrong is not ...:
            at(changed, path)[tag] = wrong
        problem = respond(operation, json.dumps(changed).encode())
        assert isinstance(problem, Problem)
        assert problem.kind == INVALID
        faults = {fault.pointer: fault.detail for fault in problem.errors}
        pointer = json_pointer(path)
        assert {pointer, f"{pointer}/{tag}"} & faults.keys(), faults
        assert f" {tag}" in "; ".join(faults.values()), faults
