"""Where a fault of a text is, what stands there, and which cause fits."""

import re
from json import detect_encoding

BINARY = re.compile(rb"[\x00-\x08\x0e-\x1a\x1c-\x1f]")
"""Bytes that no text has."""

LOOKED_AT_BYTES = 512

EXCERPT_CHARACTERS = 24
"""Characters of a line that are shown before and after a fault."""

BEFORE = re.compile(r"[-+]?[\d.]*,?\Z")
AT = re.compile(r",?[-+]?[\d.]*(?:[eE][-+]?\d+)?")
"""The part of a number before a fault, and from there on."""

PARTS = re.compile(r"([-+]?)(\d*)(?:[.,](\d*))?([eE][-+]?\d+)?")

EXAMPLE = "0.8"
"""A number to show where none can be read."""

Cause = tuple[str, str, str]
"""What stands before a fault, what at it, and what is said; ``{figure}`` is the number meant."""


def decoded(content: bytes) -> str:
    """Return a text of UTF-8.

    Parameters
    ----------
    content
        The bytes of a request.

    Returns
    -------
    str
        Their text.

    Raises
    ------
    ValueError
        If they are no UTF-8: says what they are, in words for the writer.
    """
    encoding = detect_encoding(content)
    if encoding != "utf-8":
        mark = "UTF-8 with a byte order mark" if encoding == "utf-8-sig" else encoding.upper()
        raise ValueError(f"the text is {mark}: send UTF-8 without a byte order mark")
    if BINARY.search(content[:LOOKED_AT_BYTES]):
        raise ValueError("the file is no text: a request is JSON or TOML")
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        before = content[: error.start].decode()
        line, column = place(before, len(before))
        told = f"byte 0x{content[error.start]:02x} is no UTF-8: save the text as UTF-8"
        raise ValueError(f"line {line}, column {column}: {told}") from None


def cause_of(text: str, at: int, causes: tuple[Cause, ...]) -> str | None:
    """Return what is said of a fault: the first cause that fits.

    Parameters
    ----------
    text, at
        The text, and where its fault is.
    causes
        In the order in which they are tried.

    Returns
    -------
    str or None
        None if none fits.
    """
    before, after = text[max(at - 100, 0) : at], text[at : at + 100]
    for ahead, here, cause in causes:
        if re.search(rf"(?:{ahead})\Z", before) and re.match(here, after):
            return cause.replace("{figure}", _figure(before, after))
    return None


def told_at(text: str, at: int, cause: str) -> str:
    """Return line, column, cause and excerpt of a fault.

    Parameters
    ----------
    text, at
        The text, and where its fault is.
    cause
        What the fault is.

    Returns
    -------
    str
        One line; places are counted from 1.
    """
    line, column = place(text, at)
    return f"line {line}, column {column}: {cause}, near {_excerpt(text, at)}"


def place(text: str, at: int) -> tuple[int, int]:
    """Return line and column of a character.

    Parameters
    ----------
    text, at
        The text, and where the character is.

    Returns
    -------
    tuple of int
        Counted from 1.
    """
    return text.count("\n", 0, at) + 1, at - text.rfind("\n", 0, at)


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


def _excerpt(text: str, at: int) -> str:
    """Return the part of a line that holds a character."""
    start = text.rfind("\n", 0, at) + 1
    end = text.find("\n", at)
    line_end = len(text) if end < 0 else end
    first, last = max(start, at - EXCERPT_CHARACTERS), min(line_end, at + EXCERPT_CHARACTERS)
    dots = ("..." if first > start else "", "..." if last < line_end else "")
    return f"`{dots[0]}{text[first:last].strip()}{dots[1]}`"
