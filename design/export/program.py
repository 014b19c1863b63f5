"""What generated programs share: names, numbers, limits, the facts of their comments."""

import math
import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from design.curve_fit.polynomials import Fit
from design.errors import InvalidInputError
from design.export.header import comment_lines
from design.export.live import live_remarks
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from design.shapers.refusals import require_small_swings
from design.tables.columns import (
    amplitudes_of,
    names_of,
    require_times,
    times_of,
    varied_paths,
)
from design.tables.rows import STATUSES, WITH_DESIGN, Rows, TableHead, subject_of
from design.types import BoolArray, FloatArray

MAX_NUMBERS = 200_000
"""Largest table in a program: 1.6 MB of doubles, what large controllers have in flash."""

MAX_NAME_CHARACTERS = 20
"""Of a title in names: NAME_evaluator, the longest block, has 30 letters, as PLC editors take."""

HASH_DIGITS = 7
"""Of the specification's hash in names: two of a thousand tables share it once in 500 times."""

DEFAULT_TITLE = "shaper table"
"""Title of a table that was given none."""

ON_SAMPLES = (
    "on samples: delays are whole numbers of samples, and a row is what was verified only with its",
    "fields and its sample time. Between two rows nothing is verified, and neither samples nor",
    "amplitudes can be interpolated: take the nearest row",
)
"""What the head of a program on samples says of them."""

ENDS = (("t", "_s"), ("a", ""))
"""What stands around the number of an impulse in the names of columns that arrays hold already."""

RANGE_MARGIN = 1e-6
"""By how much of itself a range is widened in a program: what float makes of an end of it [-]."""


def check_program(head: TableHead) -> None:
    """Raise InvalidInputError where a program cannot take the table."""
    require_small_swings(subject_of(head).kind, "programs")
    require_times(head)
    if head.rows < 1:
        raise InvalidInputError(
            "rows", head.rows, "at least 1: a program has no empty table", code="program_empty"
        )
    numbers = head.rows * (len(head.columns) - 1)
    if numbers > MAX_NUMBERS:
        raise InvalidInputError(
            "rows",
            f"{head.rows} ({numbers} numbers)",
            f"of at most {MAX_NUMBERS} numbers in all",
            code="program_too_large",
        )


def name_of(head: TableHead) -> str:
    """Return the start of the names in a program.

    A letter, then small letters, digits and single underscores: the head's name or else the title,
    with digits of the specification's hash where that does not set it apart from others: no title
    was given, or it is too long, or is written in letters that are not among a to z. What names are
    made of it always ends in more, so that none is a reserved word of C or Structured Text.

    Parameters
    ----------
    head
        The table's head.

    Returns
    -------
    str
        At most ``MAX_NAME_CHARACTERS`` characters.

    Examples
    --------
    >>> from design.tables.rows import TableHead
    >>> head = TableHead(
    ...     version="0", specification_json="", specification_sha256="4f7a90c2", title="2nd crane",
    ...     columns=(), rows=0, impulses=0, amplitudes=(),
    ... )
    >>> name_of(head)
    'table_2nd_crane'
    """
    given = head.name or head.title
    plain = unicodedata.normalize("NFKD", given).casefold()
    plain = "".join(letter for letter in plain if not unicodedata.combining(letter))
    words = "_".join(re.findall(r"[a-z0-9]+", plain))
    if not words[:1].isalpha():
        words = f"table_{words}".rstrip("_")
    if given != DEFAULT_TITLE and plain.isascii() and len(words) <= MAX_NAME_CHARACTERS:
        return words
    start = words[: MAX_NAME_CHARACTERS - HASH_DIGITS - 1].rstrip("_")
    return f"{start}_{head.specification_sha256[:HASH_DIGITS]}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Listing:
    """All rows of a table, as a program lists them.

    Attributes
    ----------
    names, numbers
        Fields and results except times and amplitudes, and their values, shape (rows, columns).
    status
        Shape (rows,).
    times_s, amplitudes
        Of the impulses, shape (rows, impulses) [s], [-]; on samples not a number beyond the
        impulses of a row.
    above_claims
        How many rows have a design that does not keep what its shaper claims, which happens on
        samples only.
    """

    names: tuple[str, ...]
    numbers: FloatArray
    status: list[int]
    times_s: FloatArray
    amplitudes: FloatArray
    above_claims: int = 0

    @property
    def designed(self) -> BoolArray:
        """Which rows have a design, shape (rows,)."""
        held: BoolArray = np.isin(self.status, WITH_DESIGN)
        return held

    @property
    def shared_amplitudes(self) -> FloatArray | None:
        """Those of all rows with a design, shape (impulses,); None if they differ."""
        held = self.amplitudes[self.designed]
        return held[0] if len(held) and bool(np.all(held == held[0])) else None


