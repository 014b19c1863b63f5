"""What docs/python.md says of functions and errors is what there is."""

import inspect
import re
from pathlib import Path

import shapersmith
from service.operations.table import TABLE
from shapersmith.errors import ShapersmithError
from shapersmith.here import HERE
from tests.shapersmith.requests import REQUESTS, call

PAGE = (Path(__file__).parents[2] / "docs" / "python.md").read_text()


def test_a_row_of_the_page_is_a_function_with_its_route_and_fields() -> None:
    rows = dict(re.findall(r"^\| (`\w+`) \| `POST ([\w/]+)` \|.*\|$", PAGE, re.MULTILINE))
    calls = {f"`{call(HERE, name).__name__}`": row.path for name, row in TABLE.items()}
    assert rows == calls
    for operation in REQUESTS:
        called = call(HERE, operation)
        (row,) = re.findall(rf"^\| `{called.__name__}` \|.*\| (.*)\|$", PAGE, re.MULTILINE)
        answer = getattr(shapersmith, inspect.signature(called).return_annotation.__name__)
        for field in re.findall(r"`(\w+)(?:\(\))?`", row):
            assert hasattr(answer, field), field
        assert ("plot" in row) == hasattr(answer, "plot")


def test_each_class_of_errors_is_on_the_page() -> None:
    classes = set(re.findall(r"^\| `(\w+Error)` \|", PAGE, re.MULTILINE))
    public = {
        name
        for name in shapersmith.__all__
        if isinstance(getattr(shapersmith, name), type)
        and issubclass(getattr(shapersmith, name), ShapersmithError)
    }
    assert classes == public - {"ShapersmithError"}
