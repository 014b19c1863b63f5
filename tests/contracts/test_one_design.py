"""One NUMZVD request passes twelve stations, each once, in the order of the product's sentence."""

import re
import sys
from pathlib import Path
from types import FrameType

import pytest

from tests.conftest import CRANE
from tests.service.http.in_process import InProcess

ROOT = Path(__file__).parents[2]

MOST_LINES = 4_000
"""Lines of all files that a design enters: what a reader meets on its way."""

STATIONS = [
    ("service/http/routes.py", "_answering.<locals>.answering"),
    ("service/workers/inline.py", "InlinePool.run"),
    ("service/dispatch.py", "respond"),
    ("service/operations/design.py", "design_shaper"),
    ("design/pipeline.py", "check"),
    ("design/shapers/numzvd.py", "numzvd"),
    ("design/solving/solve.py", "solve"),
    ("design/solvers/search.py", "candidates"),
    ("design/solvers/ipopt.py", "solve"),
    ("design/analysis/judge.py", "judge"),
    ("design/pipeline.py", "describe"),
    ("schemas/designs.py", "DesignResponse.from_design"),
]


class Entries:
    """Functions of the project in the order in which they are entered.

    A generator or coroutine that goes on is the same frame, and not entered again.
    """

    def __init__(self) -> None:
        self.entered: list[tuple[str, str]] = []
        self._frames: dict[int, FrameType] = {}

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        """Take an event of the profiler."""
        path = frame.f_code.co_filename
        if event != "call" or not path.startswith(str(ROOT)):
            return
        if self._frames.get(id(frame)) is frame:
            return
        self._frames[id(frame)] = frame  # kept, so that no other frame gets its id
        name = Path(path).relative_to(ROOT).as_posix()
        self.entered.append((name, frame.f_code.co_qualname))


@pytest.fixture(scope="module")
def entered() -> list[tuple[str, str]]:
    """Return what the second request of a design enters; the first builds the solver."""
    service = InProcess()
    assert service.ask("POST", "/v1/designs", CRANE).status_code == 200
    entries = Entries()
    sys.setprofile(entries)
    try:
        answer = service.ask("POST", "/v1/designs", CRANE)
    finally:
        sys.setprofile(None)
    assert answer.status_code == 200
    return entries.entered


def test_a_design_passes_each_station_once_and_in_order(entered: list[tuple[str, str]]) -> None:
    assert [entry for entry in entered if entry in STATIONS] == STATIONS


def test_a_design_enters_few_lines(entered: list[tuple[str, str]]) -> None:
    names = {name for name, _ in entered if not name.startswith(("tests/", ".venv/"))}
    lines = {name: len((ROOT / name).read_text().splitlines()) for name in names}
    by_size = sorted(lines.items(), key=lambda row: -row[1])
    assert sum(lines.values()) <= MOST_LINES, "\n".join(f"{n:5} {name}" for name, n in by_size)


def test_the_document_names_the_stations_of_the_trace() -> None:
    text = (ROOT / "docs" / "one-design.md").read_text()
    rows = re.findall(r"^\| \d+ \|.*?\| (.*?) \|.*?\|$", text, flags=re.MULTILINE)
    assert len(rows) == len(STATIONS) <= 12
    for row, (path, name) in zip(rows, STATIONS, strict=True):
        function = name if name[0].isupper() and "from_design" in name else name.split(".")[-1]
        assert f"`{function}`" in row, row
        assert path in row or "service/workers/" in row, row
