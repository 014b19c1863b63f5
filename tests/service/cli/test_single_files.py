"""A single design as a program or a line of firmware: read back, or refused by name."""

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.export.registry import EXPORTS
from design.tables.compute import compute_rows
from schemas.design_request import DesignRequest
from service.cli.single_file import Written, design_file
from service.jobs.plan import Plan, head_of, plan_table, specification_of
from service.operations.design import design_shaper
from service.problems import Problem
from tests.readers import read_back
from tests.service.cli.commands import COMMAND, shapersmith

MODE = {"kind": "mode", "natural_frequency_rad_s": 250.0, "damping_ratio": 0.05}
TWO_MODES: dict[str, Any] = {
    "kind": "modes",
    "modes": [
        {"natural_frequency_rad_s": 35.0, "damping_ratio": 0.01},
        {"natural_frequency_rad_s": 94.0, "damping_ratio": 0.02},
    ],
}
SLUNG = {
    "kind": "double_pendulum",
    "hook_mass_kg": 0.385,
    "load_mass_kg": 0.6,
    "cable_length_m": 0.8,
    "load_length_m": 0.25,
}
RANGE = {
    "kind": "scheduled",
    "plant": MODE,
    "over": "natural_frequency_rad_s",
    "from": 240.0,
    "to": 260.0,
}
IDEAL = {"kind": "ideal"}
DRIVE = {
    "kind": "second_order",
    "accel": {"natural_frequency_rad_s": 2500, "damping_ratio": 0.8},
    "decel": {"natural_frequency_rad_s": 3500, "damping_ratio": 1.5},
}
POSITIVE, UNITY = "of positive impulses for RepRapFirmware", "one of Klipper's own"
SAMPLED = "/shaper/sample_time_s: must be left out for Klipper"

CASES: list[tuple[dict[str, Any], dict[str, Any], dict[str, Any], dict[str, str]]] = [
    # plant, actuator, shaper, what is refused by which words
    (MODE, IDEAL, {"kind": "zv"}, {}),
    (MODE, IDEAL, {"kind": "zvd"}, {}),
    (MODE, IDEAL, {"kind": "mzv", "t": 0.6}, {}),
    (MODE, IDEAL, {"kind": "ei", "tolerance": 0.02}, {}),
    (MODE, DRIVE, {"kind": "zvddd"}, {"klipper": UNITY}),
    (MODE, IDEAL, {"kind": "si"}, {"klipper": UNITY}),
    (MODE, IDEAL, {"kind": "zvd", "sample_time_s": 0.001}, {"klipper": SAMPLED}),
    (MODE, IDEAL, {"kind": "ei", "tolerance": 0.1, "sample_time_s": 0.001}, {"klipper": SAMPLED}),
    (RANGE, IDEAL, {"kind": "ei", "tolerance": 0.1}, {}),
    (MODE, IDEAL, {"kind": "numzv"}, {"klipper": UNITY, "rrf": POSITIVE}),
    (MODE, DRIVE, {"kind": "numzvd"}, {"klipper": UNITY, "rrf": POSITIVE}),
    (MODE, DRIVE, {"kind": "umzv"}, {"klipper": UNITY, "rrf": POSITIVE}),
    (MODE, IDEAL, {"kind": "num_si", "half_width": 0.1}, {"klipper": UNITY, "rrf": POSITIVE}),
    (TWO_MODES, IDEAL, {"kind": "multi_zv"}, {"klipper": UNITY}),
    (TWO_MODES, DRIVE, {"kind": "multi_zv"}, {"klipper": UNITY}),
    (TWO_MODES, IDEAL, {"kind": "convolved"}, {"klipper": UNITY}),
    (TWO_MODES, IDEAL, {"kind": "multi_umzv"}, {"klipper": UNITY, "rrf": POSITIVE}),
    (SLUNG, DRIVE, {"kind": "num_multi"}, {"klipper": UNITY, "rrf": POSITIVE}),
    (SLUNG, DRIVE, {"kind": "num_multi", "slope": True}, {"klipper": UNITY, "rrf": POSITIVE}),
    (
        TWO_MODES,
        IDEAL,
        {"kind": "convolved", "base": "zvd"},
        {"klipper": UNITY, "rrf": "impulses: must be 2 to 5 for RepRapFirmware, got 9"},
    ),
]

