"""Measure all, or the parts that are named, and print the report; exit 1 if a limit is missed."""

import importlib
import sys

PARTS = (
    "designs",
    "shapers",
    "bands",
    "limits",
    "samples",
    "tables",
    "command_line",
    "http",
    "table_jobs",
)

if __name__ == "__main__":
    missed = 0
    print("| what | measured | limit | |\n|---|---|---|---|")
    for part in sys.argv[1:] or PARTS:
        if part not in PARTS:
            sys.exit(f"there is no part {part!r}: {', '.join(PARTS)}")
        for figure in importlib.import_module(f"benchmarks.{part}").figures():
            met = {True: "met", False: "MISSED", None: ""}[figure.met]
            print(f"| {figure.what} | {figure.value} | {figure.limit} | {met} |", flush=True)
            missed += figure.met is False
    sys.exit(1 if missed else 0)
