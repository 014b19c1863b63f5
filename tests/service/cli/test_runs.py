"""Runs on the command line: played files, and logs for MATLAB."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from tests.conftest import CRANE
from tests.service.cli.commands import shapersmith

RUN = {"plant": CRANE["plant"], "actuator": CRANE["actuator"], "speed_m_s": 0.2, "points": 51}
PRESS = {"at_s": 0.0, "direction": {"x": 1}, "for_s": 1.0}
COMMAS = "times_s,x_velocity_m_s\n0,0.1\n0.1,0.2\n0.2,0\n"
SEMICOLONS = "times_ms;x_velocity_mm_s\n0;100\n100,0;200,0\n\n200;0\n"


def test_a_log_is_written_for_matlab(tmp_path: Path) -> None:
    request = {**RUN, "events": [PRESS, {"at_s": 0.5, "cable_length_m": 0.6, "over_s": 1.0}]}
    path = tmp_path / "run.mat"
    for _ in range(2):
        done = shapersmith("run", "-", "--format", "mat", "-o", path, given=request)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        written = path.read_bytes()
    assert path.read_bytes() == written  # no date in it
    answer = json.loads(shapersmith("run", "-", given=request).stdout)
    log = loadmat(path)["log"][0, 0]
    history = answer["history"]
    for name in log.dtype.names:
        assert log[name].shape == (51, 1)
        assert log[name].ravel().tolist() == history[name]
    assert {"times_s", "velocity_m_s", "cable_length_m"} <= set(log.dtype.names)


@pytest.mark.parametrize("text", [COMMAS, SEMICOLONS], ids=["commas", "semicolons"])
def test_a_file_is_played(tmp_path: Path, text: str) -> None:
    (tmp_path / "course.csv").write_text(text)
    done = shapersmith("run", "-", "--play", tmp_path / "course.csv", given=RUN)
    assert done.returncode == 0, done.stderr
    course = {"times_s": [0, 0.1, 0.2], "velocity_m_s": [0.1, 0.2, 0]}
    told = shapersmith("run", "-", given={**RUN, "played": {"x": course}})
    assert np.asarray(json.loads(done.stdout)["history"]["deflection_m"]) == pytest.approx(
        np.asarray(json.loads(told.stdout)["history"]["deflection_m"]), abs=1e-12
    )


@pytest.mark.parametrize(
    ("text", "code", "says"),
    [
        ("times_s,x_velocity_m_s\n0,0.1\n0.1\n", "played_line_length", "line 3: 1 numbers under 2"),
        ("times_s,x_velocity_m_s\n0,fast\n", "played_not_number", "line 2: 'fast'"),
        ("times_s,x_velocity_m_s\n0,nan\n", "played_not_number", "line 2: 'nan'"),
        ("times_s\n0\n", "played_headings", "each once; got times_s"),
        ("x_velocity_m_s,x_position_m\n0,0\n", "played_headings", "times_s and others"),
        ("times_s,z_velocity_m_s\n0,0\n", "played_heading_unknown", "'z_velocity_m_s'"),
        ('times_s,x_velocity_m_s\n0,"0.1\n', "played_not_csv", "no CSV"),
        ("times_s,x_velocity_m_s\n0,0.1\n0.1,0.1\n0.9,0.1\n1.0,0\n", "gap_in_times", "0.1 to 0.9"),
    ],
)
def test_a_faulty_file_is_named_by_its_line(
    tmp_path: Path, text: str, code: str, says: str
) -> None:
    path = tmp_path / "course.csv"
    path.write_text(text)
    done = shapersmith("run", "-", "--play", path, "--format", "json", given=RUN)
    assert done.returncode == 2
    problem = json.loads(done.stderr)
    assert problem["code"] == code
    assert says in problem["detail"]


def test_a_file_beside_a_course_and_a_file_of_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "course.csv"
    path.write_text(COMMAS)
    course = {"times_s": [0, 0.1], "velocity_m_s": [0.1, 0]}
    request = {**RUN, "played": {"y": course}}
    done = shapersmith("run", "-", "--play", path, "--format", "json", given=request)
    assert json.loads(done.stderr)["code"] == "played_said_twice"
    path.write_bytes(b"times_s,x_velocity_m_s\n\xff\xff")
    done = shapersmith("run", "-", "--play", path, "--format", "json", given=RUN)
    assert json.loads(done.stderr)["code"] == "played_not_utf8"
    done = shapersmith("run", "-", "--play", tmp_path / "none.csv", given=RUN)
    assert done.returncode == 2
    assert "cannot read" in done.stderr


def test_what_is_no_object_is_refused_as_without_a_file(tmp_path: Path) -> None:
    path = tmp_path / "course.csv"
    path.write_text(COMMAS)
    for given in ("[1]", "{"):
        done = shapersmith("run", "-", "--play", path, given=given)
        assert (done.returncode, done.stderr) == (2, shapersmith("run", "-", given=given).stderr)
