"""Machine code is kept where it can be written, and compiled ahead where that is asked for."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.shapers.registry import SHAPERS
from design.tables import kernel, starts
from design.tables.needed_code import Call, needed_calls
from schemas.runs import RunResponse
from service import compiled_code
from service.dispatch import respond
from service.jobs.plan import Plan, plan_table, specification_of
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
    kinds = [name for name, kind in SHAPERS.items() if kind.compiled_rows is not None]
    designs = [table["design"] for table in tables()]
    found = {(design["shaper"]["kind"], design["actuator"]["model"]) for design in designs}
    assert found == {(kind, model) for kind in kinds for model in ("superposed", "switched")}
    assert any(design["shaper"].get("settle") for design in designs)


@pytest.mark.parametrize("damping_ratio", [0.0, 0.2])
@pytest.mark.parametrize("columns", [["times_s"], ["times_s", "slope"]])
def test_what_is_compiled_ahead_is_all_that_a_table_needs(
    damping_ratio: float, columns: list[str]
) -> None:
    ahead = {called(call) for table in tables() for call in calls_of(table)}
    ahead |= {called(call) for table in tables() for call in calls_of(table, columns=["times_s"])}
    for table in tables():
        table["design"]["plant"]["damping_ratio"] = damping_ratio
        asked = {**table, "designs": [{}], "columns": columns}
        assert {called(call) for call in calls_of(asked)} <= ahead


def calls_of(table: dict[str, Any], **changed: Any) -> Iterator[Call]:
    """Yield the calls that the rows of a table make."""
    plan = plan_table(json.dumps({**table, **changed}).encode())
    assert isinstance(plan, Plan)
    yield from needed_calls(specification_of(plan.job.specification, plan.job.impulses))


def called(call: Call) -> Any:
    """Return what numba compiles for a call: the function, and the types of its arguments."""
    function: Any = call.function
    return function, tuple(map(function.typeof_pyval, call.arguments))


def test_the_search_is_compiled_ahead_as_rows_call_it(monkeypatch: pytest.MonkeyPatch) -> None:
    ahead = {called(Call(*call)) for call in kernel.calls_of_searches()}
    search: Any = starts.fastest
    seen = set()

    def fastest(*arguments: Any) -> float:
        seen.add(called(Call(search, arguments)))
        return float("inf")

    monkeypatch.setattr(kernel, "fastest", fastest)
    for impulses in (3, 5):
        for switched in (False, True):
            row = np.array([[0.1, 0.1, 0.0, 0.1, 0.0, 0.1, 0.1, 0.3]])
            kernel.solve_rows(row, impulses, switched=switched)
    assert seen == ahead


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
