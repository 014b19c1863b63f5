"""Rules and lines that the printers' firmwares share: positive shapers, a line a row."""

from collections.abc import Callable, Iterable, Iterator

import numpy as np

from design.errors import InvalidInputError
from design.export.header import comment_lines
from design.model.impulses import Impulses
from design.tables.columns import amplitudes_of, names_of, times_of
from design.tables.row_amplitudes import undamped_amplitudes
from design.tables.rows import (
    STATUSES,
    VERIFIED_IDEAL,
    WITH_DESIGN,
    Rows,
    TableHead,
    subject_of,
)
from design.types import FloatArray

UNIT_SUM = 1e-12
"""How far the sum of amplitudes may be from 1: roundings, far below what a firmware resolves."""


def require_positive_shaper(head: TableHead, firmware: str) -> None:
    """Check that the amplitudes of a shaper are above 0.

    Both firmwares convolve an acceleration that they have planned within the machine's limits with
    the impulses; only impulses above 0 that add up to 1 keep it within. Where each row has its own
    amplitudes, `require_positive_row` checks them, and here those of an undamped mode are checked.

    Parameters
    ----------
    head
        The table's head.
    firmware
        Name that the error gives.

    Raises
    ------
    InvalidInputError
        If an amplitude is not above 0.
    """
    amplitudes = head.amplitudes
    if not amplitudes:
        subject = subject_of(head)
        amplitudes = undamped_amplitudes(subject.kind, subject.options)
    if not all(amplitude > 0 for amplitude in amplitudes):
        raise InvalidInputError(
            "shaper.kind",
            list(amplitudes),
            f"a shaper of positive impulses for {firmware}: all amplitudes > 0",
            code="shaper_not_positive",
        )


def firmware_lines(
    head: TableHead,
    runs: Iterable[Rows],
    remarks: list[str],
    commands: Callable[[Rows, int], list[str]],
) -> Iterator[bytes]:
    """Write a comment and the commands of each row, after the head.

    Parameters
    ----------
    head, runs
        The table.
    remarks
        Further lines of the head's comment.
    commands
        From a run and the index of a row with a design in it to its lines.

    Yields
    ------
    bytes
        The head, then a piece for each run.
    """
    yield "".join(f"; {line}\n" for line in [*comment_lines(head), *remarks]).encode()
    fields = names_of(head, "field")
    for rows in runs:
        lines = []
        for index, status in enumerate(rows.status.tolist()):
            values = zip(fields, rows.fields[index].tolist(), strict=True)
            where = ", ".join(f"{name} {value!r}" for name, value in values)
            lines.append(f"; row {rows.first + index}{': ' if where else ''}{where}")
            if status == VERIFIED_IDEAL:
                lines.append("; verified for an ideal actuator only")
            if status in WITH_DESIGN:
                lines += commands(rows, index)
            else:
                reason = " ".join(rows.reasons.get(index, "").split())
                lines.append(f"; {STATUSES[status]}: {reason}")
        yield "".join(f"{line}\n" for line in lines).encode()


def require_positive_row(head: TableHead, rows: Rows, index: int, firmware: str) -> Impulses:
    """Return the impulses of one row.

    Parameters
    ----------
    head, rows
        The table's head and one of its runs.
    index
        Number of the row in the run, from 0.
    firmware
        Name that the error gives.

    Returns
    -------
    Impulses
        As the row has them.

    Raises
    ------
    InvalidInputError
        If an amplitude is not above 0, or they do not add up to 1.
    """
    times_s, amplitudes = times_of(head, rows)[index], amplitudes_of(head, rows)[index]
    if head.on_samples:  # a row may have fewer impulses than others
        held = ~np.isnan(times_s)
        times_s, amplitudes = times_s[held], amplitudes[held]
    require_shares(amplitudes, f"row {rows.first + index}", firmware)
    return Impulses(times_s=times_s, amplitudes=amplitudes)


def require_shares(amplitudes: FloatArray, where: str, firmware: str) -> None:
    """Check that amplitudes are above 0 and add up to 1.

    Parameters
    ----------
    amplitudes, where, firmware
        The amplitudes, shape (n,) [-]; whose they are, and the name that the error gives.

    Raises
    ------
    InvalidInputError
        If they do not.
    """
    if not ((amplitudes > 0).all() and abs(float(np.sum(amplitudes)) - 1) < UNIT_SUM):
        raise InvalidInputError(
            f"amplitudes of {where}",
            amplitudes.tolist(),
            f"above 0 and add up to 1 for {firmware}",
            code="amplitudes_not_shares",
        )
