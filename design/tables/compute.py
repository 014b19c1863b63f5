"""Rows of a table: designed, proven, each with a status."""

import itertools
import zlib
from dataclasses import dataclass, fields, replace

import numpy as np

from design.claims import ZERO_LIMITS
from design.errors import DesignError, InfeasibleDesignError, InvalidInputError
from design.pipeline import design
from design.shapers.compiled_rows import CompiledRows
from design.shapers.kind import ShaperKind
from design.shapers.options import NoOptions
from design.shapers.settle_options import SettleOptions
from design.tables.designed_rows import DesignedRows, empty_rows
from design.tables.parameters import RowParameters, of_one_mode_and_lags, row_parameters
from design.tables.rows import FAILED, INFEASIBLE, Rows, join_rows
from design.tables.sampled_rows import sampled_rows
from design.tables.specification import TableSpecification
from design.types import BoolArray, FloatArray, IntArray

GUARDED_SHARE = 5000
"""One row in this many is designed by the pipeline as well, to guard against a wrong branch [-]."""

RUN_ROWS = 50_000
"""As many rows are designed at a time: what is held meanwhile fits the processor's caches, and is
used again for the next. Fresh memory costs a busy machine more than the arithmetic [-]."""

SAME = 1e-10
"""Times that differ by less are the same, as a share of the duration [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RowCounts:
    """How rows came about.

    Attributes
    ----------
    compiled
        Designed by the compiled kernel.
    single
        Designed one by one.
    guarded
        Designed by both.
    corrected
        Of those, rows where the single design was shorter, and stands.
    """

    compiled: int
    single: int
    guarded: int
    corrected: int


def compute_rows(specification: TableSpecification, start: int, stop: int) -> Rows:
    """Design the rows ``start`` to ``stop`` of a table.

    Square problems are solved by the compiled kernel; what it cannot answer, and shapers with
    freedom, by `design.pipeline.design`, row by row. The result depends on the specification and
    the numbers of the rows alone.

    Parameters
    ----------
    specification
        The table.
    start, stop
        Numbers of its first row and of the one after its last.

    Returns
    -------
    Rows
        Every row with a status. A row marked verified holds what its shaper claims with the
        actuator given; one marked verified_ideal does with an ideal one alone.
    """
    if specification.grid is not None:
        return sampled_rows(specification, start, stop)  # together as wide as the widest
    specification = with_impulse_count(specification)
    ends = [*range(start + RUN_ROWS, stop, RUN_ROWS), stop]
    return join_rows([
        compute_with_counts(specification, first, end)[0]
        for first, end in itertools.pairwise([start, *ends])
    ])


def compute_with_counts(
    specification: TableSpecification, start: int, stop: int
) -> tuple[Rows, RowCounts]:
    """Return rows of a table, and how they came about.

    The rows are those of `compute_rows`.

    Parameters
    ----------
    specification
        The table.
    start, stop
        Numbers of the first row and of the one after the last, from 0.

    Returns
    -------
    Rows
        ``stop - start`` rows, each with its status.
    RowCounts
        How many rows were designed in which way.
    """
    if specification.grid is not None:
        rows = sampled_rows(specification, start, stop)
        return rows, RowCounts(compiled=0, single=stop - start, guarded=0, corrected=0)
    specification = with_impulse_count(specification)
    values = specification.field_values(start, stop)
    table = empty_rows(len(values), specification.impulses or 0, specification.columns)
    guarded = corrected = compiled_rows = 0
    how = compiled_rows_of(specification)
    if how is not None:
        _compile_rows(specification, how, row_parameters(specification, values), table)
        compiled_rows = int(table.designed.sum())
        for row in np.flatnonzero(
            table.designed & _select_guarded(specification, start, stop)
        ).tolist():
            guarded += 1
            corrected += _correct(specification, values[row], table, row)
    without = np.zeros(len(values), dtype=np.int8)
    reasons = {}
    for row in np.flatnonzero(~table.designed).tolist():
        try:
            plant, actuator, options = specification.at(values[row])
            found = design(plant, actuator, specification.kind, options)
            table.take(row, plant, actuator, found)
        except DesignError as error:
            # Values that break a rule only together: no such design exists either.
            none_exists = isinstance(error, InfeasibleDesignError | InvalidInputError)
            without[row] = INFEASIBLE if none_exists else FAILED
            reasons[row] = str(error)
    rows = Rows(
        first=start,
        fields=values,
        results=table.results(specification.columns),
        status=np.where(table.designed, table.status(), without).astype(np.int8),
        reasons=reasons,
    )
    single = len(values) - compiled_rows
    return rows, RowCounts(
        compiled=compiled_rows, single=single, guarded=guarded, corrected=corrected
    )


def with_impulse_count(specification: TableSpecification) -> TableSpecification:
    """Return a specification that says how many impulses a row has.

    Its first row is designed where the kind does not say. On samples no row says it of others.

    Returns
    -------
    TableSpecification
        With ``impulses``, except on samples.

    Raises
    ------
    DesignError
        If there is no such design.
    """
    if specification.impulses is not None or specification.grid is not None:
        return specification
    plant, actuator, options = specification.at(specification.field_values(0, 1)[0])
    found = design(plant, actuator, specification.kind, options)
    return replace(specification, impulses=found.impulses.times_s.size)


def compiled_rows_of(specification: TableSpecification) -> CompiledRows | None:
    """Return how the kernel solves the rows.

    None where it does not know all that they depend on.
    """
    kind, options = specification.kind, specification.options
    if specification.actuator.kind not in kind.actuators:
        return None
    known = {one.name for one in (*fields(SettleOptions), *fields(NoOptions))}
    others = [] if options is None else [one for one in fields(options) if one.name not in known]
    varied = {path[1:] for path in specification.fields if path[0] == "shaper"}
    if not varied <= {("max_duration_periods",)} or not of_one_mode_and_lags(specification):
        return None
    usual = all(getattr(options, one.name) == one.default for one in others)
    return kind.compiled_rows if usual else None


def _compile_rows(
    specification: TableSpecification,
    how: CompiledRows,
    parameters: RowParameters,
    table: DesignedRows,
) -> None:
    """Enter what the kernel solves and the compiled certificate verifies."""
    # Numba takes half a second to import, which nothing but tables should pay.
    from design.tables.kernel import closed_triangles, rows_of_problems, solve_rows  # noqa: PLC0415
    from design.tables.starts import FOUND  # noqa: PLC0415

    kind, impulses = specification.kind, table.times_s.shape[1]
    given, w = parameters.lags, parameters.natural_frequencies_rad_s
    switched = specification.actuator.model == "switched"
    drive = _Drive(lags=given, switched=switched)
    designed_for = drive
    if how.for_ideal:
        designed_for = _Drive(lags=given * [1.0, 0.0, 0.0, 0.0, 0.0], switched=False)
    settle = bool(getattr(specification.options, "settle", False))
    problems = rows_of_problems(designed_for.lags, parameters.max_duration_periods, settle=settle)
    fits = parameters.workable & (problems[:, 5:7].sum(axis=1) <= problems[:, 7])
    closed = np.zeros(len(fits), dtype=np.bool_)
    if how.closed_form_undamped and not designed_for.switched:
        closed = fits & (given[:, 0] == 0)
    for which in (closed, fits & ~closed):
        index = np.flatnonzero(which)
        if not index.size:
            continue
        if which is closed:
            gaps, ends = closed_triangles(problems[index])
        else:
            gaps, ends = solve_rows(problems[index], impulses, switched=designed_for.switched)
        index, gaps = index[ends == FOUND], gaps[ends == FOUND]
        times = np.zeros((index.size, impulses))
        np.cumsum(gaps, axis=1, out=times[:, 1:])
        times /= w[index, None]
        _enter_proven(kind, designed_for, drive, w, index, times, table)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Drive:
    """Plants' damping ratios and lags, shape (m, 5), and how the two sets share an actuator."""

    lags: FloatArray
    switched: bool


