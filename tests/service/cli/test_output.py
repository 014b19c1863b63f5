"""Answers go to a file, whole or not at all; a shell completes words; a table says what it does."""

import json
import logging
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from design.tables import needed_code
from design.tables.compute import compute_rows
from design.tables.proofs import prove_rows
from service.cli import compiling
from service.cli.progress import Progress
from service.compiled_code import VARIABLE
from service.jobs.plan import Plan, plan_table, specification_of
from service.jobs.records import Job
from service.operations.table import TABLE
from tests.conftest import CRANE
from tests.patience import PATIENT_S
from tests.service.cli.commands import shapersmith
from tests.service.cli.table_runs import SMALL
from tests.shapersmith.requests import REQUESTS

COMMANDS = [(row.command, REQUESTS[name]) for name, row in TABLE.items()]


@pytest.mark.parametrize(("command", "request_"), COMMANDS)
def test_an_answer_is_written_to_a_file(
    tmp_path: Path, command: str, request_: dict[str, Any]
) -> None:
    path = tmp_path / "answer.json"
    path.write_text("what stood there")
    request_ = {**request_, "trace": False} if "trace" in request_ else request_
    printed = shapersmith(command, "-", given=request_)
    written = shapersmith(command, "-", "-o", path, given=request_)
    assert (written.returncode, written.stdout, written.stderr) == (0, "", "")
    assert path.read_text() == printed.stdout
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("text_format", ["table", "csv", "st"])
def test_texts_and_programs_are_written_to_a_file_too(tmp_path: Path, text_format: str) -> None:
    path = tmp_path / "crane.txt"
    printed = shapersmith("design", "-", "--format", text_format, given=CRANE)
    shapersmith("design", "-", "--format", text_format, "--output", path, given=CRANE)
    assert path.read_bytes().decode() == printed.stdout


def test_the_catalogue_is_written_to_a_file(tmp_path: Path) -> None:
    assert shapersmith("shapers", "-o", tmp_path / "shapers.json").returncode == 0
    assert json.loads((tmp_path / "shapers.json").read_text())["shapers"]


def test_no_file_is_written_of_a_refusal_nor_over_the_request(tmp_path: Path) -> None:
    path, request = tmp_path / "answer.json", tmp_path / "crane.json"
    request.write_text(json.dumps({**CRANE, "shaper": {"kind": "numzv", "settle": 1}}))
    assert shapersmith("design", request, "-o", path).returncode == 2
    assert not path.exists()
    request.write_text(json.dumps(CRANE))
    over = shapersmith("design", request, "-o", request)
    assert (over.returncode, json.loads(request.read_text())) == (2, CRANE)
    assert "it is the request itself" in over.stderr
    nowhere = shapersmith("shapers", "-o", tmp_path / "none" / "shapers.json")
    assert (nowhere.returncode, nowhere.stdout) == (2, "")
    both = shapersmith("design", request, "-o", tmp_path / "a.png", "--plot", tmp_path / "a.png")
    assert both.returncode == 2


@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_a_shell_completes_commands_options_and_files(shell: str) -> None:
    script = shapersmith("--print-completion", shell)
    assert (script.returncode, script.stderr) == (0, "")
    for word in (*(row.command for row in TABLE.values()), "serve", "--format", "--plot"):
        assert word in script.stdout


def test_bash_completes_what_it_is_told(tmp_path: Path) -> None:
    (tmp_path / "c.bash").write_text(shapersmith("--print-completion", "bash").stdout)
    program = (
        'source c.bash; COMP_WORDS=(shapersmith rec); COMP_CWORD=1; COMP_LINE="shapersmith rec"; '
        '$(complete -p shapersmith | sed "s/.*-F \\([^ ]*\\).*/\\1/"); echo "${COMPREPLY[@]}"'
    )
    done = subprocess.run(
        ["bash", "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["recommend"]


def test_nothing_is_imported_for_completion_unless_it_is_asked_for() -> None:
    program = """
import sys
from service.cli.main import command_parser
command_parser()
print("shtab" in sys.modules)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "False\n"


def job_of(done: int) -> Job:
    return Job(
        id="a", state="running", reason="", created=0.0, sha256="", version="", rows=40, chunks=10,
        estimated_bytes=0, done=done, verified=done, verified_ideal=0, infeasible=0,
        rate_rows_s=0.0,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("compiles", "done", "told"), [(True, 0, True), (True, 4, False), (False, 0, False)]
)
def test_the_line_of_a_table_says_that_it_compiles(
    compiles: bool,
    done: int,
    told: bool,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("service.cli.progress.LINE_EVERY_S", 0.0)
    Progress(lambda: compiles).show(job_of(done))
    line = capsys.readouterr().err
    assert line.startswith(f"{done} of 40 rows")
    assert ("compiling, first use only" in line) == told


def test_that_a_table_compiles_is_said_at_once_and_once(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.cli.progress.LINE_EVERY_S", PATIENT_S)
    compiles = iter([False, True, True, True])
    progress = Progress(lambda: next(compiles))
    for done in (0, 0, 0, 0, 4):
        progress.show(job_of(done))
    assert capsys.readouterr().err == "0 of 40 rows, compiling, first use only\n"


def test_a_table_compiles_until_all_that_it_needs_is_on_disk(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(compiling, "ASKED_AFTER_S", 0.0)
    by_kernel, by_design = (_plan({**SMALL, **changed}) for changed in ({}, BY_DESIGN))
    job = by_kernel.job
    compute_rows(specification_of(job.specification, job.impulses), 0, 1)
    assert not compiling.Compiling(job)()
    monkeypatch.setattr(needed_code, "is_kept", lambda function, _: function is prove_rows)
    assert compiling.Compiling(job)()
    assert not compiling.Compiling(by_design.job)()


def test_that_no_code_is_there_at_all_is_seen_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    by_kernel, by_design = (_plan({**SMALL, **changed}) for changed in ({}, BY_DESIGN))
    monkeypatch.setattr(compiling, "ASKED_AFTER_S", PATIENT_S)
    assert not compiling.Compiling(by_kernel.job)()
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    assert compiling.Compiling(by_kernel.job)()
    assert not compiling.Compiling(by_design.job)()


BY_DESIGN = {
    "design": {**SMALL["design"], "shaper": {"kind": "zvd"}},
    "columns": ["times_s", "amplitudes"],
}


def _plan(specification: dict[str, Any]) -> Plan:
    plan = plan_table(json.dumps(specification).encode())
    assert isinstance(plan, Plan)
    return plan


@pytest.mark.parametrize(
    ("host", "address"), [("127.0.0.1", "http://127.0.0.1:"), ("::1", "http://[::1]:")]
)
def test_the_start_of_the_service_says_where_its_documentation_is(
    host: str, address: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    from service.http import server
    from service.settings import Settings

    monkeypatch.setattr("uvicorn.Server.run", lambda _, sockets: [one.close() for one in sockets])
    monkeypatch.setattr(server, "log_to_stderr", lambda: None)
    monkeypatch.setattr("signal.signal", lambda *_: None)
    monkeypatch.setattr(server, "JobService", lambda _: None)
    with caplog.at_level(logging.INFO, "shapersmith"):
        server.serve(Settings(), host=host, port=0)
    (line,) = [one.getMessage() for one in caplog.records if "serving" in one.getMessage()]
    assert line.startswith(f"serving on {address}")
    assert line.endswith("/docs")
