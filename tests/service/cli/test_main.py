"""The command line."""

import csv
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from service.operations.table import TABLE
from tests.conftest import CRANE
from tests.service.cli.commands import shapersmith, shapersmith_apart
from tests.shapersmith.requests import REQUESTS


def test_design_prints_what_the_service_answers(client: httpx.Client, tmp_path: Path) -> None:
    request = tmp_path / "crane.json"
    request.write_text(json.dumps(CRANE))
    from_file = shapersmith_apart("design", request)
    assert (from_file.returncode, from_file.stderr) == (0, "")
    assert json.loads(from_file.stdout) == client.post("/v1/designs", json=CRANE).json()
    assert shapersmith("design", "-", given=CRANE).stdout == from_file.stdout


def test_the_table_names_what_a_person_asks_for() -> None:
    told = shapersmith("design", "-", "--format", "table", given=CRANE).stdout
    for words in ("0.182117123", "verified", "width 0.25866", "numzvd, 1.32079496 s"):
        assert words in told


def test_the_csv_holds_the_impulses_in_full() -> None:
    told = shapersmith("design", "-", "--format", "csv", given=CRANE).stdout
    rows = list(csv.DictReader(io.StringIO(told)))
    design = json.loads(shapersmith("design", "-", given=CRANE).stdout)
    assert [float(row["time_s"]) for row in rows] == design["shaper"]["impulses"]["times_s"]


def test_sensitivity_and_fit_take_the_same_json() -> None:
    impulses = {"times_s": [0, 0.9], "amplitudes": [0.5, 0.5]}
    curve = shapersmith_apart(
        "sensitivity",
        "-",
        "--format",
        "csv",
        given={
            "impulses": impulses,
            "plant": CRANE["plant"],
            "actuator": {"kind": "ideal"},
            "points": 5,
        },
    )
    assert curve.stdout.splitlines()[0] == "frequency_ratio,residual"
    assert len(curve.stdout.splitlines()) == 6
    fit = {"over": "/plant/cable_length_m", "from": 0.3, "to": 1.4, "degree": 3}
    fitted = shapersmith_apart("fit", "-", "--format", "table", given={**CRANE, "fit": fit})
    assert (
        "x = sqrt(gravity_m_s2 / cable_length_m) / accel.natural_frequency_rad_s" in fitted.stdout
    )


def test_an_edge_that_is_none_is_null_and_told_as_none() -> None:
    never_above = {
        "impulses": {"times_s": [0, 20.943951], "amplitudes": [0.3, 0.3]},
        "plant": {"kind": "mode", "natural_frequency_rad_s": 3, "damping_ratio": 0},
        "actuator": {"kind": "ideal"},
        "tolerance": 0.7,
    }
    band = json.loads(shapersmith("sensitivity", "-", given=never_above).stdout)["sensitivity"][
        "insensitivity"
    ]
    assert band == {
        "tolerance": 0.7,
        "lower_ratio": None,
        "upper_ratio": None,
        "width": None,
        "searched_from_ratio": 1e-3,
        "searched_to_ratio": 100.0,
    }
    told = shapersmith("sensitivity", "-", "--format", "table", given=never_above).stdout
    assert "no lower edge down to 0.001 times, no upper edge up to 100 times" in told


def test_shapers_lists_every_kind() -> None:
    listed = json.loads(shapersmith_apart("shapers").stdout)["shapers"]
    assert "numzvd" in {entry["kind"] for entry in listed}
    assert "numzvd" in shapersmith("shapers", "--format", "table").stdout


BEGINNINGS = {"png": b"\x89PNG", "svg": b"<?xml", "html": b"<!doctype html>"}


@pytest.mark.parametrize("suffix", BEGINNINGS)
def test_plot_writes_a_picture(tmp_path: Path, suffix: str) -> None:
    picture = tmp_path / f"crane.{suffix}"
    assert shapersmith("design", "-", "--plot", str(picture), given=CRANE).returncode == 0
    assert picture.read_bytes().startswith(BEGINNINGS[suffix])
    assert list(tmp_path.iterdir()) == [picture]