CLOSE = {"c": 1e-15, "st": 1e-15, "rrf": 2e-9, "klipper": 1e-9}
"""Nine decimals in lines for RepRapFirmware, rounding of a formula in Klipper's."""


@pytest.mark.parametrize("name", ["c", "st", "klipper", "rrf"])
@pytest.mark.parametrize(("plant", "actuator", "shaper", "refused"), CASES)
def test_a_design_is_read_back_or_refused_by_name(
    tmp_path: Path,
    plant: dict[str, Any],
    actuator: dict[str, Any],
    shaper: dict[str, Any],
    refused: dict[str, str],
    name: str,
) -> None:
    request = {"plant": plant, "actuator": actuator, "shaper": shaper}
    written = design_file(json.dumps(request).encode(), name)
    if name in refused:
        assert isinstance(written, Problem)
        assert refused[name] in written.detail
        return
    assert isinstance(written, Written), written
    wanted = design_shaper(DesignRequest.model_validate(request)).shaper.impulses
    (held,) = read_back(name, written.content, tmp_path)
    for found in held.impulses:
        if shaper["kind"] == "ei" and name == "klipper":
            continue  # Klipper's fit, judged in tests/design/export/test_klipper.py
        np.testing.assert_allclose(
            found.times_s, wanted.times_s, atol=CLOSE[name], rtol=CLOSE[name]
        )
        np.testing.assert_allclose(found.amplitudes, wanted.amplitudes, atol=CLOSE[name], rtol=0)
    if name in {"c", "st"}:
        assert held.status == (3 if shaper["kind"] == "umzv" else 0)


@pytest.mark.parametrize(("plant", "actuator", "shaper", "refused"), CASES[:-1:2])
def test_a_table_of_the_design_itself_has_one_row(
    tmp_path: Path,
    plant: dict[str, Any],
    actuator: dict[str, Any],
    shaper: dict[str, Any],
    refused: dict[str, str],
) -> None:
    from design.export.registry import EXPORTS
    from design.tables.compute import compute_rows
    from service.jobs.plan import Plan, head_of, plan_table, specification_of

    if "sample_time_s" in shaper:
        return  # as wide as its rows, in tests/design/tables/test_sampled_rows.py
    request = {"plant": plant, "actuator": actuator, "shaper": shaper}
    body = {"design": request, "designs": [{}], "columns": ["times_s", "amplitudes", "residual"]}
    plan = plan_table(json.dumps(body).encode())
    assert isinstance(plan, Plan), plan
    assert plan.size.rows == 1
    job = plan.job
    rows = compute_rows(specification_of(job.specification, job.impulses), 0, 1)
    wanted = design_shaper(DesignRequest.model_validate(request)).shaper.impulses
    for name, export in EXPORTS.items():
        if name in refused or name == "marlin":  # of zv alone, in tests/design/export
            continue
        head = head_of(job, fitted=False)
        export.checks(head)
        (held,) = read_back(name, b"".join(export.write(head, [rows])), tmp_path)
        if shaper["kind"] != "ei" or name != "klipper":
            np.testing.assert_allclose(held.impulses[0].times_s, wanted.times_s, atol=2e-9)


def test_the_command_prints_the_file() -> None:
    request = json.dumps({"plant": MODE, "actuator": IDEAL, "shaper": {"kind": "zv"}})
    told = {}
    for name in ("c", "klipper"):
        done = shapersmith("design", "-", "--format", name, given=request)
        assert (done.returncode, done.stderr) == (0, "")
        told[name] = done.stdout
    assert "SET_INPUT_SHAPER SHAPER_TYPE_X=zv " in told["klipper"]
    assert "static inline int zv_" in told["c"]


def test_several_designs_that_vary_nothing_are_refused() -> None:
    from service.jobs.plan import plan_table

    body = {
        "design": {"plant": MODE, "actuator": IDEAL, "shaper": {"kind": "umzv"}},
        "designs": [{}, {}],
    }
    problem = plan_table(json.dumps(body).encode())
    assert isinstance(problem, Problem)
    assert (
        "designs: must be one or more; where more than one, they vary something, got 2"
        in problem.detail
    )


