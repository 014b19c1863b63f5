"""What the documents say is what there is."""

import re
from pathlib import Path

import pytest

from docs.reference import PAGES, PLACE, with_tables

ROOT = Path(__file__).parents[3]

DOCUMENTS = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "benchmarks/README.md")),
    *sorted((ROOT / "docs").glob("*.md")),
]

MADE = {"kinds.md", "commands.md", "errors.md"}
"""Pages that are made when the site is built, by `docs/reference.py`."""

MOST_WORDS = 700
"""Words of the README: it is a window, and the shop is in `docs`."""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_tables_are_as_the_code_makes_them(page: Path) -> None:
    """If not: `python -m docs.reference`."""
    text = page.read_text()
    assert PLACE.search(text)
    assert with_tables(text) == text


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text().split()) <= MOST_WORDS


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_to_files_that_are_there(document: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)", document.read_text())
    lost = [
        link
        for link in links
        if not link.startswith(("http://", "https://"))
        and not (document.parent / link).exists()
        and link not in MADE
    ]
    assert not lost


def test_every_page_is_reached_from_the_list_of_pages() -> None:
    assert "](docs/index.md)" in (ROOT / "README.md").read_text()
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} | MADE
    listed = set(re.findall(r"\]\(([a-z-]+\.md)\)", (ROOT / "docs/index.md").read_text()))
    assert pages == listed | {"index.md"}
