"""Why a text is no TOML, in the words of who wrote it: where, what stands there, what is meant."""

import re

from service.unreadable_text import cause_of, decoded, told_at

PLACE = re.compile(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)\Z", re.DOTALL)
"""What Python's reader says, and where."""

AT_FAULT = (
    (r"\A\s*", r"\{", "this is JSON: a file of JSON is named .json"),
    (r"=\s*[-+]?\d+", r",\d", "a decimal comma: numbers have a point, as {figure}"),
    (r"", r"\s*(?://|/\*|;)", "a comment begins with # in TOML"),
    (
        r"",
        "[\u201c\u201d\u201e\u201f\u00ab\u00bb\u2018\u2019]",
        "typographic quotes: TOML has straight ones",
    ),
    (r"", r"(?:True|False)\b", "a word of Python: TOML has true and false"),
    (r"", r"(?:null|None|nil)\b", "TOML has no empty value: omit the line"),
    (r"\.\d*", r"\.\d", "a number with two points"),
    (r"[=\[,]\s*", r"[-+]?\.\d", "a number without a digit ahead of its point: write {figure}"),
    (r"\d", r"\.(?!\d)", "a number without a digit after its point: write {figure}"),
    (r"(?:^|[^\d.])[-+]?0", r"\d", "a number with a zero ahead: write {figure}"),
    (
        r"\d\s*",
        "[A-Za-z%\u00b0]\\S*\\s*(?:[\n#,\\]}]|\\Z)",
        "a unit behind a number: the name of the field has the unit",
    ),
    (r"[=\[,]\s*", r"[A-Za-z_]", "a text without quotes: write it in double quotes"),
    (r"", r"\s*:", "a colon: TOML has = between a name and its value"),
    (r"(?:\A|\n)\s*[\w.-]+\s+", r"[\w.-]+.*=", "a name in two words: write it in double quotes"),
    (
        r"(?:\A|\n)\s*",
        r"[^\x00-\x7f]",
        "a name of other letters than a to z: write it in double quotes",
    ),
    (r"[{,]\s*", r"\s*[\n}]", "a line break or a comma at the end within {}: TOML has none there"),
)
"""What stands before and at a fault, and what it is; the first that fits is said."""

MEANING = {
    "Cannot overwrite": "a name that stands twice",
    "Cannot declare": "a heading that stands twice",
    "Duplicate inline table key": "a name that stands twice",
    "Cannot mutate immutable": "a name below a value that is whole already",
    "Invalid initial character for a key part": "a name is expected",
    "Unterminated string": "a text whose closing quote is missing",
    'Expected "\'"': "a text whose closing quote is missing",
    "Unescaped": "a backslash within a text: write two, or single quotes around it",
    "Invalid hex value": "a backslash within a text: write two, or single quotes around it",
    "Unclosed array": "a list without its closing bracket, or without a comma",
    "Unclosed inline table": "a brace without its closing one",
    "Expected ']' at the end": "a heading without its closing bracket",
    "Expected ']]' at the end": "a heading without its closing brackets",
    "Expected '=' after a key": "= is expected after a name",
    "Expected newline": "more text after a value: a line holds one name and one value",
    "Illegal character": "a line break or tab within a text, or its closing quote is missing",
    "Invalid value": "a value is expected",
    "Invalid statement": "a line is a heading in brackets, or a name, = and a value",
}
"""What begins as Python's reader says, in the same words as the rest."""


def why_no_toml(content: bytes | str, said: str) -> str:
    """Return why a text is no TOML.

    Parameters
    ----------
    content, said
        The text, and what Python's reader says of it.

    Returns
    -------
    str
        Line, column, cause and excerpt, counted from 1.
    """
    try:
        text = content if isinstance(content, str) else decoded(content)
    except ValueError as error:
        return str(error)
    text = text.replace("\r\n", "\n")
    found = PLACE.match(said)
    if found is None:
        return "lists or tables are nested too deep" if "recursion" in said else said
    message = found[1]
    at = len(text) if found[2] is None else _offset(text, int(found[2]), int(found[3]))
    told = next((words for begin, words in MEANING.items() if message.startswith(begin)), message)
    if not message.startswith(("Cannot", "Duplicate")):
        told = cause_of(text, at, AT_FAULT) or told
    if not text[at:].strip():
        at = len(text.rstrip())
    return told_at(text, at, told)


def _offset(text: str, line: int, column: int) -> int:
    """Return where a place is in a text."""
    before = text.split("\n")[: line - 1]
    return sum(len(one) + 1 for one in before) + column - 1
