"""The specification of a table from files: JSON or TOML; its list from JSON Lines, CSV or TOML."""

import csv
import json
import math
import os
import re
import tomllib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NoReturn

from schemas.pointers import path_of
from schemas.problems import FieldFault
from service.problems import NOT_JSON, Problem, invalid_fields, problem_of_repetition
from service.repeated_names import RepeatedNameError
from service.strict_json import loads
from service.unreadable_json import why_unreadable
from service.unreadable_toml import why_no_toml

LISTED = re.compile(r"/designs/(\d+)(/.*)?\Z")


class ReadingError(Exception):
    """A file that cannot be read as what it should be."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.detail)
        self.problem = problem


@dataclass(frozen=True, slots=True)
class Source:
    """A specification as one JSON body, and on which line of which file its designs stood."""

    body: bytes
    file: str = ""
    read: os.stat_result | None = None
    lines: list[int] = field(default_factory=list)

    def locate(self, problem: Problem) -> Problem:
        """Return a problem with the place of a listed design that is at fault.

        Parameters
        ----------
        problem
            What is wrong with the body.

        Returns
        -------
        Problem
            With file and line in place of a pointer into the list; the same if no listed design is
            at fault.
        """
        faults = []
        for fault in problem.errors:
            place = LISTED.match(fault.pointer)
            if place is None or not self.lines:
                faults.append(fault)
                continue
            line = self.lines[int(place[1])]
            told = f"{self.file} line {line}: {place[2] or ''} {fault.detail}".replace("  ", " ")
            faults.append(FieldFault(pointer="/designs_file", code=fault.code, detail=told))
        if faults == list(problem.errors):
            return problem
        detail = "; ".join(f"{fault.pointer}: {fault.detail}" for fault in faults)
        return replace(problem, detail=detail, errors=tuple(faults))


def read_source(content: bytes, *, toml: bool, folder: Path) -> Source:
    """Return a specification with its listed designs read in.

    Parameters
    ----------
    content
        The specification.
    toml
        Whether it is TOML; else it is JSON.
    folder
        Where the file that lists designs is looked for.

    Returns
    -------
    Source
        The specification as one JSON body.

    Raises
    ------
    ReadingError
        If a file is missing, or a line of it is bad: says which.
    """
    body = _value_of(content, toml=toml)
    name = body.get("designs_file") if isinstance(body, dict) else None
    if not isinstance(name, str):
        return Source(json.dumps(body, default=str).encode())
    if "designs" in body:
        _refuse("designs_file and designs: give one of them", code="designs_said_twice")
    try:
        with (folder / name).open("rb") as file:
            listed, read = in_utf8(file.read()).decode(), os.fstat(file.fileno())
    except OSError as error:
        _refuse(f"cannot read {name}: {error.strerror}", code="file_not_readable")
    except UnicodeDecodeError as error:
        _refuse(f"{name} is no UTF-8 text: {error.reason}", code="file_not_utf8")
    reader = {".csv": _from_csv, ".toml": _from_toml}.get(Path(name).suffix.lower(), _lines)
    designs = reader(name, listed)
    del body["designs_file"]
    body["designs"] = [design for _, design in designs]
    lines = [line for line, _ in designs]
    return Source(json.dumps(body, default=str).encode(), name, read, lines)


def read_request(content: bytes, *, toml: bool) -> bytes:
    """Return a request as JSON in UTF-8.

    Parameters
    ----------
    content
        JSON or TOML, in UTF-8 or, with or without a byte order mark, in UTF-16 or UTF-32.
    toml
        Whether it is TOML.

    Returns
    -------
    bytes
        JSON as it is: whoever reads it finds its faults.

    Raises
    ------
    ReadingError
        If it is no TOML.
    """
    if not toml:
        return in_utf8(content)
    return json.dumps(_value_of(content, toml=True), default=str).encode()


def in_utf8(content: bytes) -> bytes:
    """Return a text in UTF-8 without a mark; as it is where it cannot be read."""
    encoding = json.detect_encoding(content)
    try:
        return content if encoding == "utf-8" else content.decode(encoding).encode()
    except UnicodeDecodeError:
        return content


def _value_of(content: bytes, *, toml: bool) -> Any:  # noqa: ANN401
    text = in_utf8(content)
    try:
        return tomllib.loads(text.decode()) if toml else loads(text)
    except RepeatedNameError as error:
        raise ReadingError(problem_of_repetition(error)) from None
    except (ValueError, RecursionError) as error:
        told = (why_no_toml if toml else why_unreadable)(text, str(error))
        problem = Problem(NOT_JSON, f"no TOML: {told}" if toml else told)
        raise ReadingError(problem) from None


def _refuse(detail: str, code: str) -> NoReturn:
    fault = FieldFault(pointer="/designs_file", code=code, detail=detail)
    raise ReadingError(invalid_fields(f"{fault.pointer}: {detail}", (fault,))) from None


def _lines(name: str, text: str) -> list[tuple[int, dict[str, Any]]]:
    designs = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip():
            continue
        try:
            design = loads(line)
        except ValueError as error:
            told = why_unreadable(line, str(error)).removeprefix("line 1, ")
            _refuse(f"{name} line {number}: {told}", code="line_not_json")
        if not isinstance(design, dict):
            _refuse(
                f"{name} line {number}: must be a JSON object, got {line[:80]}",
                code="line_not_object",
            )
        designs.append((number, design))
    return designs


def _from_toml(name: str, text: str) -> list[tuple[int, dict[str, Any]]]:
    """Return the tables ``[[designs]]``, each with the line of its heading."""
    try:
        designs = tomllib.loads(text).get("designs")
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        told = why_no_toml(text, str(error))
        _refuse(f"{name}: no TOML: {told}", code="list_not_toml")
    heads = [
        number
        for number, line in enumerate(text.splitlines(), start=1)
        if re.match(r"\s*\[\[\s*designs\s*\]\]", line)
    ]
    if not isinstance(designs, list) or len(heads) != len(designs):
        _refuse(
            f"{name}: must hold each design under a heading [[designs]]",
            code="list_without_headings",
        )
    return list(zip(heads, designs, strict=True))


def _from_csv(name: str, text: str) -> list[tuple[int, dict[str, Any]]]:
    lines = text.splitlines()
    separator = _separator(lines)
    _refuse_mixed_decimals(name, separator, lines)
    table = csv.reader(lines, strict=True, delimiter=separator)
    designs: list[tuple[int, dict[str, Any]]] = []
    header: list[str] = []
    try:
        for cells in table:
            number = table.line_num
            if not cells:
                continue
            if not header:
                header = _header(name, number, cells)
            elif len(cells) != len(header):
                _refuse(
                    f"{name} line {number}: {len(cells)} cells under {len(header)} headings",
                    code="cells_unlike_headings",
                )
            else:
                points = cells if separator == "," else [one.replace(",", ".") for one in cells]
                designs.append((number, _nest(name, number, header, points)))
    except csv.Error as error:
        _refuse(f"{name} line {table.line_num}: {error}", code="line_not_csv")
    return designs


def _separator(lines: list[str]) -> str:
    """Return what separates cells: what the headings hold; pointers of numbers hold none."""
    headings = next((line for line in lines if line.strip()), "")
    return next((one for one in (";", "\t") if one in headings), ",")


def _refuse_mixed_decimals(name: str, separator: str, lines: list[str]) -> None:
    """Refuse points beside decimal commas: 1,234 may be either a little or a thousand."""
    if separator == ",":
        return
    point, comma = (
        next((number for number, line in enumerate(lines, start=1) if sign in line), None)
        for sign in (".", ",")
    )
    if point is not None and comma is not None:
        _refuse(
            f"{name} line {max(point, comma)}: decimal commas and points in one list: take one",
            code="decimals_mixed",
        )


def _header(name: str, number: int, cells: list[str]) -> list[str]:
    pointers = [cell.strip() for cell in cells]
    for pointer in pointers:
        within = [other for other in pointers if other.startswith(f"{pointer}/")]
        if not pointer.startswith("/") or pointers.count(pointer) > 1 or within:
            _refuse(
                f"{name} line {number}: headings must be JSON pointers of numbers, each once, as "
                f"/plant/cable_length_m; got {pointer!r}",
                code="heading_not_pointer",
            )
    return pointers


def _nest(name: str, number: int, header: list[str], cells: list[str]) -> dict[str, Any]:
    design: dict[str, Any] = {}
    for pointer, cell in zip(header, cells, strict=True):
        try:
            value = float(cell)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            _refuse(
                f"{name} line {number}: {pointer} must be a finite number, got {cell!r}",
                code="cell_not_finite",
            )
        *parts, last = path_of(pointer)
        here = design
        for part in parts:
            here = here.setdefault(part, {})
        here[last] = value
    return design
