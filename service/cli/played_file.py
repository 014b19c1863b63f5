"""A played course from a CSV file, put into the request of a run."""

import csv
import json
import math
from typing import Any, NoReturn

from schemas.problems import FieldFault
from schemas.units import reading_of
from service.cli.reading import ReadingError, in_utf8
from service.problems import invalid_fields

TIMES = "times_s"

VALUES = {
    f"{axis}_{value}": (axis, value)
    for axis in ("x", "y")
    for value in ("velocity_m_s", "position_m")
}
"""Headings of the other columns: axis, and what it is."""


def with_played(body: bytes, name: str, content: bytes) -> bytes:
    """Return a request with the courses of a file as its ``played``.

    The first line has the headings: ``times_s``, and for x and y ``x_velocity_m_s`` or
    ``x_position_m``, in other units by their ends, as ``times_ms``. Cells are separated by commas,
    semicolons (decimal commas then) or tabs.

    Parameters
    ----------
    body
        The request as JSON; one that is no object is returned as it is, for its reader to refuse.
    name, content
        The file.

    Returns
    -------
    bytes
        The request as JSON.

    Raises
    ------
    ReadingError
        If the file is no such table: names its line.
    """
    try:
        request: Any = json.loads(body)
    except ValueError:
        return body
    if not isinstance(request, dict):
        return body
    if request.get("played") is not None:
        _refuse("a file and a course in the request: give one of them", code="played_said_twice")
    columns = _columns(name, content)
    played: dict[str, dict[str, list[float]]] = {}
    for heading, values in columns.items():
        if heading != TIMES:
            axis, value = VALUES[heading]
            played.setdefault(axis, {TIMES: columns[TIMES]})[value] = values
    return json.dumps({**request, "played": played}).encode()


def _columns(name: str, content: bytes) -> dict[str, list[float]]:
    try:
        lines = in_utf8(content).decode().splitlines()
    except UnicodeDecodeError as error:
        _refuse(f"{name} is no UTF-8 text: {error.reason}", code="played_not_utf8")
    separator = next((one for one in ";\t" if lines and one in lines[0]), ",")
    table = csv.reader(lines, strict=True, delimiter=separator)
    headings: list[tuple[str, Any]] = []
    columns: dict[str, list[float]] = {}
    try:
        for cells in table:
            if not cells:
                continue
            if not headings:
                headings = _headings(name, cells)
                columns = {heading: [] for heading, _ in headings}
                continue
            if len(cells) != len(headings):
                _refuse(
                    f"{name} line {table.line_num}: {len(cells)} numbers under {len(headings)} "
                    "headings",
                    code="played_line_length",
                )
            for cell, (heading, scale) in zip(cells, headings, strict=True):
                text = cell if separator == "," else cell.replace(",", ".")
                columns[heading].append(scale(_number(name, table.line_num, text)))
    except csv.Error as error:
        _refuse(f"{name} line {table.line_num}: no CSV: {error}", code="played_not_csv")
    return columns


def _headings(name: str, cells: list[str]) -> list[tuple[str, Any]]:
    """Return the headings in SI units, each with what brings its numbers there."""
    found = []
    for cell in cells:
        reading = reading_of(cell.strip())
        found.append((cell.strip(), float) if reading is None else (reading.name, reading.scale))
    names = [heading for heading, _ in found]
    known = {TIMES, *VALUES}
    if TIMES not in names or len(names) < len((TIMES, "values")) or len(set(names)) < len(names):
        _refuse(
            f"{name} line 1: headings must be {TIMES} and others, each once; "
            f"got {', '.join(names)}",
            code="played_headings",
        )
    for heading in names:
        if heading not in known:
            _refuse(
                f"{name} line 1: a heading must be one of {', '.join((TIMES, *VALUES))}; "
                f"got {heading!r}",
                code="played_heading_unknown",
            )
    return found


def _number(name: str, line: int, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        _refuse(f"{name} line {line}: {text!r} is no finite number", code="played_not_number")
    return number


def _refuse(detail: str, code: str) -> NoReturn:
    fault = FieldFault(pointer="/played", code=code, detail=detail)
    raise ReadingError(invalid_fields(f"{fault.pointer}: {detail}", (fault,))) from None
