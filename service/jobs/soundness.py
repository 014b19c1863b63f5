"""Whether what stands in a job's record can be: a disk, or a person, may have changed it."""

import math
from collections.abc import Callable, Mapping
from typing import Any

MAX_VALUE_CHARACTERS = 60
"""Characters of a value that a message repeats."""


def _text(value: object) -> bool:
    return isinstance(value, str)


def _id(value: object) -> bool:
    # What is no UTF-8 is read with this in place of it, and then names another job, or none.
    return isinstance(value, str) and "\ufffd" not in value


def _count(value: object) -> bool:
    return isinstance(value, int) and value >= 0


def _positive(value: object) -> bool:
    return isinstance(value, int) and value >= 1


def _time(value: object) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def _or_none(rule: Callable[[object], bool]) -> Callable[[object], bool]:
    return lambda value: value is None or rule(value)


RULES: dict[str, Callable[[object], bool]] = {
    "id": _id,
    "state": _text,
    "reason": _text,
    "created": _time,
    "sha256": _text,
    "version": _text,
    "rows": _positive,
    "chunks": _positive,
    "impulses": _or_none(_positive),
    "chunk_rows": _positive,
    "estimated_bytes": _count,
    "begun": _count,
    "served": _time,
    "key": _or_none(_text),
    "rows_done": _count,
    "verified": _count,
    "verified_ideal": _count,
    "infeasible": _count,
    "last_finished": _or_none(_time),
    "earlier_from": _or_none(_time),
    "earlier_rows": _count,
    "lately_from": _or_none(_time),
    "lately_rows": _count,
}
"""What each column of a job may hold."""


def damage_of(record: Mapping[str, Any]) -> str:
    """Return in words what cannot be in the record of a job.

    Parameters
    ----------
    record
        The record, by the names of its columns.

    Returns
    -------
    str
        Every column that breaks its rule, or else those that contradict each other; empty of a
        sound record.
    """
    wrong = [name for name, rule in RULES.items() if not rule(record[name])]
    if not wrong:
        told = record["verified"] + record["verified_ideal"] + record["infeasible"]
        agreeing = {
            "chunks": record["chunks"] == -(-record["rows"] // record["chunk_rows"]),
            "begun": record["begun"] <= record["chunks"],
            "rows_done": told <= record["rows_done"] <= record["rows"],
        }
        wrong = [name for name, holds in agreeing.items() if not holds]
    if not wrong:
        return ""
    values = ", ".join(
        f"{name} cannot be {repr(record[name])[:MAX_VALUE_CHARACTERS]}" for name in wrong
    )
    return f"its record in the job store is damaged: {values}"