def test_a_table_goes_over_the_load_below_a_hook() -> None:
    """Steps for several modes are as many whatever the modes are."""
    request = {"plant": SLUNG, "actuator": DRIVE, "shaper": {"kind": "num_multi"}}
    masses = [0.4, 0.6, 0.8]
    body = {
        "design": request,
        "axes": [{"field": "/plant/load_mass_kg", "values": masses}],
        "columns": ["times_s", "amplitudes", "residual"],
    }
    plan = plan_table(json.dumps(body).encode())
    assert isinstance(plan, Plan), plan
    assert plan.job.impulses == 5
    rows = compute_rows(specification_of(plan.job.specification, plan.job.impulses), 0, 3)
    assert rows.status.tolist() == [0, 0, 0]
    for row, mass in enumerate(masses):
        asked = {**request, "plant": {**SLUNG, "load_mass_kg": mass}}
        single = design_shaper(DesignRequest.model_validate(asked)).shaper.impulses
        assert rows.results[row, :5].tolist() == list(single.times_s)


@pytest.mark.parametrize("base", ["zv", "umzv", "ei"])
def test_a_table_goes_over_the_modes_of_a_plant(tmp_path: Path, base: str) -> None:
    """A convolved shaper has as many impulses whatever the modes are."""
    frequencies = [30.0, 33.0, 36.0]
    request = {"plant": TWO_MODES, "actuator": IDEAL, "shaper": {"kind": "convolved", "base": base}}
    body = {
        "design": request,
        "axes": [
            {"field": "/plant/modes/0/natural_frequency_rad_s", "values": frequencies},
            {"field": "/plant/modes/1/damping_ratio", "values": [0.0, 0.03]},
        ],
        "columns": ["times_s", "amplitudes", "residual", "slope"],
    }
    plan = plan_table(json.dumps(body).encode())
    assert isinstance(plan, Plan), plan
    rows = compute_rows(specification_of(plan.job.specification, plan.job.impulses), 0, 6)
    head = head_of(plan.job, fitted=False)
    held = read_back("c", b"".join(EXPORTS["c"].write(head, [rows])), tmp_path)
    assert len(held) == 6
    for one in held:
        (first, damping), status = one.numbers[:2], one.status
        modes = [
            {**TWO_MODES["modes"][0], "natural_frequency_rad_s": first},
            {**TWO_MODES["modes"][1], "damping_ratio": damping},
        ]
        asked = {**request, "plant": {"kind": "modes", "modes": modes}}
        answer = design_file(json.dumps(asked).encode(), "c")
        if isinstance(answer, Problem):
            assert status in {1, 2}
            continue
        assert status == 0
        single = design_shaper(DesignRequest.model_validate(asked))
        np.testing.assert_array_equal(one.impulses[0].times_s, single.shaper.impulses.times_s)
        np.testing.assert_array_equal(one.impulses[0].amplitudes, single.shaper.impulses.amplitudes)
        assert one.numbers[-2] == single.residual


@pytest.mark.parametrize(
    ("plant", "kind", "field", "words"),
    [
        (
            TWO_MODES,
            "multi_zv",
            "/plant/modes/0/damping_ratio",
            "the same number of impulses in every row",
        ),
        (TWO_MODES, "zv", "/plant/modes/0/damping_ratio", "a plant of one mode for zv"),
        (MODE, "si", "/plant/damping_ratio", "the same number of impulses in every row"),
        (TWO_MODES, "convolved", "/plant/modes/2/damping_ratio", "must be one of 0, 1"),
        (TWO_MODES, "convolved", "/plant/modes", "the name of a number"),
        (
            RANGE,
            "umzv",
            "/actuator/dead_time_s",
            "a plant of one frequency where there are several",
        ),
    ],
)
def test_tables_whose_rows_differ_in_kind_are_refused_by_name(
    plant: dict[str, Any], kind: str, field: str, words: str
) -> None:
    body = {
        "design": {"plant": plant, "actuator": DRIVE, "shaper": {"kind": kind}},
        "axes": [{"field": field, "values": [0.01, 0.02]}],
        "columns": ["times_s", "amplitudes"],
    }
    problem = plan_table(json.dumps(body).encode())
    assert isinstance(problem, Problem)
    assert words in problem.detail


