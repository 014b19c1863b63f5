"""Exported files read back to impulses, each by the rules of its reader."""

import io
import re
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from zipfile import BadZipFile, ZipFile

import numpy as np
from numpy.typing import ArrayLike
from xsdata.exceptions import ParserError

from design.export.reading import READERS, rows_of
from design.model.impulses import Impulses
from design.tables.columns import amplitudes_of, times_of
from design.tables.rows import WITH_DESIGN
from design.types import FloatArray
from tests.firmware import klipper_reads, lines_of, marlin_reads, reprap_35_reads, reprap_36_reads
from tests.plc_files import plcopen_text, scl_text, twincat_text
from tests.structured_text import Block

PLC_TEXTS = {"plcopen": plcopen_text, "twincat": twincat_text, "scl": scl_text}
"""What turns files for PLC editors into Structured Text."""

FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-O0"]

PRINTS = """
#include <stdio.h>
#include "table.h"
int main(void)
{{
    static shapersmith_real memory[4];
    static {name}_shaper shaper;
    int row = 0, k;
    {name}_start(&shaper, memory, 4, SHAPERSMITH_C(0.0));
    if ({name}_set(&shaper, {name}_times[row], {amplitudes}, SHAPERSMITH_C(1e9)) > 0) {{
        return (int){name}_step(&shaper, SHAPERSMITH_C(0.0));
    }}
    for (row = 0; row < {upper}_ROWS; ++row) {{
        printf("%d", {name}_status[row]);
        for (k = 0; k < {upper}_IMPULSES; ++k) {{
            printf(" %.17g", (double){name}_times[row][k]);
        }}
        for (k = 0; k < {upper}_IMPULSES; ++k) {{
            printf(" %.17g", (double){amplitudes}[k]);
        }}
        {columns}
        printf("\\n");
    }}
    return 0;
}}
"""


PRINTS_ON_SAMPLES = """
#include <stdio.h>
#include "table.h"
int main(void)
{{
    static shapersmith_real memory[{upper}_LINE];
    static {name}_shaper shaper;
    size_t row, k;
    for (row = 0; row < {upper}_ROWS; ++row) {{
        printf("%d", {name}_status[row]);
        for (k = 0; k < {upper}_IMPULSES; ++k) {{
            printf(" %.17g", (double){name}_samples[row][k] * (double){name}_sample_times[row]);
        }}
        for (k = 0; k < {upper}_IMPULSES; ++k) {{
            printf(" %.17g", (double){amplitudes}[k]);
        }}
        {columns}
        printf("\\n");
    }}
    for (row = 0; row < {upper}_ROWS; ++row) {{
        {name}_start(&shaper, memory, {upper}_LINE, SHAPERSMITH_C(0.0));
        printf("%d", {name}_set(&shaper, row, {name}_sample_times[row]));
        for (k = 0; k < {upper}_LINE; ++k) {{
            printf(" %.17g", (double){name}_step(&shaper, SHAPERSMITH_C(1.0)));
        }}
        printf("\\n");
    }}
    return 0;
}}
"""
"""Prints the rows of a table on samples, then what each makes of a step on each sample."""


class UnreadableError(Exception):
    """The reader refuses the file."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Held:
    """What a reader makes of one row.

    Attributes
    ----------
    impulses
        By every route that leads to them, as two firmwares of other ages.
    numbers
        What it holds besides: the columns, in programs except times and amplitudes.
    status
        As told; 0 in files that do not tell.
    """

    impulses: tuple[Impulses, ...]
    numbers: tuple[float, ...] = ()
    status: int = 0


def read_c(text: bytes, folder: Path) -> list[Held]:
    """Compile a header and have a program print it."""
    name = re.findall(rb"\} (\w+)_shaper;", text)[0].decode()
    (folder / "table.h").write_bytes(text)
    macros = re.findall(rf"#define ({name.upper()}_\w+) (\d+)", text.decode())
    names = [macro for macro, _ in macros]
    first = names.index(f"{name.upper()}_COLUMNS") + 1
    columns = names[first : first + int(macros[first - 1][1])]
    prints = [f'printf(" %.17g", (double){name}_table[row][{column}]);' for column in columns]
    on_samples = f" {name}_samples[".encode() in text
    program = PRINTS_ON_SAMPLES if on_samples else PRINTS
    of_rows = f" {name}_amplitudes[{name.upper()}_ROWS]".encode() in text
    (folder / "main.c").write_text(
        program.format(
            name=name,
            upper=name.upper(),
            columns="\n        ".join(prints),
            amplitudes=f"{name}_amplitudes{'[row]' if of_rows else ''}",
        )
    )
    made = subprocess.run(
        ["gcc", *FLAGS, "-o", str(folder / "main"), str(folder / "main.c")],
        capture_output=True,
        text=True,
        check=False,
    )
    if made.returncode:
        raise UnreadableError(made.stderr)
    told = subprocess.run([str(folder / "main")], capture_output=True, text=True, check=True)
    impulses = int(re.findall(rb"_IMPULSES (\d+)", text)[0])
    rows = []
    lines = told.stdout.splitlines()
    for line in lines[: len(lines) // 2] if on_samples else lines:
        status, *words = line.split()
        numbers = np.array([float(word) for word in words])
        times, amplitudes, told_columns = np.split(numbers, [impulses, 2 * impulses])
        rows.append(_row_held(times, amplitudes, told_columns, status))
    return rows


def _row_held(times: ArrayLike, amplitudes: ArrayLike, numbers: ArrayLike, status: Any) -> Held:
    code = int(status)
    found: tuple[Impulses, ...] = ()
    if code in WITH_DESIGN:
        given = trimmed(*(np.array(one, dtype=np.float64) for one in (times, amplitudes)))
        found = (Impulses(**dict(zip(("times_s", "amplitudes"), given, strict=True))),)
    listed = np.array(numbers, dtype=np.float64).tolist()
    return Held(impulses=found, numbers=tuple(listed), status=code)


def trimmed(times: FloatArray, amplitudes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return impulses without those of no height or number at the end, as on samples."""
    held = np.flatnonzero((amplitudes != 0) & ~np.isnan(amplitudes))[-1] + 1
    return times[:held], amplitudes[:held]


