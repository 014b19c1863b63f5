"""Every block of every page does what the page says: files are read, commands print what stands."""

from pathlib import Path

import pytest

from tests.pages.following import differences, follower
from tests.pages.reading import PAGES, PROMPT, ROOT, blocks

INDENTED = f"\n\n    {PROMPT}"
"""A session that is no block of these tests."""


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page)])
def test_a_page_can_be_followed(page: str, tmp_path: Path) -> None:
    with follower(page, tmp_path) as reader:
        for block in blocks(page):
            printed = reader.follow(block)
            expected = [one.prints for one in block.commands] or [block.text.rstrip().split("\n")]
            found = [
                difference
                for now, said in zip(printed, expected, strict=False)
                if said
                for difference in differences(now, said)
            ]
            assert not found, (page, block.text, found)


@pytest.mark.parametrize("page", PAGES)
def test_commands_stand_in_blocks(page: str) -> None:
    assert INDENTED not in (ROOT / page).read_text()
