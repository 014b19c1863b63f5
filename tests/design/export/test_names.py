"""Names in programs: legal whatever the title, and apart from those of other files."""

import re
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from design.export.c_header import EXPORT as C
from design.export.program import DEFAULT_TITLE, MAX_NAME_CHARACTERS, name_of
from design.export.structured_text import EXPORT as STRUCTURED_TEXT
from design.tables.rows import Rows, TableHead
from schemas.tables import TableRequest
from service.jobs.plan import plan_of
from service.jobs.results import head_for
from tests.design.export.test_c_header import FLAGS
from tests.designed_tables import CRANE, designed_table
from tests.structured_text import Block

TITLES = [
    "crane",
    "Crane, NUMZVD",
    "2nd axis",
    "007",
    "!!!",
    "-- */ (* *) --",
    "Größe der Katze",
    "Schaltzeiten für den 3. Kran",
    "起重机",
    "кран",
    "№5 crane",
    "_",
    "__x__",
    "a__b",
    "x" * 100,
    "a title that is far too long for a name",
    "İstanbul",
    *("if", "int", "end_if", "table", "struct", "while", "default", "double", "restrict"),
    *("END_VAR", "LREAL", "function_block", "array", "TO", "at", "r_edge", "var_input", "true"),
    *("shapersmith", "shapersmith real", "math", "NAN", "size_t", "stddef"),
    DEFAULT_TITLE,
]

RESERVED = re.compile(
    r"(?i)(if|int|end_if|table|struct|while|default|double|restrict|end_var|lreal|function_block|"
    r"array|to|at|r_edge|var_input|true|nan|size_t)\Z"
)

OTHER: dict[str, Any] = {**CRANE, "plant": {**CRANE["plant"], "cable_length_m": 1.3}}


@pytest.fixture(scope="module")
def table() -> tuple[TableHead, Rows]:
    return designed_table(CRANE, {"plant.cable_length_m": [0.8]})


@pytest.fixture(scope="module")
def other() -> tuple[TableHead, Rows]:
    return designed_table(OTHER, {"plant.cable_length_m": [1.3]})


def compile_headers(
    folder: Path, program: str, **headers: bytes
) -> "subprocess.CompletedProcess[str]":
    for name, header in headers.items():
        (folder / f"{name}.h").write_bytes(header)
    (folder / "main.c").write_text(program)
    return subprocess.run(
        ["gcc", *FLAGS, "-o", str(folder / "main"), str(folder / "main.c")],
        capture_output=True,
        text=True,
        check=False,
    )


def header_of(table: tuple[TableHead, Rows], **changed: Any) -> bytes:
    head, rows = table
    return b"".join(C.write(replace(head, **changed), [rows]))


@pytest.mark.parametrize("title", TITLES)
def test_any_title_gives_names_that_are_legal(
    table: tuple[TableHead, Rows], tmp_path: Path, title: str
) -> None:
    head, rows = replace(table[0], title=title), table[1]
    name = name_of(head)
    assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name), name
    assert len(name) <= MAX_NAME_CHARACTERS + len("table_")
    program = b"".join(STRUCTURED_TEXT.write(head, [rows])).decode()
    blocks = re.findall(r"^FUNCTION_BLOCK (\w+)$", program, re.MULTILINE)
    assert blocks == [f"{name}_table", f"{name}_shaper"]
    assert not any(RESERVED.match(block) for block in blocks)
    assert Block(program, f"{name}_table")(row=0)["status"] == 0
    made = compile_headers(
        tmp_path,
        f"""
        #include "one.h"
        int main(void) {{
            static shapersmith_real memory[1000];
            static {name}_shaper shaper;
            {name}_start(&shaper, memory, 1000, SHAPERSMITH_C(0.0));
            return {name}_set(&shaper, {name}_times[0], {name}_amplitudes, SHAPERSMITH_C(0.004))
                + (int){name}_step(&shaper, SHAPERSMITH_C(0.0)) + {name}_status[0]
                + ({name}_table[0][0] < SHAPERSMITH_C(0.0));
        }}""",
        one=b"".join(C.write(head, [rows])),
    )
    assert made.returncode == 0, made.stderr
    assert subprocess.run([tmp_path / "main"], check=False).returncode == 0


BOTH = """
#include "one.h"
#include "two.h"
#include "one.h"
int main(void) {{
    static shapersmith_real memory[1000];
    static {one}_shaper first;
    static {two}_shaper second;
    {one}_start(&first, memory, 500, SHAPERSMITH_C(0.0));
    {two}_start(&second, memory + 500, 500, SHAPERSMITH_C(0.0));
    return {one}_set(&first, {one}_times[0], {one}_amplitudes, SHAPERSMITH_C(0.004))
        + {two}_set(&second, {two}_times[0], {two}_amplitudes, SHAPERSMITH_C(0.004))
        + (int)({one}_step(&first, SHAPERSMITH_C(0.0)) + {two}_step(&second, SHAPERSMITH_C(0.0)))
        + {one}_status[0] + {two}_status[0]
        + !({one}_table[0][0] < {two}_table[0][0]);
}}
"""


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ({"title": DEFAULT_TITLE}, {"title": DEFAULT_TITLE}),
        ({"title": "起重机"}, {"title": "кран"}),
        ({"title": "a title far too long to be a name: 1"}, {"title": "a title far too long: 2"}),
        ({"title": DEFAULT_TITLE, "name": "crane"}, {"title": DEFAULT_TITLE, "name": "stage"}),
    ],
)
def test_two_tables_go_into_one_program(
    table: tuple[TableHead, Rows],
    other: tuple[TableHead, Rows],
    tmp_path: Path,
    first: dict[str, Any],
    second: dict[str, Any],
) -> None:
    names = [
        name_of(replace(head, **changed))
        for (head, _), changed in ((table, first), (other, second))
    ]
    assert names[0] != names[1]
    made = compile_headers(
        tmp_path,
        BOTH.format(one=names[0], two=names[1]),
        one=header_of(table, **first),
        two=header_of(other, **second),
    )
    assert made.returncode == 0, made.stderr
    assert subprocess.run([tmp_path / "main"], check=False).returncode == 0


def test_a_second_table_of_the_same_title_is_an_error_and_does_not_vanish(
    table: tuple[TableHead, Rows], other: tuple[TableHead, Rows], tmp_path: Path
) -> None:
    made = compile_headers(
        tmp_path,
        BOTH.format(one="crane", two="crane"),
        one=header_of(table, title="crane"),
        two=header_of(other, title="crane"),
    )
    assert made.returncode != 0
    assert "redefinition" in made.stderr


def test_names_come_from_the_file_where_no_title_was_given() -> None:
    request = {
        "design": CRANE,
        "axes": [{"field": "/plant/cable_length_m", "values": [0.8]}],
    }
    untitled = plan_of(TableRequest.model_validate(request)).job
    titled = plan_of(TableRequest.model_validate({**request, "title": "hoist"})).job
    path = Path("some/where/Crane 2.h")
    assert name_of(head_for(untitled, "c", path)) == "crane_2"
    assert name_of(head_for(titled, "c", path)) == "hoist"
    assert name_of(head_for(untitled, "c")) == f"shaper_table_{untitled.sha256[:7]}"
