"""The wheel, installed outside the repository by the recipe of the documentation, and served."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tests.conftest import CRANE, running_service
from tests.pages.reading import ROOT, blocks

FILES = {block.file: block.text for block in blocks("docs/ci.md") if block.file}

GITHUB = yaml.safe_load(FILES[".github/workflows/tables.yml"])["jobs"]["check"]["steps"]
STEPS = [step["run"] for step in GITHUB if "run" in step]


def run(command: str, folder: Path, environment: Path) -> None:
    """Run a command as a build server does: in a folder, its own Python first on the path."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    path = f"{environment / 'bin'}{os.pathsep}{kept['PATH']}"
    ran = subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        capture_output=True,
        check=False,
        env=kept | {"PATH": path, "PIP_QUIET": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"},
    )
    assert ran.returncode == 0, ran.stderr.decode()


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an environment in which the steps of the recipe have passed, one by one."""
    folder = tmp_path_factory.mktemp("firmware")
    run(f"pip wheel --no-deps --no-build-isolation --wheel-dir vendor {ROOT}", folder, tools())
    run(f"cp {ROOT}/requirements.lock vendor/", folder, tools())
    (folder / "shaper.json").write_text(FILES["shaper.json"])
    run("shapersmith table shaper.json -o shaper.csv", folder, tools())
    made = folder / "env"
    subprocess.run([sys.executable, "-m", "venv", made], check=True)
    for step in STEPS:
        run(step, folder, made)
    return made


def tools() -> Path:
    """Return the environment of these tests."""
    return Path(sys.executable).parents[1]


def test_an_environment_takes_what_the_page_says(environment: Path) -> None:
    sizes = [path.lstat().st_size for path in environment.rglob("*")]
    (said_gb,) = re.findall(
        r"The environment takes ([\d.]+) GB", (ROOT / "docs/install.md").read_text()
    )
    assert 0.9 * float(said_gb) < sum(sizes) / 1e9 <= float(said_gb)


def test_the_recipes_have_the_same_steps() -> None:
    assert yaml.safe_load(FILES[".gitlab-ci.yml"])["tables"]["script"] == STEPS
    assert STEPS[-1].startswith("shapersmith table shaper.json --check")


def test_in_the_image_the_check_alone_is_left() -> None:
    assert yaml.safe_load(FILES["image-job.yml"])["tables"]["script"] == STEPS[-1:]


def test_the_wheel_serves_from_a_separate_environment(environment: Path, tmp_path: Path) -> None:
    command = (str(environment / "bin" / "shapersmith"),)
    with (
        running_service(tmp_path / "log", command=command, workers=1) as service,
        service.client() as client,
    ):
        design = client.post("/v1/designs", json=CRANE).json()
        assert client.get("/docs").status_code == 200
    assert design["shaper"]["duration_s"] == pytest.approx(1.32079496, abs=1e-7)
