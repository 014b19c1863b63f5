"""Write what commands print now into the pages that are named: ``python -m tests.pages PAGE…``."""

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tests.pages.following import differences, follower
from tests.pages.reading import OMITTED, PROMPT, ROOT, Block, blocks


def renewed(page: str, folder: Path) -> str:
    """Return a page with what its commands print now; lines around `...` stay as they are."""
    text = (ROOT / page).read_text()
    places = []
    with follower(page, folder) as reader:
        for block in blocks(page):
            places.append((block, "".join(_renewed(block, reader.follow(block)))))
    for block, now in reversed(places):
        text = text[: block.place.start] + now + text[block.place.stop :]
    return text


def _renewed(block: Block, printed: list[list[str]]) -> Iterator[str]:
    if not printed:
        yield block.text
    elif not block.commands:
        yield from (f"{line}\n" for line in printed[0])
    for command, lines in zip(block.commands, printed, strict=False):
        yield f"{PROMPT}{command.typed}\n"
        kept = OMITTED in command.prints or not differences(lines, command.prints)
        shown = command.prints if kept or not command.prints else lines
        yield from (f"{line}\n" for line in shown)


for name in sys.argv[1:]:
    with tempfile.TemporaryDirectory() as empty:
        (ROOT / name).write_text(renewed(name, Path(empty)))