def listing(head: TableHead, runs: Iterable[Rows]) -> Listing:
    """Gather the rows of a table.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Returns
    -------
    Listing
        The rows of all runs, held at once.
    """
    held = list(runs)
    named = names_of(head, "field") + names_of(head, "result")
    of_impulses = {f"{start}{k}{end}" for k in range(1, head.impulses + 1) for start, end in ENDS}
    others = [place for place, name in enumerate(named) if name not in of_impulses]
    return Listing(
        names=tuple(named[place] for place in others),
        numbers=np.vstack([
            np.empty((0, len(others))),
            *(np.hstack((rows.fields, rows.results))[:, others] for rows in held),
        ]),
        status=[value for rows in held for value in rows.status.tolist()],
        times_s=np.vstack([np.empty((0, head.impulses)), *(times_of(head, run) for run in held)]),
        amplitudes=np.vstack([
            np.empty((0, head.impulses)),
            *(amplitudes_of(head, run) for run in held),
        ]),
        above_claims=sum(bool(rows.designed[index]) for rows in held for index in rows.reasons),
    )


def remarks(head: TableHead, rows: Listing, more: Sequence[str] = ()) -> list[str]:
    """Return what the comment at the top of a program says.

    Parameters
    ----------
    head, rows
        The table.
    more
        Further lines.

    Returns
    -------
    list of str
        Lines without marks of a comment.
    """
    lines = comment_lines(head)
    if "residual" in rows.names:
        residuals = rows.numbers[:, rows.names.index("residual")]
        known = residuals[~np.isnan(residuals)]
        worst = f"{float(known.max()):.3g}" if known.size else "none"
        lines.append(
            f"worst residual of the rows: {worst} of one unshaped step, with the actuator given"
        )
    else:
        lines.append("worst residual of the rows: not known, the table has no column residual")
    if head.fit is not None:
        lines.append(
            f"worst residual of the polynomials: {head.fit.worst_residual:.3g} at "
            f"{head.fit.checked_points} points, worst timing error "
            f"{head.fit.worst_timing_error_s:.3g} s, all but x as the specification's design says"
        )
    counts = [f"{rows.status.count(code)} {name}" for code, name in enumerate(STATUSES)]
    lines.append(
        "status: 0 verified, 1 infeasible, 2 failed, 3 verified for an ideal actuator only"
    )
    lines.append(f"rows: {', '.join(counts)}")
    if head.on_samples:
        lines += [
            *ON_SAMPLES,
            f"rows whose residual is above what their shaper claims: {rows.above_claims}",
        ]
    lines += _of_live_commands(head, rows)
    return [*lines, *more]


def comment(
    head: TableHead, rows: Listing, harmless: dict[str, str], more: Sequence[str] = ()
) -> str:
    """Return the comment at the top of a program, without its marks.

    Parameters
    ----------
    head, rows, more
        The table, and further lines.
    harmless
        What stands in place of the marks that would end or open a comment of the language, by mark.

    Returns
    -------
    str
        Lines, indented by three blanks from the second on.
    """
    text = "\n   ".join(remarks(head, rows, more))
    for mark, other in harmless.items():
        text = text.replace(mark, other)
    return text


def dividing(fit: Fit) -> str:
    """Return the expression that turns a polynomial's value into a time.

    It is the same in C and Structured Text.
    """
    return "value / natural_frequency_rad_s" if fit.in_phases else "value"


def gravity_of(head: TableHead) -> float | None:
    """Return the gravity that turns a cable length into a frequency [m/s^2].

    Returns
    -------
    float or None
        None of plants without a cable.
    """
    plant = subject_of(head).plant
    return plant.gravity_m_s2 if isinstance(plant, Pendulum) else None


def _of_live_commands(head: TableHead, rows: Listing) -> list[str]:
    """Return what the delay line of the program does to a command that changes at any time."""
    designed = np.flatnonzero(rows.designed)
    if not designed.size:
        return []
    subject, paths = subject_of(head), varied_paths(head)
    first = int(designed[0])
    plant, drive, _ = subject.at(paths, rows.numbers[first, : len(paths)].tolist())
    drives = [drive]
    if any(path[0] == "actuator" for path in paths):
        fields = rows.numbers[designed, : len(paths)].tolist()
        drives += [subject.at(paths, values)[1] for values in fields]
    held = ~np.isnan(rows.times_s[first])
    return live_remarks(
        Impulses(times_s=rows.times_s[first, held], amplitudes=rows.amplitudes[first, held]),
        first,
        plant,
        drives,
        positive=not bool((rows.amplitudes[designed] <= 0).any()),
    )


def range_of(fit: Fit) -> tuple[float, float]:
    """Return the range of x with a margin for single precision.

    The ends are widened by their rounding.
    """
    return (
        fit.variable.start - RANGE_MARGIN * abs(fit.variable.start),
        fit.variable.stop + RANGE_MARGIN * abs(fit.variable.stop),
    )


def decimal(value: float) -> str:
    """Return a number with a decimal point, as C and Structured Text read it.

    The text is exact.

    Parameters
    ----------
    value
        A finite number.

    Returns
    -------
    str
        The shortest text of the double.

    Raises
    ------
    InvalidInputError
        If the number is not finite.

    Examples
    --------
    >>> decimal(2.0), decimal(1e-7), decimal(-1.5e+300)
    ('2.0', '1.0e-07', '-1.5e+300')
    """
    if not math.isfinite(value):
        raise InvalidInputError("value", value, "finite in a program", code="not_finite_in_program")
    mantissa, mark, exponent = repr(float(value)).partition("e")
    return (mantissa if "." in mantissa else f"{mantissa}.0") + mark + exponent
