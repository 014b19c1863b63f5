"""Why a text is no JSON, in the words of who wrote it: where, what stands there, what is meant."""

import json
import re

from service.unreadable_text import cause_of, decoded, told_at

AT_FAULT = (
    (r"\d,", r"\d", "a decimal comma: numbers have a point, as {figure}"),
    (r"", r"//|/\*|#", "a comment: JSON has none; TOML has, on the command line"),
    (r",\s*", r"[}\]]", "a comma before a closing bracket: JSON has none there"),
    (r"", r",\s*[}\]]", "a comma before a closing bracket: JSON has none there"),
    (r"", r"'", "single quotes: JSON has double quotes"),
    (
        r"",
        "[\u201c\u201d\u201e\u201f\u00ab\u00bb\u2018\u2019]",
        "typographic quotes: JSON has straight double ones",
    ),
    (r"", r"(True|False|None)\b", "a word of Python: JSON has true, false and null"),
    (r"", r"[-+]?\.\d", "a number without a digit ahead of its point: write {figure}"),
    (r"", r"\+", "a plus sign: JSON numbers have none ahead, write {figure}"),
    (r"(^|[^\d.])-?0", r"\d", "a number with a zero ahead: JSON has none there, write {figure}"),
    (r"\d", r"\.(?!\d)", "a number without a digit after its point: write {figure}"),
    (r"[{,]\s*", r"\w", "a name without double quotes"),
)
"""What stands before and at a fault, and what it is, with the number meant; the first that fits is
said."""

SECTION = re.compile(r"\s*\[\s*[A-Za-z][\w .-]*\]\s*(\n|\Z)")
"""A heading as TOML, INI and the files of printers have it."""

MEANING = {
    "Extra data": "more text after the end of the value: one request a text",
    "Expecting ',' delimiter": "a comma is missing ahead of this",
    "Expecting ':' delimiter": "a colon is missing ahead of this",
    "Expecting property name enclosed in double quotes": "a name in double quotes is expected",
    "Expecting value": "a value is expected",
    "Unterminated string starting at": "a text whose closing quote is missing",
    "Invalid control character at": "a line break or tab within a text",
    "Invalid \\escape": "a backslash within a text: JSON writes two",
}
"""What Python's reader says, in the same words as the rest."""


def why_unreadable(content: bytes | str, otherwise: str) -> str:
    """Return why a text is no JSON.

    Parameters
    ----------
    content, otherwise
        The text, and what to say where no cause is known.

    Returns
    -------
    str
        Line, column, cause and excerpt, counted from 1.
    """
    try:
        text = content if isinstance(content, str) else decoded(content)
    except ValueError as error:
        return str(error)
    if not text.strip():
        return "the text is empty: a JSON object is expected"
    try:
        json.loads(text)
    except json.JSONDecodeError as error:
        return _told(text, error)
    except RecursionError:
        return "lists or objects are nested too deep"
    except ValueError:
        return "a whole number has more digits than are read"
    return otherwise


def _told(text: str, error: json.JSONDecodeError) -> str:
    return told_at(text, error.pos, _cause(text, error.pos, error.msg))


def _cause(text: str, at: int, said: str) -> str:
    if not text.lstrip().startswith(("{", '"')) and (at == 0 or SECTION.match(text)):
        return "a request is JSON, which begins with {; TOML is read from files named .toml"
    if not text[at:].strip():
        return "the text ends here: a bracket or a quote is not closed"
    told = None if said.startswith(("Unterminated", "Invalid")) else cause_of(text, at, AT_FAULT)
    return told or MEANING.get(said, said)
