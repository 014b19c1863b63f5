"""Files for PLC editors hold the blocks of the Structured Text, declaration and statements."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.export.kind import Export
from design.export.plcopen_xml import EXPORT as PLCOPEN
from design.export.scl import EXPORT as SCL
from design.export.structured_text import EXPORT as STRUCTURED_TEXT
from design.export.text_blocks import TextBlock, text_program
from design.export.twincat import EXPORT as TWINCAT
from design.model.actuators.first_order import FirstOrder
from design.model.plants.pendulum import Pendulum
from service.cli.checks import file_named_in
from tests.design.export.test_lookup import TABLES, by_text, random_values, table, written
from tests.designed_tables import CRANE, designed_table
from tests.played_moves import case
from tests.played_tables import computed, random_request
from tests.plc_files import plcopen_again, plcopen_project, plcopen_text, scl_text, twincat_text
from tests.structured_text import Block, tokens_of

READ: dict[str, tuple[Export, Callable[[bytes], str]]] = {
    "plcopen": (PLCOPEN, plcopen_text),
    "twincat": (TWINCAT, twincat_text),
    "scl": (SCL, scl_text),
}
"""Each format and its reader."""


def read_back(form: str, which: str, **changed: Any) -> str:
    export, reader = READ[form]
    head, rows = table(which)
    return reader(b"".join(export.write(replace(head, **changed), [rows])))


def blocks_of(text: str) -> dict[str, str]:
    """Return the text of each block, without what stands above it."""
    found = re.finditer(r"(?ms)^FUNCTION_BLOCK (\w+)$.*?^END_FUNCTION_BLOCK$", text)
    return {match[1]: match[0] for match in found}


def statements_of(block: str) -> list[str]:
    return tokens_of(block[block.rindex("END_VAR") :])


@pytest.mark.parametrize("real", ["LREAL", "REAL"])
@pytest.mark.parametrize("which", TABLES)
@pytest.mark.parametrize("name", READ)
def test_the_statements_are_those_of_the_structured_text(name: str, which: str, real: str) -> None:
    wanted = blocks_of(written(STRUCTURED_TEXT, table(which), real=real))
    found = blocks_of(read_back(name, which, real=real))
    assert found.keys() == wanted.keys()
    for block, text in wanted.items():
        assert statements_of(found[block]) == statements_of(text)
        one, other = (
            Block(found[block] + text_of_tables(wanted), block),
            Block("\n".join(wanted.values()), block),
        )
        # All variables, their types, limits and values at first.
        assert one.values.keys() == other.values.keys()
        for variable, value in other.values.items():
            if not isinstance(value, Block):
                assert one.values[variable] == value, variable


def text_of_tables(blocks: dict[str, str]) -> str:
    return "".join(f"\n{text}" for name, text in blocks.items() if name.endswith("_table"))


@pytest.mark.parametrize("name", ["plcopen", "twincat"])
def test_the_declarations_are_those_of_the_structured_text(name: str) -> None:
    wanted = blocks_of(written(STRUCTURED_TEXT, table("length")))
    found = blocks_of(read_back(name, "length"))
    for block, text in wanted.items():
        if name == "twincat":
            assert found[block] == text
        assert sorted(sections_of(found[block])) == sorted(sections_of(text))


def sections_of(block: str) -> list[str]:
    return re.findall(r"(?ms)^VAR\w*(?: CONSTANT)?$.*?^END_VAR$", block)


@pytest.mark.parametrize("name", READ)
def test_what_is_read_back_finds_the_same_times(name: str) -> None:
    values = random_values("two", 20)
    wanted = by_text(written(STRUCTURED_TEXT, table("two")), values, "two")
    np.testing.assert_array_equal(by_text(read_back(name, "two"), values, "two"), wanted)


@pytest.mark.parametrize("name", READ)
def test_tables_on_samples_are_read_back_too(name: str) -> None:
    sampled = computed(random_request(0))
    export, reader = READ[name]
    text = reader(b"".join(export.write(sampled.head, [sampled.rows])))
    wanted = b"".join(STRUCTURED_TEXT.write(sampled.head, [sampled.rows])).decode()
    (block,) = [one for one in blocks_of(wanted) if one.endswith("_table")]
    held = Block(text, block)(row=1)
    assert held["samples"].values == Block(wanted, block)(row=1)["samples"].values


def test_plcopen_xml_goes_round() -> None:
    head, rows = table("length")
    text = b"".join(PLCOPEN.write(head, [rows]))
    project = plcopen_project(text)
    again = plcopen_project(plcopen_again(project))
    assert again == project
    assert plcopen_text(plcopen_again(project)) == plcopen_text(text)


def test_the_same_table_gives_the_same_bytes() -> None:
    head, rows = table("length")
    for export, _ in READ.values():
        assert list(export.write(head, [rows])) == list(export.write(head, [rows]))


@pytest.mark.parametrize(
    "title", ['a <b> & "c" ]]>', "*) FUNCTION_BLOCK x", "(* [1] := 'x' *)", "\ufffe"]
)
@pytest.mark.parametrize("name", READ)
def test_no_title_breaks_a_file(name: str, title: str) -> None:
    found = blocks_of(read_back(name, "length", title=title, name="crane"))
    assert set(found) == {"crane_table", "crane_lookup", "crane_shaper"}


def test_the_parts_are_the_whole_text() -> None:
    head, rows = designed_table(CRANE, {"plant.cable_length_m": [0.5, 0.8]})
    text = b"".join(STRUCTURED_TEXT.write(head, [rows])).decode()
    program = text_program(head, [rows])
    for block in program.blocks:
        assert whole(block) in text
    assert sum(len(whole(block)) for block in program.blocks) > 0.7 * len(text)


def whole(block: TextBlock) -> str:
    return (
        f"(* {block.remark} *)\nFUNCTION_BLOCK {block.name}\n{block.declared}{block.body}"
        "END_FUNCTION_BLOCK"
    )


@pytest.mark.parametrize("name", ["plcopen", "scl"])
def test_a_file_says_by_which_name_it_was_written(name: str, tmp_path: Path) -> None:
    head, rows = table("length")
    path = tmp_path / "renamed"
    path.write_bytes(b"".join(READ[name][0].write(replace(head, title="hoist"), [rows])))
    assert file_named_in(path).name == "hoist"


@pytest.mark.parametrize("which", ["length", "a move"])
def test_a_source_of_scl_has_the_calls_of_the_structured_text(which: str) -> None:
    if which == "length":
        text, source = written(STRUCTURED_TEXT, table(which)), written(SCL, table(which))
    else:
        drive = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.15)
        made = case(Pendulum(cable_length_m=9.0), drive, "numzv", speed_m_s=1.0, distance_m=12.0)
        text, source = made.written("st").decode(), made.written("scl").decode()
    programs = re.findall(r"(?ms)^PROGRAM (\w+)$(.*?)^END_PROGRAM", text)
    assert len(programs) == (1 if which == "length" else 2)
    head = source.partition("*)")[0]
    assert "from a block that a cyclic interrupt calls every" in head
    found = blocks_of(scl_text(head.rstrip().encode()))
    assert list(found) == [name for name, _ in programs]
    for name, wanted in programs:
        assert statements_of(found[name])[:-1] == statements_of(wanted)
        assert [tokens_of(one) for one in sections_of(found[name])] == [
            tokens_of(one) for one in sections_of(wanted)
        ]
