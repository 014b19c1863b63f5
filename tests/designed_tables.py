"""Small tables for the tests: real designs over a grid, made row by row by the pipeline."""

import hashlib
import json
from collections.abc import Iterable
from itertools import product
from typing import Any

import numpy as np

from design.curve_fit.polynomials import Fit
from design.errors import InfeasibleDesignError
from design.pipeline import design
from design.tables.rows import STATUSES, Column, Rows, TableHead, subject_of
from schemas.tables import TableDesign

CRANE: dict[str, Any] = {
    "plant": {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81},
    "actuator": {
        "kind": "second_order",
        "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
        "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
    },
    "shaper": {"kind": "numzvd"},
}

UNITS = {"cable_length_m": "m", "natural_frequency_rad_s": "rad/s", "damping_ratio": "1"}


def head_of(
    request: dict[str, Any],
    fields: Iterable[str],
    rows: int,
    amplitudes: tuple[float, ...],
    *,
    title: str = "Crane, NUMZVD",
    fit: Fit | None = None,
) -> TableHead:
    """Return a head with times and residual of as many impulses as there are amplitudes."""
    impulses = len(amplitudes)
    text = json.dumps({"design": request}, sort_keys=True, separators=(",", ":"))
    return TableHead(
        version="0.1.0",
        specification_json=text,
        specification_sha256=hashlib.sha256(text.encode()).hexdigest(),
        title=title,
        columns=(
            *(
                Column(name=name, unit=UNITS.get(name.rpartition(".")[2], "s"), kind="field")
                for name in fields
            ),
            *(Column(name=f"t{k + 1}_s", unit="s", kind="result") for k in range(impulses)),
            Column(name="residual", unit="1", kind="result"),
            Column(name="status", unit="", kind="status"),
            Column(name="reason", unit="", kind="reason"),
        ),
        rows=rows,
        impulses=impulses,
        amplitudes=amplitudes,
        fit=fit,
        subject=TableDesign.model_validate(request).to_design(),
    )


def designed_table(
    request: dict[str, Any], axes: dict[str, list[float]], *, fit: Fit | None = None
) -> tuple[TableHead, Rows]:
    """Design every point of a grid by the pipeline."""
    points = np.array(list(product(*axes.values())))
    results: list[list[float] | None] = []
    status: list[int] = []
    reasons: dict[int, str] = {}
    amplitudes: tuple[float, ...] = ()
    subject = subject_of(head_of(request, axes, 0, ()))
    for index, point in enumerate(points.tolist()):
        plant, actuator, options = subject.at([name.split(".") for name in axes], point)
        try:
            made = design(plant, actuator, subject.kind, options)
        except InfeasibleDesignError as error:
            results.append(None)
            status.append(STATUSES.index("infeasible"))
            reasons[index] = str(error)
            continue
        results.append([*made.impulses.times_s.tolist(), made.residual])
        status.append(0)
        amplitudes = tuple(made.impulses.amplitudes.tolist())
    width = len(amplitudes) + 1
    numbers = [row if row is not None else [np.nan] * width for row in results]
    rows = Rows(
        first=0,
        fields=points,
        results=np.array(numbers),
        status=np.array(status, dtype=np.int8),
        reasons=reasons,
    )
    return head_of(request, axes, len(points), amplitudes, fit=fit), rows


def made_up_table(rows: int, run_rows: int) -> tuple[TableHead, Iterable[Rows]]:
    """Make up a table of any length, of numbers that mean nothing, some without a design."""
    head = head_of(
        CRANE, ("plant.cable_length_m", "plant.damping_ratio"), rows, (1.0, -1.0, 1.0, -1.0, 1.0)
    )
    return head, (
        _make_run(first, min(run_rows, rows - first)) for first in range(0, rows, run_rows)
    )


def _make_run(first: int, size: int) -> Rows:
    random = np.random.default_rng(first)
    results = random.lognormal(sigma=9.0, size=(size, 6))  # exponents that texts must write
    without = random.random(size) < 0.01
    results[without] = np.nan
    rows = np.flatnonzero(without).tolist()
    texts = ['none, "in" 50 starts', "nearest miss 0.3 #1", "Größe"]
    return Rows(
        first=first,
        fields=random.random((size, 2)),
        results=results,
        status=np.where(without, 1 + first % 2, 0).astype(np.int8),
        reasons={row: texts[row % 3] for row in rows},
    )


def join(runs: Iterable[Rows]) -> Rows:
    """Return all runs as one."""
    held = list(runs)
    return Rows(
        first=held[0].first,
        fields=np.vstack([rows.fields for rows in held]),
        results=np.vstack([rows.results for rows in held]),
        status=np.concatenate([rows.status for rows in held]),
        reasons={
            rows.first - held[0].first + index: text
            for rows in held
            for index, text in rows.reasons.items()
        },
    )


def same(left: Rows, right: Rows) -> bool:
    """Whether two runs agree in every bit."""
    return (
        left.first == right.first
        and np.array_equal(left.fields, right.fields)
        and np.array_equal(left.results, right.results, equal_nan=True)
        and np.array_equal(left.status, right.status)
        and left.reasons == right.reasons
    )
