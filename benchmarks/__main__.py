"""Measure all and print the report; exit 1 if a limit is not met."""

import sys

from benchmarks import command_line, designs, http, tables

if __name__ == "__main__":
    missed = 0
    print("| what | measured | limit | |\n|---|---|---|---|")
    for part in (designs, command_line, http, tables):
        for figure in part.figures():
            met = {True: "met", False: "MISSED", None: ""}[figure.met]
            print(f"| {figure.what} | {figure.value} | {figure.limit} | {met} |", flush=True)
            missed += figure.met is False
    sys.exit(1 if missed else 0)
