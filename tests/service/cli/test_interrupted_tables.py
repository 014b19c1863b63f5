"""Tables that are interrupted, killed or out of space, and go on."""

import json
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import CRANE
from tests.patience import PATIENT_S
from tests.processes import children, end
from tests.service.cli.table_runs import SMALL, begun, table, table_apart
from tests.service.http.test_tables_over_http import TABLE

LONG = {**SMALL, "design": CRANE, "axes": [{**SMALL["axes"][0], "points": 4000}]}


def test_of_two_jobs_that_write_one_file_the_second_is_refused(spec: Path, tmp_path: Path) -> None:
    spec.write_text(json.dumps(LONG))
    path = tmp_path / "t.csv"
    with begun(spec, path):
        second = table(spec, "-o", path)
        assert second.returncode == 1
        assert f"another shapersmith is writing {path}" in second.stderr
    small = tmp_path / "small.json"
    small.write_text(json.dumps(SMALL))
    after = table(small, "-o", path)  # the lock has died with its holder
    assert after.returncode == 0, after.stderr
    assert "is dropped" in after.stderr


def test_an_interrupt_leaves_the_job_to_be_resumed(spec: Path, tmp_path: Path) -> None:
    spec.write_text(json.dumps(LONG))
    path = tmp_path / "t.csv"
    with begun(spec, path) as process:
        process.send_signal(signal.SIGINT)
        _, told = process.communicate(timeout=PATIENT_S)
    assert process.returncode == 1
    assert "the same command goes on where it was" in told
    assert "Traceback" not in told
    assert not path.exists()
    with begun(spec, path) as process:
        process.send_signal(signal.SIGINT)
        _, told = process.communicate(timeout=PATIENT_S)
    assert re.search(r"going on at [\d,]+ rows", told)


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    folder = tmp_path / "disk"
    folder.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=700k", "tmpfs", str(folder)],
        capture_output=True,
        check=False,
    )
    if mounted.returncode != 0:
        pytest.skip("no file system can be mounted here: " + mounted.stderr.decode().strip())
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=True)


def test_a_full_disk_is_told_and_the_job_goes_on_when_there_is_space(
    small_disk: Path, tmp_path: Path
) -> None:
    spec = tmp_path / "spec.json"
    spec.write_text(json.dumps(TABLE))
    filler = small_disk / "filler"
    filler.write_bytes(bytes(560_000))
    path = small_disk / "t.csv"
    full = table_apart(spec, "-o", path)
    assert full.returncode == 1, full.stderr
    assert "no space left" in full.stderr.lower()
    assert "Traceback" not in full.stderr
    assert not path.exists()
    filler.unlink()
    done = table(spec, "-o", path)
    assert done.returncode == 0, done.stderr
    undisturbed = tmp_path / "u.csv"
    assert table(spec, "-o", undisturbed).returncode == 0
    assert path.read_bytes() == undisturbed.read_bytes()


def test_a_disk_that_is_full_for_the_file_alone_keeps_the_rows(
    small_disk: Path, tmp_path: Path
) -> None:
    spec = tmp_path / "spec.json"
    axes = [{**SMALL["axes"][0], "points": 4000}]
    spec.write_text(json.dumps({**SMALL, "axes": axes, "chunk_rows": 1000}))
    path = small_disk / "t.csv"
    filler = small_disk / "filler"
    filler.write_bytes(bytes(100_000))
    full = table_apart(spec, "-o", path)
    assert full.returncode == 1, full.stderr
    assert "nothing is lost, the same command goes on where it was" in full.stderr
    assert sorted(left.name for left in small_disk.iterdir()) == [".t.csv.job", "filler"]
    subprocess.run(["mount", "-o", "remount,size=5m", str(small_disk)], check=True)
    done = table(spec, "-o", path)
    assert done.returncode == 0, done.stderr
    assert len(path.read_text().splitlines()) == 4009


def test_workers_killed_in_their_chunks_cost_nothing_but_time(spec: Path, tmp_path: Path) -> None:
    from service.jobs.store import MAX_FAILURES

    spec.write_text(json.dumps({**LONG, "axes": [{**SMALL["axes"][0], "points": 600}]}))
    path, undisturbed = tmp_path / "t.csv", tmp_path / "u.csv"
    killed: set[int] = set()
    with begun(spec, path) as process:
        while len(killed) <= MAX_FAILURES and process.poll() is None:
            # The fork server is a child, the workers are children of that.
            below = [children(pid) for pid in children(process.pid)]
            found = set().union(*below) - killed
            if found and end(max(found)):
                killed.add(max(found))
            time.sleep(0.02)
        _, told = process.communicate(timeout=PATIENT_S)
    assert process.returncode == 0, told
    assert "killed" in told or "died" in told
    assert table(spec, "-o", undisturbed).returncode == 0
    assert path.read_bytes() == undisturbed.read_bytes()
