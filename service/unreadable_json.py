"""Why a text is no JSON, in the words of who wrote it: where, what stands there, what is meant."""

import json
import re
from json import detect_encoding

EXCERPT_CHARACTERS = 24
"""Characters of a line that are shown before and after a fault."""

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

BEFORE = re.compile(r"[-+]?[\d.]*,?\Z")
AT = re.compile(r"[-+]?[\d.]*(?:[eE][-+]?\d+)?")
"""The part of a number before a fault, and from there on."""

PARTS = re.compile(r"([-+]?)(\d*)(?:[.,](\d*))?([eE][-+]?\d+)?")

BINARY = re.compile(rb"[\x00-\x08\x0e-\x1a\x1c-\x1f]")
"""Bytes that no text has."""

LOOKED_AT_BYTES = 512

SECTION = re.compile(r"\s*\[\s*[A-Za-z][\w .-]*\]\s*(\n|\Z)")
"""A heading as TOML, INI and the files of printers have it."""

EXAMPLE = "0.8"
"""A number to show where none can be read."""

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
        text = content if isinstance(content, str) else _decoded(content)
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


def _decoded(content: bytes) -> str:
    encoding = detect_encoding(content)
    if encoding != "utf-8":
        mark = "UTF-8 with a byte order mark" if encoding == "utf-8-sig" else encoding.upper()
        raise ValueError(f"the text is {mark}: send UTF-8 without a byte order mark")
    if BINARY.search(content[:LOOKED_AT_BYTES]):
        raise ValueError("the file is no text: a request is JSON")
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        before = content[: error.start].decode()
        line, column = _place(before, len(before))
        told = f"byte 0x{content[error.start]:02x} is no UTF-8: save the text as UTF-8"
        raise ValueError(f"line {line}, column {column}: {told}") from None


def _told(text: str, error: json.JSONDecodeError) -> str:
    at = error.pos
    line, column = _place(text, at)
    return f"line {line}, column {column}: {_cause(text, at, error.msg)}, near {_excerpt(text, at)}"


def _cause(text: str, at: int, said: str) -> str:
    if not text.lstrip().startswith(("{", '"')) and (at == 0 or SECTION.match(text)):
        return "a request is JSON, which begins with {; TOML is read from files named .toml"
    before, after = text[max(at - 100, 0) : at], text[at : at + 100]
    if not text[at:].strip():
        return "the text ends here: a bracket or a quote is not closed"
    if not said.startswith(("Unterminated", "Invalid")):
        for ahead, here, cause in AT_FAULT:
            if re.search(rf"(?:{ahead})\Z", before) and re.match(here, after):
                return cause.format(figure=_figure(before, after)) if "{" in cause else cause
    return MEANING.get(said, said)


def _figure(before: str, after: str) -> str:
    """Return the number at a fault as JSON has it."""
    ahead, behind = BEFORE.search(before), AT.match(after)
    text = f"{ahead[0] if ahead else ''}{behind[0] if behind else ''}"
    parts = PARTS.fullmatch(text)
    if parts is None or not (parts[2] or parts[3]):
        return EXAMPLE
    sign, whole, share, power = (part or "" for part in parts.groups())
    point = "" if parts[3] is None else f".{share or '0'}"
    return f"{sign.replace('+', '')}{whole.lstrip('0') or '0'}{point}{power}"


def _place(text: str, at: int) -> tuple[int, int]:
    """Return line and column of a character, counted from 1."""
    return text.count("\n", 0, at) + 1, at - text.rfind("\n", 0, at)


def _excerpt(text: str, at: int) -> str:
    """Return the part of a line that holds a character."""
    start = text.rfind("\n", 0, at) + 1
    end = text.find("\n", at)
    line_end = len(text) if end < 0 else end
    first, last = max(start, at - EXCERPT_CHARACTERS), min(line_end, at + EXCERPT_CHARACTERS)
    dots = ("..." if first > start else "", "..." if last < line_end else "")
    return f"`{dots[0]}{text[first:last].strip()}{dots[1]}`"
