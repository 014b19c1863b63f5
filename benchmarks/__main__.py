"""Measure all, or the parts that are named, and print the report; exit 1 if a limit is missed.

``--page`` writes the report and its picture into the documentation as well.
"""

import importlib
import sys

from benchmarks.measure import Figure
from benchmarks.page import write_page

PARTS = (
    "designs",
    "shapers",
    "bands",
    "limits",
    "samples",
    "rig",
    "live",
    "tables",
    "command_line",
    "http",
    "table_jobs",
)

if __name__ == "__main__":
    named = [word for word in sys.argv[1:] if word != "--page"]
    if named and "--page" in sys.argv:
        sys.exit("the page has all parts: leave out their names with --page")
    found: list[Figure] = []
    print("| what | measured | limit | |\n|---|---|---|---|")
    for part in named or PARTS:
        if part not in PARTS:
            sys.exit(f"there is no part {part!r}: {', '.join(PARTS)}")
        for figure in importlib.import_module(f"benchmarks.{part}").figures():
            print(figure.row, flush=True)
            found.append(figure)
    if "--page" in sys.argv:
        write_page(found)
    sys.exit(1 if any(figure.met is False for figure in found) else 0)
