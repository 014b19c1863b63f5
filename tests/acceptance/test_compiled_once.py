"""Without a home, and beside code that cannot be written, a second process compiles nothing."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.pages.reading import ROOT
from tests.service.cli.table_runs import SMALL

PACKAGES = ("shapersmith", "design", "schemas", "service")


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    """Return the environment of a user of an image: code and home are not to be written."""
    code = tmp_path / "code"
    for name in PACKAGES:
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, code / name, ignore=ignored)
    # Not even root can make a folder where there is a file.
    (code / "design" / "tables" / "__pycache__").write_bytes(b"")
    kept = {name: value for name, value in os.environ.items() if not name.startswith("XDG_")}
    own = {"HOME": os.devnull, "PYTHONPATH": str(code), "PYTHONDONTWRITEBYTECODE": "1"}
    return kept | own | {"SHAPERSMITH_DATA_DIR": str(tmp_path / "data")}


def compiled(folder: Path) -> dict[Path, int]:
    """Return the files of machine code, and when each was written [ns]."""
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*.nb?")}


def test_a_second_table_in_another_process_compiles_nothing(
    environment: dict[str, str], tmp_path: Path
) -> None:
    spec = tmp_path / "spec.json"
    spec.write_text(json.dumps(SMALL))
    kept = []
    for name in ("first.csv", "second.csv"):
        done = subprocess.run(
            [sys.executable, "-m", "service", "table", str(spec), "-o", str(tmp_path / name)],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        kept.append(compiled(tmp_path))
    assert kept[0] == kept[1]
    assert all(path.is_relative_to(tmp_path / "data" / "compiled") for path in kept[0])
    assert len(kept[0]) > 2
    assert (tmp_path / "first.csv").read_bytes() == (tmp_path / "second.csv").read_bytes()
