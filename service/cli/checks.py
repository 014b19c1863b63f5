"""Whether a file still is what its specification gives."""

import json
import re
from collections.abc import Iterable, Iterator
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from design.errors import InvalidInputError
from design.export.reading import READERS, rows_of
from design.tables.rows import STATUSES, Rows, TableHead
from design.types import FloatArray
from schemas.pointers import json_pointer
from schemas.tables import Tolerances

NAMED = re.compile(rb'#define (\w+)_ROWS |(?:FUNCTION_BLOCK "?|<pou name=")(\w+)_table\b')
"""Lines of C, Structured Text, SCL and PLCopen XML that hold the start of their names."""

MAX_LISTED_DRIFTS = 20
"""Drifts that are listed; all are counted."""

MAX_FIELDS_APART = 5
"""Fields of two specifications that are listed."""

MAX_SHOWN = 60
"""Characters of a value of a specification that are shown."""


class Drifts:
    """What has drifted: counted, the first ones listed."""

    def __init__(self) -> None:
        self.count = 0
        self.told: list[str] = []

    def add(self, text: str) -> None:
        """Add one."""
        self.count += 1
        if len(self.told) < MAX_LISTED_DRIFTS:
            self.told.append(text)


def drifts_of_file(
    path: Path, name: str, head: TableHead, rows: Iterable[Rows], tolerances: Tolerances
) -> Drifts:
    """Compare a file with the rows that its specification gives now.

    Parameters
    ----------
    path
        The file.
    name
        Name of its format, which is read back by rows.
    head
        The head that the specification gives now.
    rows
        The rows that the specification gives now.
    tolerances
        How far results may be apart; fields may not be.

    Returns
    -------
    Drifts
        Every difference, counted.

    Raises
    ------
    InvalidInputError
        If the file cannot be read as a table of this format.
    """
    drifts = Drifts()
    with path.open("rb") as file:
        found, old = rows_of(name, file)
        if found.specification_sha256 != head.specification_sha256:
            drifts.add(
                "the file is of another specification: "
                + "; ".join(_fields_apart(found.specification_json, head.specification_json))
            )
            return drifts
        names = [column.name for column in head.columns]
        if [column.name for column in found.columns] != names:
            raise InvalidInputError(
                "file", "other columns", "a table of this specification", code="other_columns"
            )
        try:
            _compare(drifts, head, old, rows, tolerances)
        except InvalidInputError as error:
            drifts.add(f"{path.name}: {error}")
    return drifts


def _fields_apart(was: str, becomes: str) -> list[str]:
    """Return the fields in which two specifications differ, `MAX_FIELDS_APART` at most."""
    apart = list(_apart(json.loads(was), json.loads(becomes), ()))
    more = len(apart) - MAX_FIELDS_APART
    return [*apart[:MAX_FIELDS_APART], *([f"and {more} more"] if more > 0 else [])]


def _apart(was: Any, becomes: Any, path: tuple[str, ...]) -> Iterator[str]:  # noqa: ANN401
    """Yield each field that differs, with both values."""
    if isinstance(was, dict) and isinstance(becomes, dict):
        for name in dict.fromkeys((*was, *becomes)):
            yield from _apart(was.get(name), becomes.get(name), (*path, name))
    elif isinstance(was, list) and isinstance(becomes, list) and len(was) == len(becomes):
        for number, (one, other) in enumerate(zip(was, becomes, strict=True)):
            yield from _apart(one, other, (*path, str(number)))
    elif was != becomes:
        both = (_shown(was), _shown(becomes))
        yield f"{json_pointer(path)} is {both[0]} in the file, {both[1]} now"


def _shown(value: Any) -> str:  # noqa: ANN401
    if value is None:
        return "not there"
    text = json.dumps(value)
    return text if len(text) <= MAX_SHOWN else f"{text[: MAX_SHOWN - 3]}..."


