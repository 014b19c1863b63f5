"""Sentences of the documentation can be read in one breath."""

import re

import pytest

from tests.pages.reading import PAGES, prose

MAX_WORDS = 35
"""Words of a sentence."""

NO_SENTENCES = ("|", "#", "    ", "<", "![")
"""Tables, headings, formulas, pictures."""

ITEM = re.compile(r"\n(?=\s*(?:-|\d+\.)\s)")

END = re.compile(r"(?<=[.?!])\s")


def sentences(page: str) -> list[str]:
    """Return the sentences of a page, those of lists by their items."""
    paragraphs = re.split(r"\n\s*\n", prose(page))
    read = [one for one in paragraphs if not one.lstrip("\n").startswith(NO_SENTENCES)]
    items = [" ".join(item.split()) for one in read for item in ITEM.split(one)]
    return [sentence for item in items for sentence in END.split(item)]


@pytest.mark.parametrize("page", [*PAGES, "CONTRIBUTING.md"])
def test_no_sentence_is_long(page: str) -> None:
    assert [one for one in sentences(page) if len(one.split()) > MAX_WORDS] == []
