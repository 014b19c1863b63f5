"""Programs of tables on samples, compiled, run and played; what they refuse."""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.export.program import MAX_NUMBERS
from design.tables.columns import times_of
from service.cli.single_file import design_file
from service.problems import Problem
from tests.played_tables import (
    SampledTable,
    computed,
    difference,
    played_by_c,
    played_by_text,
    random_request,
    written,
)
from tests.readers import read_rrf
from tests.refusals import refused
from tests.structured_text import Block

MODE = {"kind": "mode", "natural_frequency_rad_s": 12.0, "damping_ratio": 0.03}

ROWS: dict[str, Any] = {
    "title": "crane",
    "design": {
        "plant": MODE,
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "ei", "sample_time_s": 0.02},
    },
    # The last row has a sample time of more than half a period: no design.
    "axes": [{"field": "/shaper/sample_time_s", "values": [0.02, 0.05, 0.6]}],
    "columns": ["times_s", "amplitudes", "residual"],
}

REFUSES = """
#include <stdio.h>
#include "table.h"
int main(void)
{
    static shapersmith_real memory[CRANE_LINE];
    static crane_shaper shaper;
    crane_start(&shaper, memory, CRANE_LINE, SHAPERSMITH_C(0.5));
    printf("%d ", crane_set(&shaper, 0, SHAPERSMITH_C(0.0201)));
    printf("%d ", crane_set(&shaper, 0, (shapersmith_real)NAN));
    printf("%d ", crane_set(&shaper, 2, SHAPERSMITH_C(0.6)));
    printf("%d ", crane_set(&shaper, 3, SHAPERSMITH_C(0.02)));
    printf("%g ", (double)crane_step(&shaper, SHAPERSMITH_C(0.25)));
    crane_start(&shaper, memory, CRANE_LINE - 1, SHAPERSMITH_C(0.5));
    printf("%d ", crane_set(&shaper, 0, SHAPERSMITH_C(0.02)));
    crane_start(&shaper, memory, CRANE_LINE, SHAPERSMITH_C(0.5));
    printf("%d %d\\n", crane_set(&shaper, 0, SHAPERSMITH_C(0.02)),
           crane_set(&shaper, 1, SHAPERSMITH_C(0.05)));
    return 0;
}
"""


@pytest.fixture(scope="module")
def rows() -> SampledTable:
    return computed(ROWS)


@pytest.mark.parametrize("number", [0, 3, 7, 8, 13, 21])
def test_what_is_played_is_what_was_verified(tmp_path: Path, number: int) -> None:
    table = computed(random_request(number))
    assert difference(table, played_by_c(written(table, "c"), tmp_path)) == ""
    assert difference(table, played_by_text(written(table, "st"))) == ""


def test_another_number_is_played_differently(rows: SampledTable, tmp_path: Path) -> None:
    text = written(rows, "c").decode()
    head, part = text.split("crane_samples[", 1)
    number = str(round(float(times_of(rows.head, rows.rows)[0, 1]) / 0.02))
    other = part.replace(f"{{0, {number},", f"{{0, {int(number) + 1},", 1)
    assert other != part
    changed = f"{head}crane_samples[{other}".encode()
    assert difference(rows, played_by_c(changed, tmp_path)).startswith("row 0: ")


@pytest.mark.parametrize("more", [(), ("-DSHAPERSMITH_FLOAT",)])
def test_the_header_takes_a_row_at_its_sample_time_only(
    rows: SampledTable, tmp_path: Path, more: tuple[str, ...]
) -> None:
    (tmp_path / "table.h").write_bytes(written(rows, "c"))
    (tmp_path / "main.c").write_text(REFUSES)
    flags = ["-Wall", "-Wextra", "-Werror", "-std=c99", "-O2", *more]
    binary = str(tmp_path / "main")
    subprocess.run(["gcc", *flags, "-o", binary, str(tmp_path / "main.c")], check=True)
    told = subprocess.run([binary], capture_output=True, text=True, check=True).stdout
    assert told == "-1 -1 -1 -1 0.25 -1 0 0\n"


