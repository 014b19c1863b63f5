"""Random tables on samples, written as programs and played: the command of each row."""

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from design.export.registry import EXPORTS
from design.model.impulses import Impulses
from design.tables.compute import compute_rows
from design.tables.rows import Rows, TableHead, subject_of
from design.tables.sampled_rows import widened, widest_of
from design.types import FloatArray
from schemas.tables import TableRequest
from service.jobs.plan import Plan, head_of, plan_table
from tests.integration_route import residual_by_integration
from tests.readers import read_c
from tests.structured_text import Block

KINDS = (
    "zv",
    "zvd",
    "mzv",
    "ei",
    "umzv",
    "umzvd",
    "um_ei",
    "numzv",
    "numzvd",
    "num_ei",
    "si",
    "ps_zv",
    "sna_zv",
    "convolved",
    "multi_zv",
    "multi_umzv",
)

ROWS = 3

CLOSE = 1e-6
"""Of a residual by integration: its steps, and the differences of a command that is played [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampledTable:
    """A table on samples, computed."""

    head: TableHead
    rows: Rows


def random_request(number: int) -> dict[str, Any]:
    """Return the specification of table ``number``, the same in every run."""
    rng = np.random.default_rng([31, number])
    kind = KINDS[number % len(KINDS)]
    w = float(np.exp(rng.uniform(np.log(2.0), np.log(60.0))))
    per_period = float(np.exp(rng.uniform(np.log(8.0), np.log(60.0))))
    sample_time_s = 2 * np.pi / w / per_period
    ends = {
        "accel_time_constant_s": float(rng.uniform(0.02, 0.2)) / w,
        "decel_time_constant_s": float(rng.uniform(0.02, 0.2)) / w,
    }
    model = str(rng.choice(["superposed", "switched"]))
    actuator: dict[str, Any] = {"kind": "first_order", "model": model, **ends}
    if rng.random() < 0.4:
        actuator = {"kind": "ideal"}
    mode = {"natural_frequency_rad_s": w, "damping_ratio": float(rng.uniform(0, 0.1))}
    several = kind in {"convolved", "multi_zv", "multi_umzv"}
    plant: dict[str, Any] = {"kind": "mode", **mode}
    field = "/plant/natural_frequency_rad_s"
    if several:
        other = {"natural_frequency_rad_s": w / 2.7, "damping_ratio": 0.01}
        plant = {"kind": "modes", "modes": [mode, other]}
        field = "/plant/modes/0/natural_frequency_rad_s"
    shaper = {"kind": kind, "sample_time_s": sample_time_s}
    axes = [{"field": field, "from": w, "to": w * 1.3, "points": ROWS}]
    if rng.random() < 0.3:
        axes = [
            {
                "field": "/shaper/sample_time_s",
                "from": sample_time_s / 2,
                "to": sample_time_s,
                "points": ROWS,
            }
        ]
    return {
        "title": f"played {number}",
        "design": {"plant": plant, "actuator": actuator, "shaper": shaper},
        "axes": axes,
        "columns": ["times_s", "amplitudes", "residual"],
    }


def computed(request: dict[str, Any]) -> SampledTable:
    """Compute a table, as wide as its widest row."""
    plan = plan_table(json.dumps(request).encode())
    assert isinstance(plan, Plan), plan
    specification = TableRequest.model_validate(request).to_design()
    rows = compute_rows(specification, 0, specification.rows)
    impulses = widest_of(specification.columns, [rows])
    head = head_of(plan.job, fitted=False, impulses=impulses)
    return SampledTable(head=head, rows=widened(specification.columns, rows, impulses))


def written(table: SampledTable, name: str) -> bytes:
    """Return a table as a file."""
    EXPORTS[name].checks(table.head)
    return b"".join(EXPORTS[name].write(table.head, [table.rows]))


def played_by_c(text: bytes, folder: Path) -> list[list[float] | None]:
    """Compile a header and play a step by each row; None where the row is refused."""
    read_c(text, folder)
    told = subprocess.run([str(folder / "main")], capture_output=True, text=True, check=True)
    lines = told.stdout.splitlines()
    played: list[list[float] | None] = []
    for line in lines[len(lines) // 2 :]:
        done, *levels = line.split()
        played.append([float(level) for level in levels] if done == "0" else None)
    return played


def played_by_text(text: bytes) -> list[list[float] | None]:
    """Run the blocks of Structured Text and play a step by each row."""
    program = text.decode()
    name = program.split("FUNCTION_BLOCK ")[1].split("_table")[0]
    table, shaper = Block(program, f"{name}_table"), Block(program, f"{name}_shaper")
    cells = shaper.values["last_cell"] + 1
    played: list[list[float] | None] = []
    while (row := table(row=len(played)))["status"] != -1:
        given = {
            "samples": row["samples"].values,
            "amplitudes": row["amplitudes"].values,
            "sample_time_s": row["sample_time_s"],
            "task_time_s": row["sample_time_s"],
        }
        shaper(command=0.0, reset=True, **given)
        levels = [shaper(command=1.0, reset=False, **given)["shaped"] for _ in range(cells)]
        played.append(levels if shaper.values["ready"] else None)
    return played


def difference(table: SampledTable, played: list[list[float] | None]) -> str:
    """Return in what a command that is played differs from its row; empty if in nothing."""
    rows, impulses = table.rows, table.head.impulses
    if len(played) != rows.status.size:
        return f"{len(played)} rows"
    subject = subject_of(table.head)
    paths = [tuple(name.split(".")) for name in (column.name for column in table.head.columns)][
        : rows.fields.shape[1]
    ]
    for row, levels in enumerate(played):
        if bool(rows.designed[row]) != (levels is not None):
            return f"row {row} is played, or has a design"
        if levels is None:
            continue
        values = rows.fields[row].tolist()
        plant, actuator, _ = subject.at(paths, values)
        grid = subject.grid_at(paths, values)
        assert grid is not None
        steps = np.diff(np.array([0.0, *levels]))
        at = np.flatnonzero(np.abs(steps) > 1e-12)
        command = Impulses(times_s=at * grid.sample_time_s, amplitudes=steps[at])
        wrong = _unlike(command, rows.results[row], impulses)
        if wrong:
            return f"row {row}: {wrong}"
        left = max(residual_by_integration(command, mode, actuator) for mode in plant.modes)
        told = float(rows.results[row, 2 * impulses])
        if abs(left - told) > CLOSE:
            return f"row {row}: played {left!r}, told {told!r}"
    return ""


def _unlike(command: Impulses, numbers: FloatArray, impulses: int) -> str:
    times, heights = numbers[:impulses], numbers[impulses : 2 * impulses]
    held = ~np.isnan(times) & (np.abs(heights) > 1e-12)
    times, heights = times[held], heights[held]
    if command.times_s.size != times.size:
        return f"{command.times_s.size} steps, not {times.size}"
    late = np.abs(command.times_s - (times - times[0])).max() / max(command.duration_s, 1e-9)
    high = np.abs(command.amplitudes - heights).max()
    return "" if max(late, high) < 1e-9 else f"apart by {late:.3g}, {high:.3g}"
