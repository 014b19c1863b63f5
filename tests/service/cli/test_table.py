"""The command `table`."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from service.cli.table import run_table
from service.problems import Problem
from tests.conftest import free_port
from tests.patience import PATIENT_S
from tests.processes import until
from tests.service.cli.table_runs import SMALL, table, table_apart
from tests.service.cli.test_main import names_of
from tests.service.http.test_tables_over_http import HEAVILY_DAMPED, TABLE


def answers(address: str) -> bool:
    """Return whether somebody listens at an address of Dask."""
    host, port = address.removeprefix("tcp://").split(":")
    with socket.socket() as asking:
        return asking.connect_ex((host, int(port))) == 0


@contextmanager
def cluster(workers: int) -> Iterator[str]:
    """Run a real Dask scheduler and worker processes, by Dask's own commands."""
    address = f"tcp://127.0.0.1:{free_port()}"
    started = [
        subprocess.Popen(
            [
                *(sys.executable, "-m", f"distributed.cli.dask_{name}"),
                *(*arguments, "--no-dashboard"),
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        for name, arguments in (
            ("scheduler", ["--host", "127.0.0.1", "--port", address.rpartition(":")[2]]),
            *(("worker", [address, "--nthreads", "2", "--no-nanny"]) for _ in range(workers)),
        )
    ]
    try:
        until(lambda: answers(address), "the scheduler does not answer")
        yield address
    finally:
        for process in started:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait(PATIENT_S)


def test_the_bytes_are_the_same_on_any_number_of_workers_and_on_dask(
    spec: Path, tmp_path: Path
) -> None:
    files = {}
    for workers in (1, 2, 4):
        path = tmp_path / f"{workers}.csv"
        done = table_apart(spec, "-o", path, "--workers", workers)
        assert done.returncode == 0, done.stderr
        files[str(workers)] = path.read_bytes()
    with cluster(2) as address:
        path = tmp_path / "dask.csv"
        done = table(spec, "-o", path, "--scheduler", address)
        assert done.returncode == 0, done.stderr
        files["dask"] = path.read_bytes()
    assert len(set(files.values())) == 1
    assert b"verified" in files["1"]
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_a_scheduler_that_is_none_is_one_readable_line(spec: Path, tmp_path: Path) -> None:
    told = table(spec, "-o", tmp_path / "x.csv", "--scheduler", "nonsense://x")
    assert told.returncode == 1
    assert "address is tcp://HOST:PORT, got 'nonsense://x'" in told.stderr
    assert "Traceback" not in told.stderr


@pytest.mark.parametrize("end", ["csv", "parquet"])
def test_check_catches_one_changed_digit_and_nothing_else(
    spec: Path, tmp_path: Path, end: str
) -> None:
    path = tmp_path / f"t.{end}"
    assert table(spec, "-o", path).returncode == 0
    assert table(spec, "--check", path).returncode == 0
    if end == "csv":
        text = path.read_text()
        (found,) = re.findall(r"^0\.5,0\.0,(\d\.\d+),", text, re.MULTILINE)
        changed = f"{found[:8]}{(int(found[8]) + 1) % 10}{found[9:]}"
        path.write_text(text.replace(found, changed))
    else:
        import pyarrow as pa
        from pyarrow import parquet

        whole = parquet.read_table(path)
        values = whole.column("t2_s").to_pylist()
        values[0] += 1e-7
        column = whole.column_names.index("t2_s")
        whole = whole.set_column(column, whole.schema.field("t2_s"), pa.array(values))
        parquet.write_table(whole, path)
    drifted = table(spec, "-o", path, "--check")
    assert drifted.returncode == 5, drifted.stderr
    assert "row 0, t2_s" in drifted.stderr
    assert "1 difference" in drifted.stderr


def test_check_tells_missing_rows_and_another_specification(spec: Path, tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    assert table(spec, "-o", path).returncode == 0
    whole = path.read_text()
    path.write_text(whole[: whole.rindex("\n", 0, -1) + 1])
    missing = table(spec, "--check", path)
    assert (missing.returncode, "as its head says, got '39 rows'" in missing.stderr) == (5, True)
    path.write_text(whole)
    spec.write_text(json.dumps({**SMALL, "chunk_rows": 5}))
    other = table(spec, "--check", path)
    assert (other.returncode, "another specification" in other.stderr) == (5, True)
    assert table(spec, "--check", tmp_path / "none.csv").returncode == 1


def test_a_name_that_tells_no_format_is_refused(spec: Path, tmp_path: Path) -> None:
    told = table(spec, "-o", tmp_path / "t.c")
    assert (told.returncode, "/format: must be given, or" in told.stderr) == (2, True)
    assert not (tmp_path / "t.c").exists()


def test_a_table_never_overwrites_what_it_is_made_of(tmp_path: Path) -> None:
    spec = tmp_path / "t.json"
    content = json.dumps(TABLE)
    spec.write_text(content)
    for name in names_of(spec, "t.json"):
        refused = table(spec, "-o", name)
        assert (refused.returncode, refused.stdout) == (2, "")
        assert f"cannot write {name}: it is the specification itself" in refused.stderr
        assert spec.read_text() == content
    listed = tmp_path / "designs.json"
    lines = '{"plant": {"cable_length_m": 0.7}}\n{"plant": {"cable_length_m": 0.8}}\n'
    listed.write_text(lines)
    of_lines = {key: value for key, value in TABLE.items() if key != "axes"}
    spec.write_text(json.dumps({**of_lines, "designs_file": "designs.json"}))
    for name in names_of(listed, "designs.json"):
        refused = table(spec, "-o", name)
        assert (refused.returncode, refused.stdout) == (2, "")
        told = "it is a link to" if name.is_symlink() else "it is designs.json, which lists"
        assert f"cannot write {name}: {told}" in refused.stderr
        assert listed.read_text() == lines
    assert table(spec, "-o", tmp_path / "t.csv").returncode == 0


def test_a_table_replaces_no_device_link_or_read_only_file(tmp_path: Path, spec: Path) -> None:
    (link := tmp_path / "link.csv").symlink_to(tmp_path / "nowhere.csv")
    (fixed := tmp_path / "fixed.csv").write_bytes(b"kept")
    fixed.chmod(0o444)
    for path, told in ((link, "a link to"), (fixed, "read-only"), (Path("/dev/null"), "a device")):
        refused = table(spec, "-o", path, "--format", "csv")
        assert (refused.returncode, refused.stdout) == (2, "")
        assert f"cannot write {path}: it is {told}" in refused.stderr
    assert fixed.read_bytes() == b"kept"


def test_tolerances_are_those_of_the_specification(spec: Path, tmp_path: Path) -> None:
    spec.write_text(json.dumps({**SMALL, "tolerances": {"absolute": 1e-3, "relative": 0}}))
    path = tmp_path / "t.csv"
    assert table(spec, "-o", path).returncode == 0
    text = path.read_text()
    (found,) = re.findall(r"^0\.5,0\.0,(\d\.\d+),", text, re.MULTILINE)
    path.write_text(text.replace(found, repr(float(found) + 9e-4)))
    assert table(spec, "--check", path).returncode == 0
    path.write_text(text.replace(found, repr(float(found) + 2e-3)))
    assert table(spec, "--check", path).returncode == 5


def test_toml_gives_what_json_gives(spec: Path, tmp_path: Path) -> None:
    toml = tmp_path / "spec.toml"
    toml.write_text(
        """
        chunk_rows = 4
        [design]
        shaper = {kind = "numzv"}
        plant = {kind = "pendulum", cable_length_m = 0.8, gravity_m_s2 = 9.81}
        [design.actuator]
        kind = "second_order"
        accel = {natural_frequency_rad_s = 20, damping_ratio = 0.8}
        decel = {natural_frequency_rad_s = 50, damping_ratio = 1.5}
        [[axes]]
        field = "/plant/cable_length_m"
        from = 0.5
        to = 1.0
        points = 40
        """
    )
    for given in (spec, toml):
        done = table(given, "-o", tmp_path / f"{given.suffix}.csv")
        assert done.returncode == 0, done.stderr
    assert (tmp_path / ".json.csv").read_bytes() == (tmp_path / ".toml.csv").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((), "needs -o FILE"),
        (("--check",), "--check takes a file"),
        (("-o", "/none/x.csv"), "there is no folder /none"),
        (("-o", "/tmp"), "it is a folder"),
        (("-o", "/tmp/x.csv", "--workers", "0"), "--workers must be"),
    ],
)
def test_faulty_usage_is_named(spec: Path, arguments: tuple[str, ...], told: str) -> None:
    refused = table(spec, *arguments)
    assert (refused.returncode, told in refused.stderr) == (2, True)


def test_what_a_format_finds_in_the_rows_is_invalid_input(tmp_path: Path) -> None:
    spec, path = tmp_path / "spec.json", tmp_path / "x.gcode"
    spec.write_text(json.dumps(HEAVILY_DAMPED))
    done = table(spec, "-o", path, "--workers", "1")
    assert done.returncode == 2, done.stderr
    assert "damping_ratio of row 1: must be at most 0.3 for Klipper's 2hump_ei" in done.stderr
    assert not path.exists()


@pytest.mark.parametrize("end", ["h", "st"])
def test_a_program_that_was_called_otherwise_since_is_checked_by_its_own_names(
    spec: Path, tmp_path: Path, end: str
) -> None:
    before, after = tmp_path / f"crane.{end}", tmp_path / f"2nd try.{end}"
    assert table(spec, "-o", before, "--workers", "1").returncode == 0
    assert b"crane_shaper" in before.read_bytes()
    before.rename(after)
    done = table(spec, "--check", after, "--workers", "1")
    assert done.returncode == 0, done.stderr
    text = after.read_text()
    place = text.index("all_times_s" if end == "st" else "crane_times[")
    digit = next(at for at in range(place + 40, len(text)) if text[at] in "12345678")
    after.write_text(f"{text[:digit]}9{text[digit + 1 :]}")
    done = table(spec, "--check", after, "--workers", "1")
    assert done.returncode == 5, done.stderr
    assert "1 difference" in done.stderr


def test_a_name_without_a_format_has_a_code(tmp_path: Path) -> None:
    options = Namespace(
        request=str(tmp_path / "spec.json"), output=tmp_path / "t.c", check=None, format=None
    )
    told = run_table(options, json.dumps(SMALL).encode())
    assert isinstance(told, Problem)
    assert (told.code, told.errors[0].pointer) == ("format_unknown", "/format")
