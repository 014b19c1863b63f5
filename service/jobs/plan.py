"""From a body to a job, and from a job to the head of its files."""

import uuid
from collections.abc import Iterable
from dataclasses import dataclass, replace

from pydantic import ValidationError

from design.curve_fit.fit import fit
from design.errors import DesignError
from design.export.program import DEFAULT_TITLE
from design.tables.columns import columns_of
from design.tables.compute import with_impulse_count
from design.tables.rows import TableHead
from design.tables.specification import TableSpecification
from schemas.fits import name_fit
from schemas.table_jobs import TableJob, TableSize
from schemas.tables import TableRequest, sha256_of
from schemas.warnings import WarningOut
from service.implausible_words import warnings_of
from service.jobs.implausible_rows import implausible_in_table
from service.jobs.records import Job, NewJob
from service.problems import (
    Problem,
    problem_of_design,
    problem_of_repetition,
    problem_of_validation,
)
from service.repeated_names import RepeatedNameError
from service.strict_json import loads
from service.version import version

USUAL_IMPULSES_ON_SAMPLES = 7
"""Impulses of the widest row on samples, before any is designed."""

FEWEST_IMPULSES_ON_SAMPLES = 2
"""As many impulses each design on samples has at least."""

STATUS_BYTES = 1
FLOAT_BYTES = 8


@dataclass(frozen=True, slots=True)
class Plan:
    """A job to be, its size, and what is hardly meant in its specification."""

    job: NewJob
    size: TableSize
    warnings: tuple[WarningOut, ...] = ()


def plan_table(body: bytes) -> Plan | Problem:
    """Return the job that the body of a request for a table asks for.

    Parameters
    ----------
    body
        The specification as JSON.

    Returns
    -------
    Plan or Problem
        The job, its size and warnings, or what is wrong with the specification.
    """
    try:
        request = TableRequest.model_validate_json(body)
    except ValidationError as error:
        return problem_of_validation(error, body, TableRequest)
    try:
        loads(body)  # every name stands once
    except RepeatedNameError as error:
        return problem_of_repetition(error)
    try:
        plan = plan_of(request)
        odd = implausible_in_table(request)
    except DesignError as error:
        return problem_of_design(error, body)
    return replace(plan, warnings=tuple(warnings_of(odd, body))) if odd else plan


def plan_of(request: TableRequest) -> Plan:
    """Return the job that a request asks for.

    Parameters
    ----------
    request
        The specification.

    Returns
    -------
    Plan
        A job with a new id, and its size.

    Raises
    ------
    InvalidInputError
        If a value of the specification breaks its rule.
    DesignError
        If the number of impulses takes a design of the first row, and there is none.
    """
    specification = with_impulse_count(request.to_design())
    canonical = request.canonical()
    size = size_of(specification)
    job = NewJob(
        id=uuid.uuid4().hex,
        specification=canonical,
        sha256=sha256_of(canonical),
        version=version(),
        rows=specification.rows,
        chunk_rows=specification.chunk_rows,
        estimated_bytes=size.estimated_bytes,
        impulses=specification.impulses,
    )
    return Plan(job, size)


def size_of(specification: TableSpecification) -> TableSize:
    """Return how large a table will be; on samples about how large."""
    counted = specification
    if specification.grid is not None:
        counted = replace(specification, impulses=USUAL_IMPULSES_ON_SAMPLES)
    numbers = sum(column.kind in {"field", "result"} for column in columns_of(counted))
    return TableSize(
        rows=specification.rows,
        chunks=specification.chunks,
        estimated_bytes=specification.rows * (FLOAT_BYTES * numbers + STATUS_BYTES),
    )


def specification_of(canonical: str, impulses: int | None = None) -> TableSpecification:
    """Return the specification of a job, ready to be computed.

    Parameters
    ----------
    canonical
        The specification as canonical JSON.
    impulses
        Impulses of each row; None where the kind of shaper says.

    Returns
    -------
    TableSpecification
        The specification, with that number of impulses.

    Raises
    ------
    pydantic.ValidationError
        If the JSON is no specification that this version knows.
    InvalidInputError
        If a value of the specification breaks its rule.
    """
    specification = TableRequest.model_validate_json(canonical).to_design()
    return specification if impulses is None else replace(specification, impulses=impulses)


def head_of(
    job: NewJob, *, fitted: bool, name: str = "", impulses: int = FEWEST_IMPULSES_ON_SAMPLES
) -> TableHead:
    """Return the head of a job's files.

    Parameters
    ----------
    job
        The job.
    fitted
        Whether the polynomials are wanted, where the request asks for any.
    name
        Of the file: names in programs are made from it where no title was given.
    impulses
        On samples those of the widest row, where it is known.

    Returns
    -------
    TableHead
        With polynomials where they are wanted and asked for.

    Raises
    ------
    DesignError
        If the polynomials cannot be fitted.
    """
    request = TableRequest.model_validate_json(job.specification)
    specification = with_impulse_count(specification_of(job.specification, job.impulses))
    if specification.grid is not None:
        specification = replace(specification, impulses=impulses)
    polynomials = None
    if fitted and request.fit is not None:
        with name_fit("design"):
            polynomials = fit(
                specification.plant,
                specification.actuator,
                specification.kind,
                request.fit.to_design(request.design.plant.kind),
                specification.options,
            )
    return TableHead(
        version=job.version,
        specification_json=job.specification,
        specification_sha256=job.sha256,
        title=request.title,
        columns=columns_of(specification),
        rows=job.rows,
        impulses=specification.impulses or 0,
        amplitudes=specification.shared_amplitudes,
        name=name if request.title == DEFAULT_TITLE else "",
        fit=polynomials,
        real=request.real or "LREAL",
        subject=specification.subject,
    )


def wire_job(job: Job, warnings: Iterable[WarningOut] = ()) -> TableJob:
    """Return the state of a job for the wire.

    Parameters
    ----------
    job
        The job.
    warnings
        Of its specification, where it is just begun.

    Returns
    -------
    TableJob
        Its state.
    """
    left = job.left_s
    return TableJob(
        id=job.id,
        state=job.state,
        reason=job.reason or None,
        created=job.created,
        size=TableSize(rows=job.rows, chunks=job.chunks, estimated_bytes=job.estimated_bytes),
        rows_done=job.done,
        verified=job.verified,
        verified_ideal=job.verified_ideal,
        infeasible=job.infeasible,
        failed=job.failed,
        rows_per_s=job.rate_rows_s,
        seconds_left=None if left is None else round(left, 1),
        specification_sha256=job.sha256,
        version=job.version,
        warnings=list(warnings),
    )
