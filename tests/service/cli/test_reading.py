"""Lists of designs beside a specification: each fault is refused by its code."""

from pathlib import Path

import pytest

from service.cli.reading import ReadingError, read_source


@pytest.mark.parametrize(
    ("name", "listed", "code"),
    [
        ("d.csv", b"/plant/cable_length_m\n0.6\n0.7,1\n", "cells_unlike_headings"),
        ("d.csv", b"/plant/cable_length_m\nlong\n", "cell_not_finite"),
        ("d.csv", b"/plant/cable_length_m\ninf\n", "cell_not_finite"),
        ("d.csv", b"length\n0.6\n", "heading_not_pointer"),
        ("d.csv", b"/plant/a,/plant/a\n1,2\n", "heading_not_pointer"),
        ("d.csv", b"/plant,/plant/a\n1,2\n", "heading_not_pointer"),
        ("d.csv", b'/plant/cable_length_m\n"0.6\n', "line_not_csv"),
        ("d.jsonl", b'{"plant": {}}\n{"plant"\n', "line_not_json"),
        ("d.jsonl", b"[]\n", "line_not_object"),
        ("d.jsonl", b"\xff\n", "file_not_utf8"),
        ("none/d.csv", b"", "file_not_readable"),
    ],
)
def test_a_fault_of_a_list_has_its_code(
    tmp_path: Path, name: str, listed: bytes, code: str
) -> None:
    (tmp_path / Path(name).name).write_bytes(listed)
    with pytest.raises(ReadingError) as refused:
        read_source(b'{"designs_file": "%b"}' % name.encode(), toml=False, folder=tmp_path)
    assert refused.value.problem.code == code


def test_designs_are_listed_here_or_in_a_file(tmp_path: Path) -> None:
    body = b'{"designs_file": "d.csv", "designs": []}'
    with pytest.raises(ReadingError) as refused:
        read_source(body, toml=False, folder=tmp_path)
    assert refused.value.problem.code == "designs_said_twice"
