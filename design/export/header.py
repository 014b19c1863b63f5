"""What every file says of itself: tool, specification, units."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

from design.errors import InvalidInputError
from design.tables.rows import Column, TableHead

TOOL = "shapersmith"

FACTS = (
    "tool",
    "title",
    "specification_sha256",
    "specification",
    "row_count",
    "impulses",
    "amplitudes",
    "columns",
)
"""Names of what a file says of its table."""


END = ""
"""Stands for the line on which a head ends."""


def facts(head: TableHead) -> dict[str, str]:
    """Return the head of a table as JSON texts, one line each.

    `head_of` reads it back; the polynomials of a fit are for programs and not among them.
    """
    columns = [[column.name, column.unit, column.kind] for column in head.columns]
    texts = (
        json.dumps(f"{TOOL} {head.version}"),
        json.dumps(head.title),
        json.dumps(head.specification_sha256),
        head.specification_json,
        json.dumps(head.rows),
        json.dumps(head.impulses),
        json.dumps(head.amplitudes),
        json.dumps(columns),
    )
    return dict(zip(FACTS, texts, strict=True))


def head_of(texts: dict[str, str], lines: Mapping[str, int] | None = None) -> TableHead:
    """Return the head of a table from its `facts`.

    Parameters
    ----------
    texts
        The facts.
    lines
        Line of each fact in a file of text, and under `END` that on which the head ends.

    Returns
    -------
    TableHead
        Without a subject.

    Raises
    ------
    InvalidInputError
        If a fact is missing or is no JSON of its kind, or the specification is another than that of
        its hash.
    """
    values: dict[str, Any] = {}
    for name in FACTS:
        try:
            values[name] = json.loads(texts[name])
        except (KeyError, ValueError) as error:
            what = "without" if isinstance(error, KeyError) else "with an unreadable"
            line = (lines or {}).get(name, (lines or {}).get(END))
            _refuse_head(f"{f'line {line}: ' if line else ''}a head {what} {name}")
    specification = texts["specification"]
    sha256 = hashlib.sha256(specification.encode()).hexdigest()
    if values["specification_sha256"] != sha256:
        raise InvalidInputError(
            "specification_sha256",
            values["specification_sha256"],
            f"the hash of the file's specification, {sha256}",
            code="wrong_hash",
        )
    try:
        return TableHead(
            version=values["tool"].removeprefix(f"{TOOL} "),
            specification_json=specification,
            specification_sha256=sha256,
            title=values["title"],
            columns=tuple(
                Column(name=name, unit=unit, kind=kind) for name, unit, kind in values["columns"]
            ),
            rows=values["row_count"],
            impulses=values["impulses"],
            amplitudes=tuple(values["amplitudes"]),
        )
    except (ValueError, TypeError, AttributeError) as error:
        _refuse_head(f"a head without a sound fact: {error}")


def _refuse_head(what: str) -> NoReturn:
    raise InvalidInputError(
        "file", what, "a table as shapersmith writes it", code="unsound_head"
    ) from None


def short_names(fields: Sequence[str]) -> list[str]:
    """Return names of fields that programs take.

    Parameters
    ----------
    fields
        Their paths, as ``plant.cable_length_m``.

    Returns
    -------
    list of str
        The last part of each, or the whole path where two would have one name.

    Examples
    --------
    >>> short_names(["plant.cable_length_m", "plant.damping_ratio"])
    ['cable_length_m', 'damping_ratio']
    """
    last = [field.rpartition(".")[2] for field in fields]
    if len(set(last)) == len(last):
        return last
    return [field.replace(".", "_") for field in fields]


def comment_lines(head: TableHead) -> list[str]:
    """Return the head of a table as lines of a comment."""
    count = "1 row" if head.rows == 1 else f"{head.rows} rows"
    units = ", ".join(f"{column.name} [{column.unit}]" for column in head.columns if column.unit)
    return [
        # On one line, whatever the title: what follows a comment is run by a machine.
        f"{' '.join(head.title.split())}: {count}, by {TOOL} {head.version}",
        f"specification sha256 {head.specification_sha256}",
        f"units: {units}",
    ]