@pytest.mark.parametrize("name", ["twincat", "arduino"])
def test_an_archive_is_written_as_it_is(tmp_path: Path, name: str) -> None:
    request = tmp_path / "design.json"
    request.write_text(json.dumps({"plant": MODE, "actuator": IDEAL, "shaper": {"kind": "zv"}}))
    wanted = design_file(request.read_bytes(), name)
    assert isinstance(wanted, Written)
    done = shapersmith("design", request, "--format", name, "-o", tmp_path / "design.zip")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "design.zip").read_bytes() == wanted.content
    printed = subprocess.run(
        [*COMMAND, "design", str(request), "--format", name], capture_output=True, check=True
    )
    assert printed.stdout == wanted.content


@pytest.mark.parametrize("shaper", [{"kind": "numzvd"}, {"kind": "zvd", "sample_time_s": 0.001}])
def test_a_design_is_written_in_single_precision(shaper: dict[str, Any]) -> None:
    request = {"plant": MODE, "actuator": IDEAL, "shaper": shaper}
    body = json.dumps(request)
    texts = {}
    for real in ("LREAL", "REAL"):
        done = shapersmith("design", "-", "--format", "st", "--real", real, given=body)
        assert (done.returncode, done.stderr) == (0, "")
        texts[real] = done.stdout
        assert set(re.findall(r"\bL?REAL\b", done.stdout)) == {real}
    wanted = design_shaper(DesignRequest.model_validate(request)).shaper.impulses
    (held,) = read_back("st", texts["REAL"].encode(), Path())
    np.testing.assert_allclose(held.impulses[0].times_s, wanted.times_s, rtol=1e-7)
    # Blocks of either type may be in one program.
    names = [set(re.findall(r"FUNCTION_BLOCK (\w+)", text)) for text in texts.values()]
    assert not names[0] & names[1]
    for name in ("plcopen", "twincat", "scl"):
        written = design_file(body.encode(), name, "REAL")
        assert isinstance(written, Written)
        (other,) = read_back(name, written.content, Path())
        np.testing.assert_array_equal(other.impulses[0].times_s, held.impulses[0].times_s)


@pytest.mark.parametrize("name", [None, "json", "c", "klipper"])
def test_a_type_of_numbers_is_refused_where_there_is_none(name: str | None) -> None:
    form = [] if name is None else ["--format", name]
    done = shapersmith("design", "-", *form, "--real", "REAL", given={})
    assert done.returncode == 2
    assert f"--real goes with st, plcopen, twincat, scl, not with {name or 'json'}" in done.stderr


FORMATS_OF = {
    "design": ["c", "st", "plcopen", "twincat", "scl", "arduino", "csv"],
    "maneuver": ["c", "st", "plcopen", "twincat", "scl", "csv"],
}


@pytest.mark.parametrize(
    ("command", "name"), [(one, name) for one, names in FORMATS_OF.items() for name in names]
)
def test_a_value_that_is_hardly_meant_is_said_beside_a_file(command: str, name: str) -> None:
    plant = {"kind": "pendulum", "cable_length_m": 800}
    move = {"speed_m_s": 1, "distance_m": 200} if command == "maneuver" else {}
    request = {"plant": plant, "actuator": IDEAL, "shaper": {"kind": "umzv"}, **move}
    done = subprocess.run(
        [*COMMAND, command, "-", "--format", name],
        input=json.dumps(request).encode(),
        capture_output=True,
        check=True,
    )
    assert done.stdout
    (told,) = done.stderr.decode().splitlines()
    assert told.startswith("shapersmith: warning: implausible_value: /plant/cable_length_m: 800 m")


@pytest.mark.parametrize("command", FORMATS_OF)
def test_a_name_that_stands_twice_is_refused_for_a_file_too(command: str) -> None:
    text = '{"plant": {"kind": "pendulum", "cable_length_m": 1, "cable_length_m": 2}, '
    text += '"actuator": {"kind": "ideal"}, "shaper": {"kind": "umzv"}'
    text += ', "speed_m_s": 1, "distance_m": 9}' if command == "maneuver" else "}"
    for name in FORMATS_OF[command]:
        done = shapersmith(command, "-", "--format", name, given=text)
        assert (done.returncode, done.stdout) == (2, "")
        assert "cable_length_m" in done.stderr
