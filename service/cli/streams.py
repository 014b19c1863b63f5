"""What the command prints is read the same everywhere: on a screen, in a file, by a program."""

import codecs
import io
import json
import os
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from schemas.warnings import WarningOut

ESCAPED = "shapersmith-escaped"
"""Python's name of what takes the place of a letter that an encoding lacks."""


def prepare() -> None:
    r"""Let no letter be lost or refused on standard output and standard error.

    What goes to a file or a program is UTF-8, its lines ended by a line feed, on every system. A
    screen keeps its encoding, and so does whoever sets ``PYTHONIOENCODING``. A letter that it lacks
    is escaped as in JSON: ✓ is ``\u2713``.
    """
    codecs.register_error(ESCAPED, _escaped)
    for stream in (sys.stdout, sys.stderr):
        if not isinstance(stream, io.TextIOWrapper):
            continue  # whoever put it there reads text
        if stream.isatty() or "PYTHONIOENCODING" in os.environ:
            stream.reconfigure(errors=ESCAPED)
        else:
            stream.reconfigure(encoding="utf-8", errors=ESCAPED, newline="\n")


def _escaped(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return json.dumps(error.object[error.start : error.end])[1:-1], error.end


def warn(warnings: Iterable["WarningOut"]) -> None:
    """Print warnings beside an answer that has no place for them.

    Parameters
    ----------
    warnings
        Each is a line on standard error.
    """
    for one in warnings:
        print(f"shapersmith: warning: {one.code}: {one.detail}", file=sys.stderr)  # noqa: T201
