"""A move as a file, on the command line."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from design.export.registry import EXPORTS
from service.cli.single_file import Written, move_file
from service.problems import Problem
from tests.plc_files import plcopen_text, scl_text, twincat_text
from tests.service.cli.commands import shapersmith

REQUEST: dict[str, Any] = {
    "plant": {"kind": "pendulum", "cable_length_m": 9},
    "actuator": {
        "kind": "first_order",
        "accel_time_constant_s": 0.3,
        "decel_time_constant_s": 0.15,
        "model": "switched",
    },
    "shaper": {"kind": "numzv"},
    "speed_m_s": 1,
    "distance_m": 12,
}

MOVING = [name for name, export in EXPORTS.items() if export.move is not None]


def blocks(text: str) -> list[str]:
    """Return the parts that a file has, by the end of their names."""
    return [name.rpartition("_")[2] for name in re.findall(r"FUNCTION_BLOCK (\w+)", text)]


@pytest.mark.parametrize("name", MOVING)
def test_a_move_is_written(tmp_path: Path, name: str) -> None:
    path = tmp_path / f"move{EXPORTS[name].suffix}"
    done = shapersmith("maneuver", "-", "--format", name, "-o", path, given=REQUEST)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    written = move_file(json.dumps(REQUEST).encode(), name)
    assert isinstance(written, Written)
    assert path.read_bytes() == written.content
    texts = {"plcopen": plcopen_text, "twincat": twincat_text, "scl": scl_text}
    if name != "c":
        told = texts[name](path.read_bytes()) if name in texts else path.read_text()
        assert blocks(told) == ["start", "stop", "move"]


def test_the_numbers_are_of_the_type_asked_for() -> None:
    told = {}
    for real in ("LREAL", "REAL"):
        done = shapersmith("maneuver", "-", "--format", "st", "--real", real, given=REQUEST)
        assert (done.returncode, done.stderr) == (0, "")
        told[real] = done.stdout
        assert set(re.findall(r"\bL?REAL\b", done.stdout)) == {real}
    assert not (
        set(re.findall(r"FUNCTION_BLOCK (\w+)", told["LREAL"]))
        & set(re.findall(r"FUNCTION_BLOCK (\w+)", told["REAL"]))
    )


def test_a_move_on_samples_has_one_block() -> None:
    done = shapersmith("maneuver", "-", "--format", "st", given={**REQUEST, "sample_time_s": 0.01})
    assert blocks(done.stdout) == ["move"]
    assert "start and stop are no blocks: the samples are those of the whole move" in done.stdout


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"plant": {"kind": "modes", "modes": [{"natural_frequency_rad_s": w} for w in (3, 9)]}},
         "one"),
        ({"speed_m_s": 0}, "speed_m_s"),
        ({"sample_time_s": 5.0}, "sample_time_s"),
        ({"distance_m": None}, "pulse_s"),
        ({"plant": {"kind": "nothing"}}, "plant"),
    ],
)  # fmt: skip
def test_what_is_no_move_is_refused(changed: dict[str, Any], words: str) -> None:
    written = move_file(json.dumps({**REQUEST, **changed}).encode(), "st")
    assert isinstance(written, Problem)
    assert words in written.detail


@pytest.mark.parametrize("name", ["klipper", "rrf", "marlin", "arduino", "parquet"])
def test_formats_of_tables_and_shapers_play_no_moves(name: str) -> None:
    done = shapersmith("maneuver", "-", "--format", name, given=REQUEST)
    assert done.returncode == 2
    assert f"invalid choice: '{name}'" in done.stderr


def test_a_plot_goes_with_answers_alone(tmp_path: Path) -> None:
    picture = tmp_path / "move.png"
    done = shapersmith("maneuver", "-", "--format", "st", "--plot", picture, given=REQUEST)
    assert done.returncode == 2
    assert "--plot goes with json, table or csv, not with st" in done.stderr