@pytest.mark.parametrize("operation", REQUESTS)
def test_every_command_that_answers_draws(tmp_path: Path, operation: str) -> None:
    picture = tmp_path / "answer.svg"
    command = TABLE[operation].command
    drawn = shapersmith(command, "-", "--plot", str(picture), given=REQUESTS[operation])
    assert (drawn.returncode, drawn.stderr) == (0, "")
    assert picture.read_bytes().startswith(BEGINNINGS["svg"])


@pytest.mark.parametrize(
    ("path", "told"),
    [
        pytest.param("nowhere/crane.png", "there is no folder", id="no-folder"),
        pytest.param("crane.gif", "ending in one of .png, .svg, .html", id="suffix"),
    ],
)
def test_a_picture_that_cannot_be_written_is_refused_before_the_work(
    tmp_path: Path, path: str, told: str
) -> None:
    refused = shapersmith("design", "-", "--plot", str(tmp_path / path), given=CRANE)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert told in refused.stderr
    assert list(tmp_path.iterdir()) == []


def names_of(file: Path, name: str) -> list[Path]:
    """Every name by which a file can be reached, the last by a link in its folder's name."""
    hard, soft, folder = (file.parent / f"{kind}-{name}" for kind in ("hard", "soft", "folder"))
    hard.hardlink_to(file)
    soft.symlink_to(file)
    folder.symlink_to(file.parent)
    return [file, hard, soft, file.parent / ".." / file.parent.name / file.name, folder / file.name]


@pytest.mark.parametrize("command", ["design", "map"])
def test_a_picture_never_overwrites_its_request(tmp_path: Path, command: str) -> None:
    request = tmp_path / "crane.png"
    content = json.dumps(CRANE)
    request.write_text(content)
    for name in names_of(request, "x.png"):
        refused = shapersmith(command, str(request), "--plot", str(name))
        assert (refused.returncode, refused.stdout) == (2, "")
        assert f"cannot write {name}: it is the request itself" in refused.stderr
        assert request.read_text() == content
    with request.open() as stdin:
        piped = subprocess.run(
            [sys.executable, "-m", "service", command, "-", "--plot", str(request)],
            stdin=stdin,
            capture_output=True,
            text=True,
            check=False,
        )
    assert (piped.returncode, request.read_text()) == (2, content)


def test_a_picture_replaces_no_device_fifo_or_link(tmp_path: Path) -> None:
    os.mkfifo(fifo := tmp_path / "fifo.png")
    (link := tmp_path / "link.png").symlink_to(tmp_path / "nowhere")
    (fixed := tmp_path / "fixed.png").write_bytes(b"kept")
    fixed.chmod(0o444)
    for path, told in ((fifo, "a FIFO"), (link, "a link to"), (fixed, "read-only")):
        refused = shapersmith("design", "-", "--plot", str(path), given=CRANE)
        assert (refused.returncode, refused.stdout) == (2, "")
        assert f"cannot write {path}: it is {told}" in refused.stderr
    assert fixed.read_bytes() == b"kept"


@pytest.mark.parametrize(
    ("given", "status", "told"),
    [
        pytest.param({**CRANE, "plant": {"kind": "mode"}}, 2, "invalid-input", id="invalid"),
        pytest.param("{", 2, "not-json", id="not-json"),
        pytest.param(
            {**CRANE, "shaper": {"kind": "numzvd", "max_duration_periods": 0.5}},
            3,
            "infeasible",
            id="infeasible",
        ),
    ],
)
def test_errors_are_one_line_and_a_problem_document_on_request(
    given: object, status: int, told: str
) -> None:
    plain = shapersmith("design", "-", given=given)
    assert (plain.returncode, plain.stdout) == (status, "")
    assert plain.stderr.startswith(f"shapersmith: {told}: ")
    assert plain.stderr.count("\n") == 1
    document = json.loads(shapersmith("design", "-", "--format", "json", given=given).stderr)
    assert document["type"] == f"urn:shapersmith:{told}"


