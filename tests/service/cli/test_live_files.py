"""The machine of a live run as a file, on the command line."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from design.export.formats import FORMATS
from design.export.registry import EXPORTS
from schemas.runs import RunRequest
from service.cli.single_file import Written, live_file
from service.operations.live_file import live_file as file_of_machine
from service.problems import Problem
from tests.plc_files import plcopen_text, scl_text, twincat_text
from tests.refusals import refused
from tests.service.cli.commands import shapersmith

LIVE: dict[str, Any] = {"mode": "live", "shaper": {"kind": "numzv"}}

REQUEST: dict[str, Any] = {
    "plant": {"kind": "pendulum", "cable_length_m": 9},
    "actuator": {
        "kind": "first_order",
        "accel_time_constant_s": 0.3,
        "decel_time_constant_s": 0.15,
        "model": "switched",
    },
    "speed_m_s": 1,
    "shaping": LIVE,
    "events": [{"at_s": 0, "cable_length_m": 3, "over_s": 10}],
}

BLOCKS = ["over", "angle", "switch", "remains", "pulse", "solve", "replan", "shaper"]


def test_formats_that_play_moves_hold_blocks_too() -> None:
    for name, row in FORMATS.items():
        assert (EXPORTS[name].live is not None) == row.plays_moves


@pytest.mark.parametrize("name", [name for name, row in FORMATS.items() if row.plays_moves])
def test_a_block_is_written(tmp_path: Path, name: str) -> None:
    path = tmp_path / f"live{EXPORTS[name].suffix}"
    done = shapersmith("run", "-", "--format", name, "-o", path, given=REQUEST)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    written = live_file(json.dumps(REQUEST).encode(), name)
    assert isinstance(written, Written)
    assert path.read_bytes() == written.content
    texts = {"plcopen": plcopen_text, "twincat": twincat_text, "scl": scl_text}
    if name != "c":
        told = texts[name](path.read_bytes()) if name in texts else path.read_text()
        names = re.findall(r"^FUNCTION_BLOCK (\w+)", told, re.MULTILINE)
        assert [name.rpartition("_")[2] for name in names] == BLOCKS


def test_the_block_works_between_all_lengths_of_the_run() -> None:
    told = shapersmith("run", "-", "--format", "st", given=REQUEST).stdout
    assert "plant: cable 3 to 9 m" in told
    one = shapersmith("run", "-", "--format", "st", given={**REQUEST, "events": None}).stdout
    assert "plant: cable 9 to 9 m" in one


def test_the_cycle_of_the_run_is_that_of_the_call() -> None:
    timed = {**REQUEST, "shaping": {**LIVE, "sample_time_s": 0.004}}
    told = shapersmith("run", "-", "--format", "st", given=timed).stdout
    assert "cycle_time_s := 0.004" in told


def test_the_numbers_are_of_the_type_asked_for() -> None:
    for real in ("LREAL", "REAL"):
        done = shapersmith("run", "-", "--format", "st", "--real", real, given=REQUEST)
        assert set(re.findall(r"\bL?REAL\b", done.stdout)) == {real}


@pytest.mark.parametrize(
    ("changed", "pointer"),
    [
        ({"shaping": {"mode": "none"}}, "/shaping/mode"),
        ({"shaping": None}, "/shaping/mode"),
        ({"shaping": {"mode": "live", "shaper": {"kind": "zv"}}}, "/shaping/shaper/kind"),
        ({"load": {"mass_kg": 1, "length_m": 0.2}}, "/load"),
        ({"deflection_limit": 0.3}, "/deflection_limit"),
        ({"shaping": {**LIVE, "sample_time_s": 0.5}}, "/shaping/sample_time_s"),
        ({"plant": {"kind": "mode", "natural_frequency_rad_s": 3}}, "/events/0/cable_length_m"),
        (
            {
                "actuator": {
                    "kind": "rate_limited",
                    "accel_limit_m_s2": 1,
                    "decel_limit_m_s2": 2,
                    "speed_m_s": 1,
                }
            },
            "/actuator/kind",
        ),
        ({"events": [{"at_s": 0, "cable_length_m": -3, "over_s": 1}]}, "/events/0/cable_length_m"),
    ],
)
def test_what_no_block_serves_is_refused_by_its_field(
    changed: dict[str, Any], pointer: str
) -> None:
    problem = live_file(json.dumps({**REQUEST, **changed}).encode(), "st")
    assert isinstance(problem, Problem)
    assert pointer in {error.pointer for error in problem.errors}


def test_codes_of_refusals() -> None:
    request = RunRequest.model_validate(REQUEST)
    with refused("format_without_blocks", "format"):
        file_of_machine(request, "csv")
    with refused("block_needs_live", "shaping.mode"):
        file_of_machine(request.model_copy(update={"shaping": None}), "st")
    with refused("limit_without_block", "deflection_limit"):
        file_of_machine(request.model_copy(update={"deflection_limit": 0.3}), "st")
    slow = {**LIVE, "sample_time_s": 0.5}
    with refused("cycle_without_block", "shaping.sample_time_s"):
        file_of_machine(RunRequest.model_validate({**REQUEST, "shaping": slow}), "st")
    loaded = RunRequest.model_validate({**REQUEST, "load": {"mass_kg": 1, "length_m": 0.2}})
    with refused("load_without_block", "load"):
        file_of_machine(loaded, "st")
