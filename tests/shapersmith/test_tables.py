"""A table of here is that of a service, byte by byte, and refused in the same words."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import shapersmith
from service.jobs.plan import plan_table
from service.problems import Problem
from tests.conftest import CRANE, Running
from tests.patience import PATIENT_S

Table = Any
"""`table` of the package or of a client."""

ON_SAMPLES = {
    "design": {
        "plant": shapersmith.Pendulum(cable_length_m=0.8),
        "actuator": shapersmith.Ideal(),
        "shaper": shapersmith.shaper("umzv", sample_time_s=0.02),
    },
    "axes": [shapersmith.TableAxis(field="/plant/cable_length_m", values=[0.6, 0.8])],
}
"""Rows that need no compiled code."""

FAULTY = {"design": CRANE, "axes": [{"field": "/plant/cable_length_m", "values": [-1.0]}]}


@pytest.fixture
def remote(service: Running, monkeypatch: pytest.MonkeyPatch) -> shapersmith.Client:
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    return shapersmith.Client(service.address, timeout_s=PATIENT_S)


@pytest.fixture(params=["here", "remote"])
def table(request: pytest.FixtureRequest) -> Table:
    if request.param == "here":
        return shapersmith.table
    return request.getfixturevalue("remote").table


@pytest.mark.parametrize("format", ["csv", "c"])
def test_a_service_writes_the_same_file(
    tmp_path: Path, remote: shapersmith.Client, format: str
) -> None:
    near, far = tmp_path / "near" / "table", tmp_path / "far" / "table"
    for path, write in ((near, shapersmith.table), (far, remote.table)):
        path.parent.mkdir()
        job = write(ON_SAMPLES, path, format)
        assert (job.state, job.size.rows, job.verified) == ("done", 2, 2)
    assert [path.name for path in near.parent.iterdir()] == ["table"]
    if format == "csv":  # names in programs are made from that of the file, which a service has not
        assert near.read_bytes() == far.read_bytes()


def test_a_faulty_specification_is_refused_as_http_refuses_it(tmp_path: Path, table: Table) -> None:
    problem = plan_table(json.dumps(FAULTY).encode())
    assert isinstance(problem, Problem)
    with pytest.raises(shapersmith.InvalidInputError) as caught:
        table(FAULTY, tmp_path / "table.csv", "csv")
    assert (caught.value.detail, caught.value.errors) == (problem.detail, problem.errors)
    assert not [*tmp_path.iterdir()]


def test_a_format_that_there_is_not_is_named(tmp_path: Path, table: Table) -> None:
    with pytest.raises(
        shapersmith.InvalidInputError, match="/format: must be one of csv"
    ) as caught:
        table(ON_SAMPLES, tmp_path / "table.xls", "xls")
    assert caught.value.code == "format_not_served"


def test_what_is_no_file_is_not_replaced(tmp_path: Path, table: Table) -> None:
    with pytest.raises(shapersmith.InvalidInputError, match=str(tmp_path)):
        table(ON_SAMPLES, tmp_path, "csv")


def test_a_table_that_has_failed_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("no rows today")

    monkeypatch.setattr("service.jobs.work.compute_rows", fail)
    with pytest.raises(shapersmith.SolverFailedError, match="no rows today"):
        shapersmith.table(ON_SAMPLES, tmp_path / "table.csv", "csv")
    assert not [*tmp_path.iterdir()]


def test_a_script_without_a_guard_writes_a_table(tmp_path: Path) -> None:
    """A script has no ``if __name__ == "__main__"``: whatever starts it anew would run it again."""
    axis = {"field": "/plant/cable_length_m", "values": [0.6, 0.8]}
    specification = {"design": {**CRANE, "shaper": {"kind": "numzv"}}, "axes": [axis]}
    script = tmp_path / "script.py"
    script.write_text(
        f"""
import shapersmith
print("begun")
job = shapersmith.table({specification!r}, "table.csv", "csv")
print(job.verified)
"""
    )
    done = subprocess.run(
        [sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.split() == ["begun", "2"]
