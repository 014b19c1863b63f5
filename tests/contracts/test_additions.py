"""How many files know of one entry: an addition is one file and one row, or the debt is named here.

Each row names an entry, the text by which code would know of it, and the files that may hold that
text: its own, its row, and the debts. A debt that is paid is taken out; a new one fails the test.
"""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

PACKAGES = ("shapersmith", "design", "schemas", "service")

NAMED_IN = {
    "ps_zvd": {"design/shapers/partial_sums.py"},
    "num_si": {"design/shapers/numsi.py"},
    "mat": {
        "design/export/mat_file.py",
        "design/export/formats.py",
    },
    "st": {
        "design/export/structured_text.py",
        "design/export/formats.py",
    },
    "spring_mass": {
        "schemas/plants.py",
        "shapersmith/given.py",  # its name in Python, which type checkers must see written
    },
    "rate_limited": {
        "design/model/actuators/rate_limited.py",
        "schemas/actuators.py",
        "design/shapers/actuators.py",  # which actuators a positive shaper names first
        "shapersmith/given.py",  # its name in Python
    },
    "simulation": {
        "service/operations/table.py",
        "shapersmith/results.py",  # its answer in Python
    },
}
"""Files that hold the quoted name of an entry."""

IMPORTED_IN = {
    "design.shapers.partial_sums": {"design/shapers/registry.py"},
    "design.shapers.numsi": {"design/shapers/registry.py"},
    "design.export.mat_file": set(),
    "design.export.structured_text": {
        "design/export/text_blocks.py",  # files for PLC editors are made of its text
    },
    "service.operations.simulation": set(),
}
"""Files that import the module of an entry."""


def sources() -> dict[str, str]:
    """Return the code of each file, without the lines of examples in docstrings."""
    paths = sorted(path for name in PACKAGES for path in (ROOT / name).rglob("*.py"))
    return {
        path.relative_to(ROOT).as_posix(): re.sub(r"(?m)^ *(>>>|\.\.\.).*$", "", path.read_text())
        for path in paths
    }


SOURCES = sources()


@pytest.mark.parametrize("name", NAMED_IN)
def test_no_more_files_than_listed_know_an_entry_by_its_name(name: str) -> None:
    found = {path for path, text in SOURCES.items() if re.search(rf"[\"']{name}[\"']", text)}
    assert found, "the entry is gone: take another one of its sort"
    assert not found - NAMED_IN[name]


@pytest.mark.parametrize("module", IMPORTED_IN)
def test_no_more_files_than_listed_import_an_entry(module: str) -> None:
    assert f"{module.replace('.', '/')}.py" in SOURCES, "the module is gone: take another one"
    found = {path for path, text in SOURCES.items() if f"from {module} import" in text}
    assert not found - IMPORTED_IN[module]
