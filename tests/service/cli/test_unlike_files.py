"""A file that something else wrote, or of another specification, is called so."""

import io
import json
import re
from pathlib import Path
from typing import Any

import pytest

from design.errors import InvalidInputError
from design.export.reading import NOT_AS_WRITTEN, READERS, rows_of, why_not_read
from design.tables.rows import TableHead
from schemas.tables import Tolerances
from service.cli.checks import MAX_FIELDS_APART, drifts_of_file
from tests.design.export.test_data_files import write

TEXTS = ["csv", "json"]


def refusal(name: str, path: Path, data: bytes) -> str:
    path.write_bytes(data)
    with pytest.raises(InvalidInputError) as refused:
        rows_of(name, io.BytesIO(data))
    return why_not_read(name, path, refused.value)


def as_a_spreadsheet_saves(text: str, separator: str) -> str:
    """Return a file of commas as a spreadsheet saves it: cells quoted anew, another separator."""
    lines = []
    for line in text.splitlines():
        cells = [
            '"' + cell.replace('"', '""') + '"' if '"' in cell else cell for cell in line.split(",")
        ]
        lines.append(separator.join(cells))
    return "\r\n".join(lines)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_file_that_a_spreadsheet_saved_is_called_one_with_the_line(
    tmp_path: Path, separator: str
) -> None:
    text = as_a_spreadsheet_saves(write("csv", 20).decode(), separator)
    told = refusal("csv", tmp_path / "t.csv", text.encode())
    assert told.startswith(
        f"{tmp_path / 't.csv'} is not as shapersmith wrote it; was it saved by a "
    )
    assert re.search(r"spreadsheet\? line \d+: a head with", told)


@pytest.mark.parametrize("name", TEXTS)
def test_each_line_of_a_head_that_is_changed_is_named(tmp_path: Path, name: str) -> None:
    lines = write(name, 20).decode().splitlines(keepends=True)
    first = {"csv": 0, "json": 1}[name]
    for number in range(first, first + 8):
        damaged = [*lines[:number], lines[number].replace(": ", ": x", 1), *lines[number + 1 :]]
        told = refusal(name, tmp_path / f"t.{name}", "".join(damaged).encode())
        assert f"? line {number + 1}: a head with an unreadable " in told


@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize("data", [b"", b"x", b"a;b\n1,5;2\n", b"\x89PNG\r\n\x1a\n\0\0\0"])
def test_any_other_file_is_not_as_shapersmith_wrote_it(
    tmp_path: Path, name: str, data: bytes
) -> None:
    told = refusal(name, tmp_path / f"t.{name}", data)
    if not data:
        assert told.endswith("t.csv is empty: shapersmith wrote no such file".replace("csv", name))
    else:
        assert " is not as shapersmith wrote it; was it saved by " in told
    assert "Expecting" not in told


def test_what_is_not_as_written_has_these_codes() -> None:
    source = "".join(path.read_text() for path in Path("design/export").glob("*.py"))
    assert all(f'code="{code}"' in source for code in NOT_AS_WRITTEN)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"b": 2}, "/b is 1 in the file, 2 now"),
        ({"a": {"c": [1, 2.5]}}, "/a/c/1 is 2 in the file, 2.5 now"),
        ({"a": {"c": [1]}}, "/a/c is [1, 2] in the file, [1] now"),
        ({"d": "x"}, '/d is not there in the file, "x" now'),
        ({f"f{number}": 1 for number in range(8)}, "and 3 more"),
    ],
)
def test_a_file_of_another_specification_names_the_fields_that_differ(
    tmp_path: Path, changed: dict[str, Any], told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    heads = [head_with(one) for one in (SPECIFICATION, {**SPECIFICATION, **changed})]
    monkeypatch.setattr("service.cli.checks.rows_of", lambda *_: (heads[0], iter(())))
    path = tmp_path / "t.csv"
    path.touch()
    drifts = drifts_of_file(path, "csv", heads[1], (), Tolerances())
    (text,) = drifts.told
    assert text.startswith("the file is of another specification: /")
    assert text.endswith(told)
    assert text.count(" in the file, ") == min(len(changed), MAX_FIELDS_APART)


SPECIFICATION = {"a": {"c": [1, 2]}, "b": 1}


def head_with(specification: dict[str, Any]) -> TableHead:
    text = json.dumps(specification)
    return TableHead(
        version="0", specification_json=text, specification_sha256=text, title="t", columns=(),
        rows=0, impulses=0, amplitudes=(),
    )  # fmt: skip
