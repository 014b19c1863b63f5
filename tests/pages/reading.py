"""What stands in the blocks of a page: files to write, commands to type, programs of Python."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]

PAGES = sorted(
    path.relative_to(ROOT).as_posix()
    for path in (ROOT / "README.md", ROOT / "benchmarks/README.md", *(ROOT / "docs").glob("*.md"))
)

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)

FILE_NAME = re.compile(r"`([\w.-]+(?:/[\w.-]+)*\.\w+)`")
"""A file in the text before a block: the block is what it holds."""

PROMPT = "$ "
"""Begins a line to type; what follows, up to the next such line, is printed."""

OMITTED = "..."
"""Stands where a page shows some of the printed lines only."""


COMMENT = re.compile(r"\s{2,}# .*$")
"""What a page says beside a command."""


@dataclass(frozen=True)
class Command:
    """A line to type, and what the page says that it prints; nothing said, nothing compared."""

    typed: str
    prints: list[str] = field(default_factory=list)

    @property
    def line(self) -> str:
        """The line without its comment."""
        return COMMENT.sub("", self.typed)


@dataclass(frozen=True)
class Block:
    """A block of a page: its language, its text, and the file that the text before it names."""

    language: str
    text: str
    file: str | None
    place: slice
    """Where its text stands in the page."""

    @property
    def commands(self) -> list[Command]:
        """Its commands, none if it is no session."""
        return list(_commands(self.text)) if self.text.startswith(PROMPT) else []


def blocks(page: str) -> list[Block]:
    """Return the blocks of a page, a path from the root of the project, in order."""
    text = (ROOT / page).read_text()
    return [
        Block(found[1], found[2], _file_before(text[: found.start()]), slice(*found.span(2)))
        for found in FENCE.finditer(text)
    ]


def prose(page: str) -> str:
    """Return a page without its blocks."""
    return FENCE.sub("", (ROOT / page).read_text())


def _file_before(text: str) -> str | None:
    """Return the file that the paragraph before a block names last, where it ends in a colon."""
    paragraph = text.rstrip().rsplit("\n\n", 1)[-1]
    names = FILE_NAME.findall(paragraph) if paragraph.endswith(":") else []
    return names[-1] if names else None


def _commands(text: str) -> Iterator[Command]:
    lines = text.rstrip("\n").split("\n")
    while lines:
        typed = lines.pop(0).removeprefix(PROMPT)
        while typed.endswith("\\"):
            typed = f"{typed}\n{lines.pop(0)}"
        prints = []
        while lines and not lines[0].startswith(PROMPT):
            prints.append(lines.pop(0))
        yield Command(typed, prints)
