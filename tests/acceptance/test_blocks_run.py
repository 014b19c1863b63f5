"""The blocks of the README and of the pages on designs are what the program takes and prints."""

import json
import re
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from schemas.tables import TableRequest
from service.dispatch import respond
from service.problems import Problem

ROOT = Path(__file__).parents[2]

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)

PAGES = ["README.md", *(f"docs/{name}.md" for name in ("designs", "recommendations", "tables"))]

ROUNDING = 1e-9
"""Printed numbers below this differ from machine to machine [-]."""

DIGITS = 2e-3
"""Share by which other printed numbers may differ: those of four digits by one of the last [-]."""

OMITTED = "..."
"""Stands in a page where it shows some of the lines only."""


def blocks(page: str, language: str) -> list[str]:
    """Return the blocks of a page in a language."""
    found = BLOCK.findall((ROOT / page).read_text())
    return [text for name, text in found if name == language]


REQUESTS = [(page, text) for page in PAGES for text in blocks(page, "json")]

SESSIONS = [(page, text) for page in PAGES for text in blocks(page, "") if text.startswith("$ ")]


@pytest.mark.parametrize(("page", "text"), REQUESTS, ids=[page for page, _ in REQUESTS])
def test_a_request_is_answered(page: str, text: str) -> None:
    asked: dict[str, Any] = json.loads(text)
    if "axes" in asked:
        assert TableRequest.model_validate(asked).to_design().rows > 1, page
        return
    answer = respond("design" if "shaper" in asked else "recommendation", text.encode())
    assert not isinstance(answer, Problem), page


@pytest.mark.parametrize(("page", "text"), SESSIONS, ids=[page for page, _ in SESSIONS])
def test_a_command_prints_what_stands_below_it(page: str, text: str, tmp_path: Path) -> None:
    files = {
        "crane.json": blocks("docs/designs.md", "json")[0],
        "which.json": blocks("docs/recommendations.md", "json")[0],
        "printer.json": blocks("docs/recommendations.md", "json")[1],
    }
    for name, content in files.items():
        (tmp_path / name).write_text(content)
    first, *expected = text.rstrip("\n").split("\n")
    words = re.sub(r"^\$ (\.venv/bin/)?shapersmith ", "", first).split()
    command = [sys.executable, "-m", "service", *words]
    ran = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True)
    printed = ran.stdout.rstrip("\n").split("\n")
    if OMITTED in expected:
        printed = [line for line in printed if any(map(partial(alike, line), expected))]
        expected = [line for line in expected if line != OMITTED]
    assert len(printed) == len(expected), page
    for one, other in zip(printed, expected, strict=True):
        assert alike(one, other), (one, other)


def alike(printed: str, expected: str) -> bool:
    """Return whether two lines have the same words, and numbers of the same size."""
    words, others = printed.split(), expected.split()
    return len(words) == len(others) and all(
        one == other or close(one, other) for one, other in zip(words, others, strict=True)
    )


def close(one: str, other: str) -> bool:
    """Return whether two words are numbers that differ by rounding."""
    try:
        a, b = (float(word.strip(",:%()")) for word in (one, other))
    except ValueError:
        return False
    return max(abs(a), abs(b)) < ROUNDING or abs(a - b) <= DIGITS * max(abs(a), abs(b))
