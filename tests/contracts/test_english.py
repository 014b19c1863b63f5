"""Documents, messages, descriptions and docstrings are written in the words of the glossary."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.syntax import parsed

ROOT = Path(__file__).parents[2]

DOCUMENTS = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "benchmarks/README.md")),
    *sorted((ROOT / "docs").glob("*.md")),
]

MODULES = [
    path
    for package in ("design", "schemas", "service", "shapersmith")
    for path in sorted((ROOT / package).rglob("*.py"))
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

LINES_OF_FILES = {
    "design/export/klipper.py": ("Klipper's fit leaves ",),
    "design/export/live.py": ("behind this drive, ", "where they superpose each change leaves"),
    "design/export/reprap.py": ("; rounded as the firmware does, it leaves ",),
}
"""Where texts begin that stand in files of tables: their bytes do not change with the words."""

BARE_FRACTION = re.compile(r"(?<![\w./\])])\.\d")
"""A decimal fraction without its zero."""


def prose(document: Path) -> str:
    """Return a document without its fenced blocks: these show what programs print and read."""
    return re.sub(r"^```.*?^```$", "", document.read_text(), flags=re.DOTALL | re.MULTILINE)


def texts(module: Path) -> Iterator[str]:
    """Yield what a module says: its messages, descriptions and docstrings."""
    lines_of_files = LINES_OF_FILES.get(str(module.relative_to(ROOT)), ())
    for node in ast.walk(parsed(module)):
        text = node.value if isinstance(node, ast.Constant) else None
        if isinstance(text, str) and not text.startswith(lines_of_files):
            yield text


def faults(text: str) -> list[str]:
    """Return each phrase of a text that the glossary replaces, with what to say."""
    joined = " ".join(text.split())
    return [
        f"{match[0]!r} in {joined[max(match.start() - 40, 0) : match.end() + 40]!r}: say {better}"
        for phrase, better in SAY_INSTEAD.items()
        for match in re.finditer(rf"\b{phrase}\b", joined, re.IGNORECASE)
    ]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_document_uses_the_words_of_the_glossary(document: Path) -> None:
    found = faults(prose(document))
    assert not found, "\n".join(found)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_fraction_has_its_zero(document: Path) -> None:
    assert not BARE_FRACTION.findall(prose(document))


@pytest.mark.parametrize("module", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_module_uses_the_words_of_the_glossary(module: Path) -> None:
    found = [fault for text in texts(module) for fault in faults(text)]
    assert not found, "\n".join(found)
