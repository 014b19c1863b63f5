"""The steps of the Dockerfile, one by one in a folder, without an engine; then its service."""

import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import pytest
import yaml

from service.http.server import SHUTDOWN_MARGIN_S
from service.settings import Settings
from tests.conftest import CRANE, free_port
from tests.pages.reading import ROOT, blocks
from tests.patience import PATIENT_S
from tests.processes import until
from tests.service.http.test_tables_over_http import TABLE, ended

ABSOLUTE = re.compile(r"(?<![\w.:/])/(?=(opt|source|tmp|var|wheels)\b)")
"""The root of an image, where a step names it."""

OF_ROOT = ("chown", "useradd")
"""Commands that change a machine: they do nothing here."""

BASE = "python:3.13-slim"


def steps(text: str) -> Iterator[tuple[str, str]]:
    """Yield the instructions of a Dockerfile with their arguments."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    for line in "\n".join(lines).replace("\\\n", " ").splitlines():
        if line.strip():
            name, _, rest = line.partition(" ")
            yield name, rest.strip()


@dataclass
class Image:
    """A folder that stands for the root of an image, and what has been set in it."""

    root: Path
    let_in: set[str]
    folder: Path = Path()
    environment: dict[str, str] = field(default_factory=dict)
    said: dict[str, str] = field(default_factory=dict)

    def rooted(self, text: str) -> str:
        return ABSOLUTE.sub(f"{self.root}/", text)

    def do(self, name: str, rest: str) -> None:
        """Do one step."""
        if name == "FROM":
            assert rest.replace("${DIGEST}", "").split(" AS ")[0] == BASE
            path = f"{self.root}/shims{os.pathsep}{os.environ['PATH']}"
            # As in an engine: no home, nothing of the machine around it.
            self.environment = {"PATH": path} | {
                name: value for name, value in os.environ.items() if name.startswith("PIP_")
            }
            self.folder = self.root
        elif name == "WORKDIR":
            self.folder = Path(self.rooted(rest))
            self.folder.mkdir()
        elif name == "ENV":
            for one in shlex.split(rest):
                variable, _, value = one.partition("=")
                value = value.replace("$PATH", self.environment["PATH"])
                self.environment[variable] = self.rooted(value)
        elif name == "COPY":
            self.copy(*shlex.split(rest))
        elif name == "RUN":
            self.run(self.rooted(rest))
        else:
            assert name in {"ARG", "CMD", "EXPOSE", "HEALTHCHECK", "USER", "VOLUME"}
            self.said[name] = rest

    def copy(self, *words: str) -> None:
        """Copy what is let in from the checkout; between stages, which share this root, nothing."""
        *sources, target = words
        if sources[0].startswith("--from="):
            assert sources[1] == target
            assert Path(self.rooted(target)).is_dir()
            return
        for source in sources:
            assert source in self.let_in
            if (ROOT / source).is_dir():
                ignored = shutil.ignore_patterns("__pycache__")
                shutil.copytree(ROOT / source, self.folder / target, ignore=ignored)
            else:
                shutil.copy(ROOT / source, self.folder / target)

    def run(self, command: str) -> None:
        (self.root / "var" / "lib").mkdir(parents=True, exist_ok=True)
        ran = subprocess.run(
            ["bash", "-ec", command],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            check=False,
        )
        assert ran.returncode == 0, (command, ran.stderr.decode())

    def words(self, name: str, port: int) -> list[str]:
        """Return a command of the image, on another port."""
        words: list[str] = json.loads(self.said[name][self.said[name].index("[") :])
        return [word.replace("8000", str(port)) for word in words]


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> Image:
    """Return the image after all its steps."""
    root = tmp_path_factory.mktemp("image")
    shims = root / "shims"
    shims.mkdir()
    for name in OF_ROOT:
        (shims / name).write_text("#!/bin/sh\n")
        (shims / name).chmod(0o755)
    (shims / "python").symlink_to(sys.executable)
    ignored = (ROOT / ".dockerignore").read_text().splitlines()
    made = Image(root, {line[1:] for line in ignored if line.startswith("!")})
    for name, rest in steps((ROOT / "Dockerfile").read_text()):
        made.do(name, rest)
    return made


def test_the_service_of_the_image_is_well_and_ends_with_its_signal(image: Image) -> None:
    port = free_port()
    volume = Path(image.rooted(image.said["VOLUME"]))
    assert image.environment["SHAPERSMITH_DATA_DIR"] == str(volume)
    log = image.root / "log"
    with log.open("wb") as stderr:
        process = subprocess.Popen(
            image.words("CMD", port), cwd=image.root, env=image.environment, stderr=stderr
        )

    def is_well() -> bool:
        assert process.poll() is None, log.read_text()
        check = subprocess.run(
            image.words("HEALTHCHECK", port),
            env=image.environment,
            capture_output=True,
            check=False,
        )
        return check.returncode == 0

    try:
        until(is_well, "the health check never passes")
        compiled = set((volume / "compiled").rglob("*"))
        assert any(file.suffix == ".nbi" for file in compiled)  # before it is ready
        with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=PATIENT_S) as client:
            assert client.post("/v1/designs", json=CRANE).json()["certificate"]["verified"]
            location = client.post("/v1/tables", json=TABLE).headers["location"]
            assert ended(client, location)["verified"] == 8
        assert set((volume / "compiled").rglob("*")) == compiled  # nothing was compiled again
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENT_S) == 0
    finally:
        process.kill()
        process.wait(PATIENT_S)


def test_the_image_has_both_extras_and_no_tool_of_the_build(image: Image) -> None:
    for name in ("distributed", "psycopg"):
        image.run(f"{image.root}/opt/shapersmith/bin/python -c 'import {name}'")
    folder = image.root / "opt" / "shapersmith"
    names = {path.name for path in folder.glob("lib/python*/site-packages/*")}
    assert not names & {"pip", "hatchling", "pytest", "cvxpy"}


def test_a_build_server_checks_a_table_in_it(image: Image, tmp_path: Path) -> None:
    files = {block.file: block.text for block in blocks("docs/ci.md") if block.file}
    (script,) = yaml.safe_load(files["image-job.yml"])["tables"]["script"]
    (tmp_path / "shaper.json").write_text(files["shaper.json"])
    image.run(f"cd {tmp_path} && shapersmith table shaper.json -o shaper.csv")
    image.run(f"cd {tmp_path} && {script}")
    table = tmp_path / "shaper.csv"
    table.write_text(table.read_text().replace("1.968930", "1.968931"))
    image.run(f"cd {tmp_path} && ! {script}")


def test_it_is_published_on_the_loopback_and_has_its_time_to_end() -> None:
    compose: dict[str, Any] = yaml.safe_load((ROOT / "compose.yaml").read_text())
    service = compose["services"]["shapersmith"]
    assert service["ports"] == ["127.0.0.1:8000:8000"]
    assert service["read_only"]
    grace_s = float(service["stop_grace_period"].removesuffix("s"))
    assert grace_s >= Settings().time_limit_s + SHUTDOWN_MARGIN_S
