"""The rows of a table, each by the pipeline."""

import math

import numpy as np

from design.analysis.certificate import certify
from design.errors import (
    DesignError,
    InfeasibleDesignError,
    InvalidInputError,
)
from design.pipeline import design
from design.tables.rows import FAILED, INFEASIBLE, VERIFIED, Rows
from design.tables.specification import TableSpecification, columns_of
from design.types import FloatArray


def compute_rows(specification: TableSpecification, start: int, stop: int) -> Rows:
    """Compute rows ``start`` to ``stop``; they depend on nothing but these arguments."""
    fields = specification.field_values(start, stop)
    width = sum(column.kind == "result" for column in columns_of(specification))
    results = np.full((stop - start, width), math.nan)
    status = np.full(stop - start, VERIFIED, dtype=np.int8)
    reasons = {}
    for index, values in enumerate(fields):
        try:
            results[index] = _row(specification, values)
        except (InvalidInputError, InfeasibleDesignError) as error:
            status[index], reasons[index] = INFEASIBLE, str(error)
        except DesignError as error:
            status[index], reasons[index] = FAILED, str(error)
    return Rows(first=start, fields=fields, results=results, status=status, reasons=reasons)


def _row(specification: TableSpecification, values: FloatArray) -> list[float]:
    plant, actuator, options = specification.at(values)
    found = design(plant, actuator, specification.kind, options)
    times = found.impulses.times_s
    results: list[float] = []
    for name in specification.columns:
        if name == "times_s":
            results += times.tolist()
        elif name == "amplitudes":
            results += found.impulses.amplitudes.tolist()
        elif name == "phases_rad":
            results += (plant.mode.natural_frequency_rad_s * times).tolist()
        elif name == "duration_s":
            results.append(found.impulses.duration_s)
        elif name == "residual":
            results.append(found.residual)
        else:
            claims = certify(found.impulses, plant.mode, actuator, ("slope",)).claims
            results.append(claims[0].value)
    return results