def _compare(
    drifts: Drifts,
    head: TableHead,
    old: Iterable[Rows],
    new: Iterable[Rows],
    tolerances: Tolerances,
) -> None:
    names = [column.name for column in head.columns if column.kind in {"field", "result"}]
    for first, was, becomes in _align(old, new):
        if was is None or becomes is None:
            drifts.add(f"rows from {first} on are {'missing' if was is None else 'too many'}")
            return
        before, after = _numbers(was), _numbers(becomes)
        fields = was.fields.shape[1]
        allowed = tolerances.absolute + tolerances.relative * np.abs(after)
        allowed[:, :fields] = 0.0  # what was asked for is no result
        apart = np.abs(before - after)
        same = (apart <= allowed) | (np.isnan(before) & np.isnan(after))
        for row, column in zip(*np.nonzero(~same), strict=True):
            drifts.add(
                f"row {first + row}, {names[column]}: {float(before[row, column])!r} in the file, "
                f"{float(after[row, column])!r} now, {apart[row, column]:.3g} apart, "
                f"allowed {allowed[row, column]:.3g}"
            )
        for row in np.flatnonzero(was.status != becomes.status):
            drifts.add(
                f"row {first + row}, status: {STATUSES[was.status[row]]} in the file, "
                f"{STATUSES[becomes.status[row]]} now"
            )
        for row in sorted(was.reasons.keys() | becomes.reasons.keys()):
            if (row in was.reasons) != (row in becomes.reasons):
                drifts.add(f"row {first + row}, reason: in the file or now, not in both")


def _numbers(rows: Rows) -> FloatArray:
    return np.hstack((rows.fields, rows.results))


def _align(
    old: Iterable[Rows], new: Iterable[Rows]
) -> Iterator[tuple[int, Rows | None, Rows | None]]:
    """Yield runs of equal rows from two tables whose runs differ in length."""
    ends = iter(old), iter(new)
    held: list[Rows | None] = [None, None]
    first = 0
    while True:
        for side in (0, 1):
            while held[side] is None or held[side].status.size == 0:  # type: ignore[union-attr]
                held[side] = next(ends[side], None)
                if held[side] is None:
                    break
        was, becomes = held
        if was is None and becomes is None:
            return
        if was is None or becomes is None:
            yield first, was, becomes
            return
        size = min(was.status.size, becomes.status.size)
        yield first, _part(was, 0, size), _part(becomes, 0, size)
        held = [_part(was, size, None), _part(becomes, size, None)]
        first += size


def _part(rows: Rows, start: int, stop: int | None) -> Rows:
    last = rows.status.size if stop is None else stop
    return Rows(
        first=rows.first + start,
        fields=rows.fields[start:last],
        results=rows.results[start:last],
        status=rows.status[start:last],
        reasons={row - start: text for row, text in rows.reasons.items() if start <= row < last},
    )


def file_named_in(path: Path) -> Path:
    """Return a program's file by the name that its own names begin with.

    The file may have another name now.

    Parameters
    ----------
    path
        The program.

    Returns
    -------
    Path
        Beside the program; the program's own path where none of its lines holds a name.
    """
    with path.open("rb") as file:
        for line in file:
            found = NAMED.match(line)
            if found is not None:
                return path.with_name((found[1] or found[2]).decode().lower())
    return path


def drifts_of_text(path: Path, pieces: Iterable[bytes]) -> Drifts:
    """Compare a program with the one that its specification gives now.

    Parameters
    ----------
    path
        The file.
    pieces
        Bytes of the file that the specification gives now.

    Returns
    -------
    Drifts
        Every line that differs, counted.
    """
    drifts = Drifts()
    new = b"".join(pieces).splitlines()
    with path.open("rb") as file:
        for number, (was, becomes) in enumerate(zip_longest(file, new), start=1):
            if (was or b"").rstrip(b"\r\n") != (becomes or b"") or None in (was, becomes):
                drifts.add(f"line {number}: {_text(was)} in the file, {_text(becomes)} now")
    return drifts


def _text(line: bytes | None) -> str:
    return "nothing" if line is None else repr(line.decode(errors="replace").rstrip()[:100])


def readable(name: str) -> bool:
    """Whether files of a format are read back by rows.

    Others are compared by line.
    """
    return name in READERS