def _enter_proven(
    kind: ShaperKind,
    designed_for: _Drive,
    given: _Drive,
    w: FloatArray,
    index: IntArray,
    times: FloatArray,
    table: DesignedRows,
) -> None:
    """Enter the rows of ``index`` whose claims hold, and what they leave with the drive given.

    Whether the claims hold with that as well is entered too.
    """
    from design.tables.proofs import proven  # noqa: PLC0415

    of_rows = w[index]
    claimed = "slope" in kind.claims
    apart = designed_for is not given
    left = proven(
        designed_for.lags[index],
        of_rows,
        times,
        switched=designed_for.switched,
        slopes=claimed or (table.wants_slopes and not apart),
    )
    holds = as_given = _zeros_hold(left, slopes=claimed)
    if apart:
        left = proven(
            given.lags[index],
            of_rows,
            times,
            switched=given.switched,
            slopes=claimed or table.wants_slopes,
        )
        as_given = _zeros_hold(left, slopes=claimed)
        holds = holds | as_given
    index = index[holds]
    table.times_s[index] = times[holds]
    table.amplitudes[index] = np.where(np.arange(times.shape[1]) % 2 == 0, 1.0, -1.0)
    table.natural_frequencies_rad_s[index] = w[index]
    table.residuals[index] = left[holds, 0]
    table.slopes[index] = left[holds, 1]
    table.designed[index] = True
    table.for_ideal[index] = ~as_given[holds]


def _zeros_hold(left: FloatArray, *, slopes: bool) -> BoolArray:
    """Return which rows of residuals and slopes are within the certificate's limits."""
    holds: BoolArray = left[:, 0] <= ZERO_LIMITS["residual"]
    return holds & (left[:, 1] <= ZERO_LIMITS["slope"]) if slopes else holds


def _select_guarded(specification: TableSpecification, start: int, stop: int) -> BoolArray:
    """Return which rows both routes design: a hash of specification and row number decides."""
    base = (specification.plant, specification.actuator, specification.options)
    key = zlib.crc32(repr((*base, specification.kind.name, specification.fields)).encode())
    mixed = np.arange(start, stop, dtype=np.uint64) + np.uint64(key << 32)
    # The finaliser of splitmix64 (Steele, Lea, Flood 2014).
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB), (31, 1)):
        mixed = (mixed ^ (mixed >> np.uint64(shift))) * np.uint64(factor)
    chosen: BoolArray = mixed % np.uint64(GUARDED_SHARE) == 0
    return chosen


def _correct(
    specification: TableSpecification, values: FloatArray, table: DesignedRows, row: int
) -> bool:
    """Design a row of the kernel's once more; keep the single design where it is shorter."""
    plant, actuator, options = specification.at(values)
    try:
        found = design(plant, actuator, specification.kind, options)
    except DesignError:
        return False  # the kernel's row is verified, the pipeline has nothing against it
    shorter = bool(found.impulses.duration_s < table.times_s[row, -1] * (1 - SAME))
    if shorter:
        table.take(row, plant, actuator, found)
    return shorter
