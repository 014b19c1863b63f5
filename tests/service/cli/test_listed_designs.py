"""Designs of a table that a file beside its specification lists."""

import json
from pathlib import Path

import pytest

from service.__main__ import main
from tests.service.cli.table_runs import SMALL, table

LISTED = {"designs_file": "designs.csv", "design": SMALL["design"]}


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("designs.csv", "/plant/cable_length_m,/plant/damping_ratio\n0.6,0\n\n0.7,0.01\n"),
        (
            "designs.jsonl",
            '{"plant": {"cable_length_m": 0.6, "damping_ratio": 0}}\n'
            '{"plant": {"cable_length_m": 0.7, "damping_ratio": 0.01}}\n',
        ),
    ],
)
def test_listed_designs_come_from_a_file_beside_the_specification(
    spec: Path, tmp_path: Path, name: str, text: str
) -> None:
    (tmp_path / name).write_text(text)
    spec.write_text(json.dumps({**LISTED, "designs_file": name}))
    done = table(spec, "-o", tmp_path / "t.csv")
    assert done.returncode == 0, done.stderr
    rows = [line.split(",")[:2] for line in (tmp_path / "t.csv").read_text().splitlines()[-2:]]
    assert rows == [["0.6", "0.0"], ["0.7", "0.01"]]


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("d.csv", "/plant/cable_length_m\n0.6\nabc\n", "d.csv line 3: /plant/cable_length_m"),
        ("d.csv", "/plant/cable_length_m\n0.6\n0.7,1\n", "d.csv line 3: 2 cells"),
        ("d.csv", "/plant/cable_length_m\n0.6\n\n-1\n", "d.csv line 4:"),
        ("d.csv", "/plant/cable_length_m\nnan\n", "d.csv line 2: /plant/cable_length_m"),
        ("d.csv", "length\n0.6\n", "d.csv line 1: headings must be JSON pointers"),
        ("d.csv", '/plant/cable_length_m\n"0.6\n', "d.csv line 2"),
        ("d.csv", "/plant/mass_kg\n1\n", "d.csv line 2: /plant/mass_kg"),
        ("d.csv", "", "one or more"),
        ("d.jsonl", '{"plant": {}}\n{"plant"\n', "d.jsonl line 2:"),
        ("d.jsonl", "[]\n", "d.jsonl line 1: must be a JSON object"),
        (
            "d.jsonl",
            '{"plant": {"cable_length_m": "x"}}\n',
            "d.jsonl line 1: /plant/cable_length_m",
        ),
    ],
)
def test_a_bad_line_of_a_list_is_named(
    spec: Path,
    tmp_path: Path,
    name: str,
    text: str,
    told: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / name).write_text(text)
    spec.write_text(json.dumps({**LISTED, "designs_file": name}))
    assert main(["table", str(spec), "-o", str(tmp_path / "t.csv")]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "t.csv").exists()