def read_st(text: bytes, folder: Path) -> list[Held]:  # noqa: ARG001
    """Run the block of the table, row by row."""
    program = text.decode()
    name = re.findall(r"FUNCTION_BLOCK (\w+)_table", program)[0]
    rows: list[Held] = []
    try:
        block = Block(program, f"{name}_table")
        while (told := block(row=len(rows)))["status"] != -1:
            amplitudes = told["amplitudes"].values
            columns = told["columns"].values if "columns" in told else []
            if "samples" in told:
                times = [told["sample_time_s"] * number for number in told["samples"].values]
            else:
                times = told["times_s"].values
            rows.append(_row_held(times, amplitudes, columns, told["status"]))
    except (SyntaxError, ValueError, IndexError, KeyError) as error:
        raise UnreadableError(str(error)) from None
    return rows


def read_arduino(text: bytes, folder: Path) -> list[Held]:
    """Compile the header in a library."""
    try:
        with ZipFile(io.BytesIO(text)) as archive:
            (path,) = (name for name in archive.namelist() if name.endswith(".h"))
            return read_c(archive.read(path), folder)
    except BadZipFile as error:
        raise UnreadableError(str(error)) from None


def read_plc(text: bytes, to_text: Callable[[bytes], str]) -> list[Held]:
    """Turn a file for an editor into Structured Text, and run the block of its table."""
    try:
        return read_st(to_text(text).encode(), Path())
    except (AssertionError, ParserError, ElementTree.ParseError, BadZipFile, TypeError) as error:
        raise UnreadableError(str(error)) from None


def read_klipper(text: bytes, folder: Path) -> list[Held]:  # noqa: ARG001
    """Read each pair of lines, of X and Y, as Klipper of 2026 does."""
    lines = lines_of(text.decode())
    pairs = list(zip(lines[::2], lines[1::2], strict=True))
    if any(other != re.sub(r"_X\b", "_Y", one) for one, other in pairs):
        raise UnreadableError("the axes of a row differ")
    return [Held(impulses=(klipper_reads(one), klipper_reads(other))) for one, other in pairs]


def read_marlin(text: bytes, folder: Path) -> list[Held]:  # noqa: ARG001
    """Read each pair of lines, of X and Y, as Marlin does, with the numbers F and D of both."""
    lines = lines_of(text.decode())
    return [
        Held(
            impulses=(marlin_reads(one), marlin_reads(other)),
            numbers=tuple(map(float, re.findall(r"[FD]([\d.]+)", f"{one} {other}"))),
        )
        for one, other in zip(lines[::2], lines[1::2], strict=True)
    ]


def read_rrf(text: bytes, folder: Path) -> list[Held]:  # noqa: ARG001
    """Read each line as either age of RepRapFirmware does."""
    older = re.findall(r"^; 3.4 to 3.5: (.*)$", text.decode(), re.MULTILINE)
    both = zip(lines_of(text.decode()), older, strict=True)
    return [Held(impulses=(reprap_36_reads(new), reprap_35_reads(old))) for new, old in both]


def read_data(name: str, text: bytes) -> list[Held]:
    """Read a file that holds a table whole."""
    head, runs = rows_of(name, io.BytesIO(text))
    rows = []
    for run in runs:
        times, amplitudes = times_of(head, run), amplitudes_of(head, run)
        numbers = np.hstack((run.fields, run.results))
        rows += [
            _row_held(times[index], amplitudes[index], numbers[index], status)
            for index, status in enumerate(run.status.tolist())
        ]
    return rows


def read_back(name: str, text: bytes, folder: Path) -> list[Held]:
    """Return what the reader of a format makes of each row that holds a design, or of all."""
    if name in READERS:
        return read_data(name, text)
    readers = {
        "c": read_c,
        "st": read_st,
        "klipper": read_klipper,
        "rrf": read_rrf,
        "marlin": read_marlin,
        "arduino": read_arduino,
    }
    if name in PLC_TEXTS:
        return read_plc(text, PLC_TEXTS[name])
    return readers[name](text, folder)
