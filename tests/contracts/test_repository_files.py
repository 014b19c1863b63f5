"""The files that other tools read are sound, and say what the project says."""

import os
import shutil
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[2]

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

YAML_FILES = [
    ".github/ISSUE_TEMPLATE/bug.yml",
    ".github/ISSUE_TEMPLATE/idea.yml",
    ".github/workflows/check.yml",
    ".pre-commit-config.yaml",
    "CITATION.cff",
]


def read(name: str) -> Any:
    return yaml.safe_load((ROOT / name).read_text())


@pytest.mark.parametrize("name", YAML_FILES)
def test_each_file_is_yaml(name: str) -> None:
    assert isinstance(read(name), dict)


def test_the_workflow_runs_the_script_that_people_run_with_no_right_but_to_read() -> None:
    workflow = read(".github/workflows/check.yml")
    (job,) = workflow["jobs"].values()
    assert workflow["permissions"] == {"contents": "read"}
    assert [step["run"] for step in job["steps"] if "run" in step] == [".ci/run"]
    assert os.access(ROOT / ".ci" / "run", os.X_OK)


def test_the_workflow_begins_with_the_oldest_python_that_is_served() -> None:
    (job,) = read(".github/workflows/check.yml")["jobs"].values()
    assert f">={job['strategy']['matrix']['python'][0]}" == PROJECT["requires-python"]


def test_the_hooks_before_a_commit_are_those_of_make_check() -> None:
    (repository,) = read(".pre-commit-config.yaml")["repos"]
    makefile = (ROOT / "Makefile").read_text()
    for hook in repository["hooks"]:
        assert hook["language"] == "system"
        assert hook["name"].replace("ruff format", "ruff format --check") in makefile


@pytest.mark.parametrize("name", ["bug", "idea"])
def test_each_field_of_an_issue_has_a_label_and_an_id_of_its_own(name: str) -> None:
    body = read(f".github/ISSUE_TEMPLATE/{name}.yml")["body"]
    assert all(field["attributes"]["label"] for field in body)
    assert len({field["id"] for field in body}) == len(body)


def test_the_citation_names_this_version_and_licence() -> None:
    citation = read("CITATION.cff")
    assert (citation["title"], citation["version"], citation["license"]) == (
        PROJECT["name"],
        PROJECT["version"],
        PROJECT["license"],
    )


@pytest.mark.parametrize("has_uv", [True, False])
def test_the_set_up_is_by_uv_where_it_is_there_and_shows_how_far_it_is(
    tmp_path: Path, has_uv: bool
) -> None:
    tools = tmp_path / "tools"
    tools.mkdir()
    (tools / "make").symlink_to(shutil.which("make") or "")
    if has_uv:
        (tools / "uv").write_text("#!/bin/sh\n")
        (tools / "uv").chmod(0o755)
    planned = subprocess.run(
        ["make", "--dry-run", "setup", f"VENV={tmp_path / 'env'}"],
        cwd=ROOT,
        env={"PATH": str(tools)},
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    installs = [line for line in planned.splitlines() if " install " in line]
    assert len(installs) == 2
    assert all(("uv pip install" in line) == has_uv for line in installs)
    assert not any("--quiet" in line for line in installs)
    assert "--require-hashes -r requirements-dev.lock" in installs[0]
