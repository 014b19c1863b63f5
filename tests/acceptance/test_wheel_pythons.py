"""The wheel in bare environments of every Python that is here: design, plot, table, serve."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml

from tests.acceptance.test_wheel import run, tools
from tests.conftest import CRANE, running_service
from tests.pages.reading import ROOT, blocks
from tests.service.cli.table_runs import SMALL

SERVED: list[str] = yaml.safe_load((ROOT / ".github/workflows/check.yml").read_text())["jobs"][
    "check"
]["strategy"]["matrix"]["python"]
"""Versions that CI runs, each in a job of its own."""

OWN = f"{sys.version_info.major}.{sys.version_info.minor}"

INSTALL = next(
    commands
    for commands in ([one.line for one in block.commands] for block in blocks("docs/install.md"))
    if any("--constraint" in line for line in commands)
)
"""What the page types to install the wheel file with the lock as constraints."""

PNG = b"\x89PNG\r\n"


def pythons() -> Iterator[tuple[str, str]]:
    """Yield each served version of which there is an interpreter here, the own one always."""
    for version in SERVED:
        if version == OWN:
            yield version, sys.executable
            continue
        kept = Path.home().glob(f".pyenv/versions/{version}.*/bin/python3")
        found = [name for name in (f"python{version}", *map(str, kept)) if is_python(name, version)]
        if found:
            yield version, found[0]


def is_python(name: str, version: str) -> bool:
    """Return whether a program is a Python of a version that makes environments."""
    program = "import ensurepip, sys, venv; print('%d.%d' % sys.version_info[:2])"
    try:
        done = subprocess.run([name, "-c", program], capture_output=True, text=True, check=False)
    except OSError:
        return False
    return done.stdout == f"{version}\n"


@dataclass(frozen=True)
class Installed:
    """An environment with the wheel, and a folder to work in that knows nothing else."""

    version: str
    folder: Path

    @property
    def environment(self) -> Path:
        return self.folder / "env"

    def shapersmith(self, words: str) -> None:
        """Run the command as a user does whose environment is on the path."""
        run(f"shapersmith {words}", self.folder, self.environment)


def install(version: str, python: str, folder: Path) -> Installed:
    """Return an environment that is made as the page says."""
    made = Installed(version, folder)
    subprocess.run([python, "-m", "venv", made.environment], check=True)
    assert is_python(str(made.environment / "bin" / "python"), version)
    for line in INSTALL:
        # The tests have no network to fetch the tool of the build from.
        command = line.replace("pip wheel", "pip wheel --no-build-isolation")
        where = tools() if "pip wheel" in line else made.environment
        run(command.replace("$SHAPERSMITH", str(ROOT)), made.folder, where)
    (made.folder / "crane.json").write_text(json.dumps(CRANE))
    (made.folder / "spec.json").write_text(json.dumps(SMALL))
    return made


@pytest.mark.parametrize(("version", "python"), list(pythons()))
def test_the_wheel_does_all_of_its_work_in_a_bare_environment(
    version: str, python: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed = install(version, python, tmp_path)
    require_size_of_the_page(installed)
    require_design_and_picture(installed)
    require_table(installed)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    require_service(installed)


def require_size_of_the_page(installed: Installed) -> None:
    """Hold the environment against what the page says that it takes."""
    text = (ROOT / "docs/install.md").read_text()
    (said_gb,) = re.findall(r"The environment takes ([\d.]+) GB", text)
    sizes = [path.lstat().st_size for path in installed.environment.rglob("*")]
    assert 0.9 * float(said_gb) < sum(sizes) / 1e9 <= float(said_gb)


def require_design_and_picture(installed: Installed) -> None:
    """Have a shaper designed and drawn."""
    installed.shapersmith("design crane.json -o design.json --plot design.png")
    design = json.loads((installed.folder / "design.json").read_text())
    assert design["certificate"]["verified"]
    assert design["shaper"]["duration_s"] == pytest.approx(1.32079496, abs=1e-7)
    assert (installed.folder / "design.png").read_bytes().startswith(PNG)


def require_table(installed: Installed) -> None:
    """Have a table written, and computed once more."""
    installed.shapersmith("table spec.json -o table.csv")
    rows = (installed.folder / "table.csv").read_text().splitlines()
    assert sum(row.endswith("verified,") for row in rows) == SMALL["axes"][0]["points"]
    installed.shapersmith("table spec.json --check table.csv")


def require_service(installed: Installed) -> None:
    """Have a service answer a design, and with a schema."""
    command = (str(installed.environment / "bin" / "shapersmith"),)
    log = installed.folder / "log"
    with (
        running_service(log, command=command, workers=1) as service,
        service.client() as client,
    ):
        assert client.post("/v1/designs", json=CRANE).json()["certificate"]["verified"]
        assert client.get("/v1/schemas/design-request").status_code == 200
