"""The documents are written in the words of the project's glossary."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

DOCUMENTS = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "benchmarks/README.md")),
    *sorted((ROOT / "docs").glob("*.md")),
]

SAY_INSTEAD = {
    r"tells": "reports, shows or says",
    r"told": "reported",
    r"leaves": "the residual is",
    r"but for": "except",
    r"likewise": "as above, or: the same holds",
    r"of its own": "separate",
    r"by the solver's word": "as reported by the solver, not certified",
    r"changed places": "swapped",
    r"so many as": "as many as",
}
"""What reads badly, and what to say in its place."""

BARE_FRACTION = re.compile(r"(?<![\w./\])])\.\d")
"""A decimal fraction without its zero."""


def prose(document: Path) -> str:
    """Return a document without its fenced blocks: these show what programs print and read."""
    return re.sub(r"^```.*?^```$", "", document.read_text(), flags=re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_document_uses_the_words_of_the_glossary(document: Path) -> None:
    text = " ".join(prose(document).split())
    found = [
        f"{match[0]!r} in {text[max(match.start() - 40, 0) : match.end() + 40]!r}: say {better}"
        for phrase, better in SAY_INSTEAD.items()
        for match in re.finditer(rf"\b{phrase}\b", text, re.IGNORECASE)
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_fraction_has_its_zero(document: Path) -> None:
    assert not BARE_FRACTION.findall(prose(document))