def test_the_block_takes_a_row_at_its_sample_time_only(rows: SampledTable) -> None:
    program = written(rows, "st").decode()
    table, shaper = Block(program, "crane_table"), Block(program, "crane_shaper")

    def ready(row: int, task_time_s: float, **other: Any) -> bool:
        held = table(row=row)
        given = {
            "samples": held["samples"].values,
            "amplitudes": held["amplitudes"].values,
            "sample_time_s": held["sample_time_s"],
            **other,
        }
        told = shaper(command=0.25, task_time_s=task_time_s, **given)
        if not told["ready"]:
            assert told["shaped"] == 0.25
        return bool(told["ready"])

    assert ready(0, 0.02)
    assert ready(1, 0.05)
    assert not ready(0, 0.0201)
    assert not ready(2, 0.6)
    assert not ready(2, 0.0)
    cells = shaper.values["last_cell"]
    assert not ready(0, 0.02, samples=[0, *[cells + 1] * (rows.head.impulses - 1)])
    assert not ready(0, 0.02, samples=[-1, *[1] * (rows.head.impulses - 1)])


def test_blark_parses_the_blocks(rows: SampledTable) -> None:
    from blark.parse import parse_source_code

    parsed = parse_source_code(written(rows, "st").decode())
    assert [item.name for item in parsed.transform().items] == ["crane_table", "crane_shaper"]


@pytest.mark.parametrize("name", ["c", "st"])
def test_the_head_says_what_holds_between_rows(rows: SampledTable, name: str) -> None:
    head = " ".join(written(rows, name).decode()[:3000].split())
    assert "Between two rows nothing is verified" in head
    assert "take the nearest row" in head
    assert "rows whose residual is above what their shaper claims: 0" in head


def test_rows_above_their_claims_are_counted() -> None:
    request = {
        **ROWS,
        "design": {**ROWS["design"], "shaper": {"kind": "num_ei", "sample_time_s": 0.03}},
        "axes": [{"field": "/shaper/sample_time_s", "values": [0.001, 0.03]}],
    }
    text = written(computed(request), "c").decode()
    assert "rows whose residual is above what their shaper claims: 1\n" in text


def test_the_size_is_checked_as_wide_as_the_rows_are(rows: SampledTable) -> None:
    from dataclasses import replace

    from design.export.registry import EXPORTS

    per_row = len(rows.head.columns) - 1
    most = MAX_NUMBERS // per_row
    EXPORTS["c"].checks(replace(rows.head, rows=most))
    with refused("program_too_large", "rows"):
        EXPORTS["c"].checks(replace(rows.head, rows=most + 1))


def test_lines_for_reprap_have_the_impulses_of_each_row(rows: SampledTable, tmp_path: Path) -> None:
    held = read_rrf(written(rows, "rrf"), tmp_path)
    times = times_of(rows.head, rows.rows)
    counts = (~np.isnan(times)).sum(axis=1)
    assert [one.impulses[0].times_s.size for one in held] == counts[:2].tolist()
    for one, wanted, count in zip(held, times, counts, strict=False):
        for impulses in one.impulses:
            np.testing.assert_allclose(impulses.times_s, wanted[:count], atol=2e-6)


def test_klipper_takes_no_rows_on_samples() -> None:
    ideal_ei = computed({**ROWS, "axes": [{**ROWS["axes"][0], "values": [0.02]}]})
    with refused("klipper_not_on_samples", "shaper.sample_time_s"):
        written(ideal_ei, "klipper")


@pytest.mark.parametrize("name", ["c", "st"])
@pytest.mark.parametrize("kind", ["zvd", "numzv"])
def test_a_single_design_is_played_as_it_was_verified(tmp_path: Path, name: str, kind: str) -> None:
    design = {**ROWS["design"], "shaper": {"kind": kind, "sample_time_s": 0.02}}
    written = design_file(json.dumps(design).encode(), name)
    assert not isinstance(written, Problem)
    text = written.content
    table = computed({**ROWS, "design": design, "axes": [{**ROWS["axes"][0], "values": [0.02]}]})
    played = played_by_c(text, tmp_path) if name == "c" else played_by_text(text)
    assert difference(table, played) == ""
