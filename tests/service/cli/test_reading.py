"""Lists of designs beside a specification: each fault is refused by its code."""

import json
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
        ("d.csv", b"/plant/cable_length_m;/plant/damping_ratio\n0,6;0.01\n", "decimals_mixed"),
        ("d.csv", b"/plant/cable_length_m;/plant/damping_ratio\n1.234,5;0\n", "decimals_mixed"),
        ("d.csv", b"/plant/cable_length_m;/plant/damping_ratio\n0,6,1;0\n", "cell_not_finite"),
        ("d.jsonl", b'{"plant": {}}\n{"plant"\n', "line_not_json"),
        ("d.jsonl", b"[]\n", "line_not_object"),
        ("d.jsonl", b"\xff\n", "file_not_utf8"),
        ("d.toml", b"[[designs]\n", "list_not_toml"),
        ("d.toml", b"designs = 1\n", "list_without_headings"),
        ("d.toml", b"designs = [{}]\n", "list_without_headings"),
        ("d.toml", b"[plant]\n", "list_without_headings"),
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


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize(
    ("separator", "decimal"), [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ",")]
)
def test_a_list_is_read_as_spreadsheets_of_any_country_write_it(
    tmp_path: Path, encoding: str, separator: str, decimal: str
) -> None:
    rows = (("/plant/cable_length_mm", "/plant/damping_ratio"), ("600.5", "1e-2"), ("700", "0.02"))
    text = "\r\n".join(
        separator.join(cell.replace(".", decimal) for cell in cells) for cells in rows
    )
    (tmp_path / "d.csv").write_text(text, encoding=encoding)
    source = read_source(b'{"designs_file": "d.csv"}', toml=False, folder=tmp_path)
    assert json.loads(source.body)["designs"] == [
        {"plant": {"cable_length_mm": 600.5, "damping_ratio": 0.01}},
        {"plant": {"cable_length_mm": 700.0, "damping_ratio": 0.02}},
    ]
    assert source.lines == [2, 3]


def test_a_list_in_toml_has_a_heading_for_each_design(tmp_path: Path) -> None:
    text = """# crane
[[designs]]
plant.cable_length_mm = 600
  [[ designs ]]  # the long one
[designs.plant]
cable_length_m = 0.7
"""
    (tmp_path / "d.TOML").write_text(text, encoding="utf-16")
    source = read_source(b'{"designs_file": "d.TOML"}', toml=False, folder=tmp_path)
    assert json.loads(source.body)["designs"] == [
        {"plant": {"cable_length_mm": 600}},
        {"plant": {"cable_length_m": 0.7}},
    ]
    assert source.lines == [2, 4]
