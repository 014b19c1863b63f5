"""The wheel, installed outside the repository the way the image does, and served from there."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import CRANE, running_service

ROOT = Path(__file__).parents[2]


def run(*command: str | Path, cwd: Path) -> None:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(command, cwd=cwd, capture_output=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr.decode()


def test_the_wheel_serves_from_an_environment_of_its_own(tmp_path: Path) -> None:
    run(
        *(sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--quiet"),
        *("--wheel-dir", tmp_path / "wheels", ROOT),
        cwd=tmp_path,
    )
    (wheel,) = (tmp_path / "wheels").iterdir()
    run(sys.executable, "-m", "venv", tmp_path / "env", cwd=tmp_path)
    pip = tmp_path / "env" / "bin" / "pip"
    run(
        *(pip, "install", "--quiet", "--disable-pip-version-check"),
        *("--require-hashes", "-r", ROOT / "requirements.lock"),
        cwd=tmp_path,
    )
    run(pip, "install", "--quiet", "--disable-pip-version-check", "--no-deps", wheel, cwd=tmp_path)
    command = (str(tmp_path / "env" / "bin" / "shapersmith"),)
    with (
        running_service(tmp_path / "log", command=command, workers=1) as service,
        service.client() as client,
    ):
        design = client.post("/v1/designs", json=CRANE).json()
        assert client.get("/docs").status_code == 200
    assert design["shaper"]["duration_s"] == pytest.approx(1.32079496, abs=1e-7)
