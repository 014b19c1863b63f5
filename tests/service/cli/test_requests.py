"""Requests as editors and spreadsheets write them."""

import json
from pathlib import Path

import pytest

from service.operations.table import TABLE
from tests.conftest import CRANE
from tests.service.cli.commands import shapersmith

TEXT = json.dumps(CRANE)

TOML = """
shaper = {kind = "numzvd"}  # zero slope
[plant]
kind = "pendulum"
cable_length_m = 0.8
gravity_m_s2 = 9.81
[actuator]
kind = "second_order"
accel = {natural_frequency_rad_s = 20, damping_ratio = 0.8}
decel = {natural_frequency_rad_s = 50, damping_ratio = 1.5}
"""


@pytest.fixture(scope="module")
def expected() -> str:
    return shapersmith("design", "-", given=CRANE).stdout


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32"])
@pytest.mark.parametrize(("name", "text"), [("crane.json", TEXT), ("crane.toml", TOML)])
def test_a_request_is_read_in_any_unicode(
    tmp_path: Path, encoding: str, name: str, text: str, expected: str
) -> None:
    (tmp_path / name).write_text(text, encoding=encoding)
    done = shapersmith("design", tmp_path / name)
    assert (done.returncode, done.stdout) == (0, expected), done.stderr


@pytest.mark.parametrize("command", [row.command for row in TABLE.values()])
def test_every_command_reads_toml(tmp_path: Path, command: str) -> None:
    request = tmp_path / "crane.TOML"
    request.write_text(f"nonsense = 1\n{TOML}")
    done = shapersmith(command, request)
    assert done.returncode == 2
    assert "/nonsense: is no field here" in done.stderr


def test_a_program_is_written_of_a_request_in_toml(tmp_path: Path) -> None:
    request = tmp_path / "crane.toml"
    request.write_text(TOML)
    done = shapersmith("design", request, "--format", "st")
    assert done.returncode == 0
    assert "numzvd" in done.stdout


@pytest.mark.parametrize("command", [*(row.command for row in TABLE.values()), "table"])
@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("crane.json", "{\n'plant': 1}", "crane.json line 2, column 1: single quotes"),
        ("crane.toml", "plant = 1\nplant", "crane.toml no TOML: line 2, column 6: = is"),
    ],
)
def test_a_file_that_cannot_be_read_is_named(
    tmp_path: Path, command: str, name: str, text: str, told: str
) -> None:
    (tmp_path / name).write_text(text)
    output = ("-o", tmp_path / "t.csv") if command == "table" else ()
    done = shapersmith(command, tmp_path / name, *output)
    assert (done.returncode, done.stdout) == (2, "")
    assert told in done.stderr
    assert done.stderr.count("\n") == 1


def test_standard_input_has_no_name() -> None:
    done = shapersmith("design", "-", given="{'plant'}")
    assert done.stderr.startswith("shapersmith: not-json: line 1, column 2: single quotes")
