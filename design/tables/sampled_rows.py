"""Rows on the samples of a controller, each with as many impulses as it takes.

How many that are is known of a row when it is designed. So a run of rows is as wide as its widest
row, and a whole table as its widest run: what a row has fewer of is not a number.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from design.analysis.warnings import DesignWarning
from design.errors import DesignError, InfeasibleDesignError, InvalidInputError
from design.pipeline import Design
from design.sampling.on_grid import design_on_grid
from design.tables.designed_rows import empty_rows
from design.tables.rows import FAILED, INFEASIBLE, Rows
from design.tables.specification import TableSpecification
from design.types import FloatArray

SERIES = ("times_s", "amplitudes", "phases_rad", "samples")
"""Results of which a row has one for each impulse."""

TOLD = "tolerance_not_kept"
"""Code of the warning that a row states as its reason: its residual is above what is claimed."""


def sampled_rows(specification: TableSpecification, start: int, stop: int) -> Rows:
    """Design the rows ``start`` to ``stop`` of a table on samples, one by one.

    Parameters
    ----------
    specification
        The table.
    start, stop
        Numbers of its first row and of the one after its last.

    Returns
    -------
    Rows
        As wide as the widest of them. A row marked verified has the residual that it states; where
        that is above what its shaper claims, its reason says so.
    """
    values, subject = specification.field_values(start, stop), specification.subject
    found: dict[int, Design] = {}
    without = np.zeros(len(values), dtype=np.int8)
    reasons = {}
    sample_times_s = np.full(len(values), np.nan)
    for row in range(len(values)):
        try:
            plant, actuator, options = specification.at(values[row])
            grid = subject.grid_at(specification.fields, values[row].tolist())
            one = design_on_grid(plant, actuator, specification.kind, options, grid)
        except DesignError as error:
            # Values that break a rule only together: no such design exists either.
            none_exists = isinstance(error, InfeasibleDesignError | InvalidInputError)
            without[row] = INFEASIBLE if none_exists else FAILED
            reasons[row] = str(error)
            continue
        found[row], sample_times_s[row] = one, np.nan if grid is None else grid.sample_time_s
        reasons.update((row, told) for told in told_losses(one.warnings))
    widest = max((one.impulses.times_s.size for one in found.values()), default=0)
    table = empty_rows(len(values), widest, specification.columns, sample_times_s)
    for row, one in found.items():
        plant, actuator, _ = specification.at(values[row])
        table.take(row, plant, actuator, one)
    return Rows(
        first=start,
        fields=values,
        results=table.results(specification.columns),
        status=np.where(table.designed, table.status(), without).astype(np.int8),
        reasons=reasons,
    )


def told_losses(warnings: Iterable[DesignWarning]) -> tuple[str, ...]:
    """Return in one text, or none, what a design does not keep on samples."""
    lost = [warning.detail for warning in warnings if warning.code == TOLD]
    return ("; ".join(lost),) if lost else ()


def width_of(columns: tuple[str, ...], rows: Rows) -> int:
    """Return how many impulses the widest row of a run has.

    Parameters
    ----------
    columns
        Results that are asked for.
    rows
        The run.

    Returns
    -------
    int
        0 where none has a design, or nothing is asked of single impulses.
    """
    series = sum(name in SERIES for name in columns)
    return (rows.results.shape[1] - (len(columns) - series)) // series if series else 0


def widened(columns: tuple[str, ...], rows: Rows, impulses: int) -> Rows:
    """Return a run of rows as wide as the widest row of its table.

    Parameters
    ----------
    columns
        Results that are asked for.
    rows
        The run.
    impulses
        Of the widest row.

    Returns
    -------
    Rows
        What a row has fewer of is not a number.
    """
    width = width_of(columns, rows)
    parts: list[FloatArray] = []
    at = 0
    for name in columns:
        has = width if name in SERIES else 1
        parts.append(rows.results[:, at : at + has])
        if name in SERIES:
            parts.append(np.full((len(rows.results), impulses - width), np.nan))
        at += has
    return replace(rows, results=np.concatenate(parts, axis=1))


def widest_of(columns: tuple[str, ...], runs: Iterable[Rows]) -> int:
    """Return how many impulses the widest row of a table has, at least 1.

    Parameters
    ----------
    columns
        Results that are asked for.
    runs
        All of its rows.

    Returns
    -------
    int
        1 where no row has a design.
    """
    return max((width_of(columns, rows) for rows in runs), default=1) or 1
