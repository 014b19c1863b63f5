"""What a user installs is what the code imports, and the metadata say what is tested."""

import ast
import re
import subprocess
import sys
import tarfile
import tomllib
from itertools import chain
from pathlib import Path

import yaml

from tests.syntax import parsed

ROOT = Path(__file__).parents[2]

PACKAGES = ("shapersmith", "design", "schemas", "service")

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

BY_NAME = {"fastapi_offline", "httptools", "psycopg", "uvloop", "wsproto"}
"""Used without an import of ours: its files are served, or uvicorn and SQLAlchemy import it."""

WITH_OTHERS = {"starlette": "fastapi", "pydantic_core": "pydantic"}
"""Packages that come with others, which are required."""


def imported() -> set[str]:
    """Return the packages of others that the code imports, wherever it does."""
    found: set[str] = set()
    for module in chain(*((ROOT / package).rglob("*.py") for package in PACKAGES)):
        for node in ast.walk(parsed(module)):
            if isinstance(node, ast.Import):
                found |= {name.name.partition(".")[0] for name in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.partition(".")[0])
    found -= set(sys.stdlib_module_names) | set(PACKAGES)
    return {WITH_OTHERS.get(name, name) for name in found}


def required() -> set[str]:
    """Return the packages that are required, and those of the extras."""
    rows = [*PROJECT["dependencies"], *chain(*PROJECT["optional-dependencies"].values())]
    return {re.split(r"[^\w-]", row)[0].replace("-", "_") for row in rows}


def test_what_the_code_imports_is_required_and_nothing_else() -> None:
    assert required() == imported() | BY_NAME


def test_the_metadata_name_each_python_that_is_tested_and_no_address_that_is_none() -> None:
    workflow = yaml.safe_load((ROOT / ".github/workflows/check.yml").read_text())
    (job,) = workflow["jobs"].values()
    rows = [row.rpartition(" :: ")[2] for row in PROJECT["classifiers"] if "Python :: 3." in row]
    assert rows == job["strategy"]["matrix"]["python"]
    assert "urls" not in PROJECT


def pins(lock: str) -> set[str]:
    """Return the packages that a lock pins, with version and marker."""
    rows = (ROOT / lock).read_text().splitlines()
    return {row.rstrip(" \\") for row in rows if row and not row.startswith((" ", "#"))}


def test_the_locks_pin_the_same_and_extras_stand_in_their_own() -> None:
    users, extras = pins("requirements.lock"), pins("requirements-extras.lock")
    assert users < extras
    more = {re.split(r"\W", pin)[0] for pin in extras - users}
    assert {"distributed", "psycopg"} <= more
    names = {pin.partition("==")[0] for pin in extras}
    also = {pin for pin in pins("requirements-dev.lock") if pin.partition("==")[0] in names}
    assert also <= extras


def test_the_source_distribution_holds_the_packages_and_no_tests(tmp_path: Path) -> None:
    build = [sys.executable, "-m", "build", "--sdist", "--no-isolation", "--outdir", str(tmp_path)]
    subprocess.run([*build, str(ROOT)], check=True, capture_output=True)
    (made,) = tmp_path.iterdir()
    with tarfile.open(made) as archive:
        names = {Path(name).parts[1] for name in archive.getnames()}
    texts = {"LICENSE", "README.md", "PKG-INFO", "pyproject.toml"}
    assert names - {".gitignore"} == {*PACKAGES, *texts}
