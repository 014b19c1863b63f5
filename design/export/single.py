"""One design as a table of one row and no field: what every format takes."""

import hashlib

import numpy as np

from design.curve_fit.polynomials import Fit
from design.export.program import HASH_DIGITS
from design.pipeline import Design
from design.tables.rows import VERIFIED, VERIFIED_IDEAL, Column, Real, Rows, Subject, TableHead
from design.tables.sampled_rows import told_losses


def digits_of(request_json: str, real: Real) -> str:
    """Return the digits that set the names of one answer apart from others.

    Parameters
    ----------
    request_json
        The request as canonical JSON.
    real
        Type of numbers: blocks in LREAL and in REAL may be in one program.

    Returns
    -------
    str
        Of a hash.
    """
    told = request_json if real == "LREAL" else f"{request_json} {real}"
    return hashlib.sha256(told.encode()).hexdigest()[:HASH_DIGITS]


def single_table(
    found: Design,
    subject: Subject,
    *,
    request_json: str,
    version: str,
    fit: Fit | None = None,
    real: Real = "LREAL",
) -> tuple[TableHead, Rows]:
    """Return the head and the one row of a design.

    Parameters
    ----------
    found
        The design.
    subject
        What it is a design of.
    request_json
        The request as canonical JSON; names in programs hold digits of its hash.
    version
        Of the tool.
    fit
        Polynomials for the times, where asked for.
    real
        Type of numbers in Structured Text.

    Returns
    -------
    TableHead
        Of a table without varied fields.
    Rows
        One row.
    """
    impulses = found.impulses.times_s.size
    sha256 = hashlib.sha256(request_json.encode()).hexdigest()
    digits = digits_of(request_json, real)
    head = TableHead(
        version=version,
        specification_json=request_json,
        specification_sha256=sha256,
        title=f"one {subject.kind.name}",
        name=f"{subject.kind.name}_{digits}",
        columns=(
            *(Column(name=f"t{k + 1}_s", unit="s", kind="result") for k in range(impulses)),
            *(Column(name=f"a{k + 1}", unit="1", kind="result") for k in range(impulses)),
            Column(name="residual", unit="1", kind="result"),
            Column(name="status", unit="", kind="status"),
            Column(name="reason", unit="", kind="reason"),
        ),
        rows=1,
        impulses=impulses,
        amplitudes=tuple(found.impulses.amplitudes.tolist()),
        fit=fit,
        real=real,
        subject=subject,
    )
    results = [*found.impulses.times_s, *found.impulses.amplitudes, found.residual]
    rows = Rows(
        first=0,
        fields=np.empty((1, 0)),
        results=np.array([results]),
        status=np.array([VERIFIED_IDEAL if found.for_ideal else VERIFIED], dtype=np.int8),
        reasons=dict(enumerate(told_losses(found.warnings))),
    )
    return head, rows
