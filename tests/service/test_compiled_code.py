"""Machine code is kept where it can be written, and compiled ahead where that is asked for."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from design.shapers.registry import SHAPERS
from schemas.runs import RunResponse
from service import compiled_code
from service.dispatch import respond
from service.jobs.warming import RUN, tables
from tests.patience import PATIENT_S
from tests.processes import until


@pytest.fixture
def code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder that stands for that of the code."""
    monkeypatch.delenv(compiled_code.VARIABLE, raising=False)
    monkeypatch.setattr(compiled_code, "CODE", tmp_path / "code")
    (tmp_path / "code").mkdir()
    return tmp_path / "code"


def read_only(code: Path) -> None:
    """Let nobody write where machine code is kept beside the source, not even root."""
    (code / "__pycache__").write_bytes(b"")


def test_machine_code_stays_beside_a_source_that_can_be_written(code: Path, tmp_path: Path) -> None:
    compiled_code.keep_in(str(tmp_path / "data"))
    assert compiled_code.VARIABLE not in os.environ
    assert list(code.rglob("*")) == [code / "__pycache__"]


def test_machine_code_is_with_the_data_where_the_source_is_read_only(
    code: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read_only(code)
    monkeypatch.chdir(tmp_path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(compiled_code.VARIABLE, "")
        del os.environ[compiled_code.VARIABLE]
        compiled_code.keep_in("data")
        assert os.environ[compiled_code.VARIABLE] == str(tmp_path / "data" / "compiled")


def test_a_folder_that_a_person_has_named_stays(
    code: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read_only(code)
    monkeypatch.setenv(compiled_code.VARIABLE, "elsewhere")
    compiled_code.keep_in(str(tmp_path))
    assert os.environ[compiled_code.VARIABLE] == "elsewhere"


def test_each_kind_and_model_of_which_rows_are_compiled_is_compiled_ahead() -> None:
    made = list(tables())
    kinds = [name for name, kind in SHAPERS.items() if kind.compiled_rows is not None]
    found = [
        (table["design"]["shaper"]["kind"], table["design"]["actuator"]["model"]) for table in made
    ]
    assert found == [(kind, model) for kind in kinds for model in ("superposed", "switched")]


def test_a_command_takes_the_place_of_what_compiled_for_it() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "service.jobs.warming", "printenv", "OPENBLAS_NUM_THREADS"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "1\n"


def test_compiling_ahead_ends_at_the_signal_of_an_engine(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "service.jobs.warming", "false"],
        env=os.environ | {compiled_code.VARIABLE: str(tmp_path / "compiled")},
    )
    until(lambda: any(tmp_path.rglob("*.nbi")) or process.poll() is not None, "nothing is compiled")
    process.terminate()
    assert process.wait(PATIENT_S) == 0


def test_what_is_compiled_ahead_for_runs_is_a_run() -> None:
    answer = respond("run", json.dumps(RUN).encode())
    assert isinstance(answer, RunResponse)
    assert answer.residual is not None
