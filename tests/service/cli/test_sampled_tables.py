"""Tables on samples by the command: their files, and whether these still are what is designed."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.service.cli.table_runs import table

SPEC: dict[str, Any] = {
    "design": {
        "plant": {"kind": "mode", "natural_frequency_rad_s": 12.0, "damping_ratio": 0.03},
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "umzv", "sample_time_s": 0.02},
    },
    "axes": [
        {"field": "/plant/natural_frequency_rad_s", "values": [11.0, 14.5]},
        {"field": "/shaper/sample_time_s", "values": [0.01, 0.02]},
    ],
    "chunk_rows": 1,
}


@pytest.mark.parametrize("name", ["csv", "h", "st"])
def test_a_file_is_checked_by_what_is_designed_now(tmp_path: Path, name: str) -> None:
    (tmp_path / "spec.json").write_text(json.dumps(SPEC))
    path = tmp_path / f"table.{name}"
    made = table(tmp_path / "spec.json", "-o", path, "--workers", 2)
    assert made.returncode == 0, made.stderr
    assert "4 verified" in made.stderr
    again = table(tmp_path / "spec.json", "--check", path, "--workers", 1)
    assert again.returncode == 0, again.stderr
    lines = path.read_text().splitlines()
    lines[-3] = f"{lines[-3]} 1"
    if name == "csv":
        lines[-3] = lines[-2]
    path.write_text("\n".join(lines) + "\n")
    drifted = table(tmp_path / "spec.json", "--check", path)
    assert drifted.returncode == 5, drifted.stderr


def test_klipper_is_refused_before_a_row_is_designed(tmp_path: Path) -> None:
    design = {**SPEC["design"], "shaper": {"kind": "ei", "sample_time_s": 0.02}}
    (tmp_path / "spec.json").write_text(json.dumps({**SPEC, "design": design}))
    told = table(tmp_path / "spec.json", "-o", tmp_path / "lines.gcode", "--format", "klipper")
    assert told.returncode == 2
    assert "left out for Klipper" in told.stderr
    assert "rows in" not in told.stderr