def test_a_request_that_is_not_there_is_a_usage_error(tmp_path: Path) -> None:
    missing = shapersmith("design", str(tmp_path / "none.json"))
    assert missing.returncode == 2
    assert "No such file" in missing.stderr


@pytest.mark.parametrize("arguments", [[], ["paint"], ["design"], ["serve", "--port", "70000"]])
def test_wrong_usage_exits_2(arguments: list[str]) -> None:
    assert shapersmith(*arguments).returncode == 2


def test_a_reader_that_leaves_early_is_no_error_message() -> None:
    command = f"{sys.executable} -m service shapers | head -c 10"
    piped = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert piped.stderr == ""


def test_a_folder_for_a_picture_and_a_full_disk_are_one_line(tmp_path: Path) -> None:
    (tmp_path / "d.png").mkdir()
    folder = shapersmith("design", "-", "--plot", str(tmp_path / "d.png"), given=CRANE)
    assert (folder.returncode, folder.stderr.count("\n")) == (2, 1)
    command = f"{sys.executable} -m service shapers > /dev/full"
    full = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert full.returncode == 1
    assert full.stderr.count("\n") == 1
    assert "No space left" in full.stderr


@pytest.mark.parametrize(
    ("plant", "kind"),
    [
        pytest.param(
            {
                "kind": "modes",
                "modes": [
                    {"natural_frequency_rad_s": 9.4, "damping_ratio": 0.02},
                    {"natural_frequency_rad_s": 3.5, "damping_ratio": 0.0},
                ],
            },
            "multi_zv",
            id="two-modes",
        ),
        pytest.param(
            {
                "kind": "scheduled",
                "plant": {"kind": "pendulum", "cable_length_m": 0.8},
                "over": "cable_length_m",
                "from": 0.7,
                "to": 0.9,
            },
            "ei",
            id="range",
        ),
    ],
)
def test_plants_of_more_than_one_frequency_are_drawn(
    plant: dict[str, object], kind: str, tmp_path: Path
) -> None:
    picture = tmp_path / "design.svg"
    request = {"plant": plant, "actuator": {"kind": "ideal"}, "shaper": {"kind": kind}}
    drawn = shapersmith("design", "-", "--plot", str(picture), given=request)
    assert (drawn.returncode, drawn.stderr) == (0, "")
    assert picture.read_text().startswith("<?xml")


def test_a_move_is_drawn(tmp_path: Path) -> None:
    limits = {"accel_limit_m_s2": 0.3, "decel_limit_m_s2": 0.4, "speed_m_s": 1.0}
    request: dict[str, object] = {
        "plant": {"kind": "pendulum", "cable_length_m": 9},
        "actuator": {"kind": "rate_limited", **limits},
        "shaper": {"kind": "numzv"},
        "speed_m_s": 1.0,
        "distance_m": 0.3,
    }
    picture = tmp_path / "move.svg"
    drawn = shapersmith_apart("maneuver", "-", "--plot", str(picture), given=request)
    assert (drawn.returncode, drawn.stderr) == (0, "")
    assert picture.read_text().startswith("<?xml")


def test_the_version_is_printed_as_answers_have_it() -> None:
    told = shapersmith("--version")
    answered = json.loads(shapersmith("design", "-", given=CRANE).stdout)["version"]
    assert (told.returncode, told.stdout) == (0, f"shapersmith {answered}\n")


@pytest.mark.parametrize("arguments", [("design", "-"), ("shapers",)])
def test_json_is_indented_on_request(arguments: tuple[str, ...]) -> None:
    plain = shapersmith(*arguments, given=CRANE).stdout
    for formats in ((), ("--format", "json")):
        pretty = shapersmith(*arguments, "--pretty", *formats, given=CRANE).stdout
        assert pretty.startswith('{\n  "shaper')
        assert json.loads(pretty) == json.loads(plain)
    assert plain.count("\n") == 1


@pytest.mark.parametrize("text_format", ["table", "csv", "st"])
def test_what_is_no_json_is_not_indented(text_format: str) -> None:
    refused = shapersmith("design", "-", "--pretty", "--format", text_format, given=CRANE)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == f"shapersmith: --pretty goes with json, not with {text_format}\n"
