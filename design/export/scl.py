"""SCL of S7-1200 and S7-1500: the blocks of Structured Text as an external source of TIA Portal.

The statements are those of the Structured Text. What differs is listed in docs/plc.md:

- names of blocks stand in quotes, those of their variables have a # [1]_;
- BEGIN stands between declarations and statements, VERSION above them;
- a constant is a single value [1]_, so that arrays of numbers are variables with values at first;
- limits of arrays are numbers.

References
----------
.. [1] Siemens, STEP 7 and WinCC Engineering, "Programming PLC: SCL", tags and constants of a block.
"""

import re
from collections.abc import Iterable, Iterator

from design.export.kind import Export
from design.export.move import MoveBlocks
from design.export.program import check_program
from design.export.structured_numbers import lines
from design.export.text_blocks import (
    TextBlock,
    TextProgram,
    TextVariable,
    live_program,
    move_program,
    sections_of,
    text_program,
)
from design.tables.rows import Rows, TableHead

EXAMPLE = re.compile(
    r"^PROGRAM (?P<name>\w+)\n(?P<declared>(?:VAR.*?^END_VAR\n)+)(?P<body>.*?)^END_PROGRAM$",
    re.DOTALL | re.MULTILINE,
)
"""A call in the head of Structured Text."""

IN_A_TASK, IN_AN_INTERRUPT = "from a task of", "from a block that a cyclic interrupt calls every"
"""Where the blocks are called."""

CALL_DEPTHS = range(4, 28, 4)
"""Blanks ahead of what a call gives on further lines."""

ELEMENTARY = ("BOOL", "SINT", "DINT", "REAL", "LREAL")
"""Types that are not blocks, whose names stand in quotes."""


def write_scl(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as a source of SCL.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Yields
    ------
    bytes
        Pieces of the file.

    Raises
    ------
    InvalidInputError
        If a number of the table is infinite.
    """
    yield _source(text_program(head, runs)).encode()


def move_in_scl(blocks: MoveBlocks) -> bytes:
    """Return a move as a source of SCL.

    Parameters
    ----------
    blocks
        The move.

    Returns
    -------
    bytes
        The file, whole.

    Raises
    ------
    InvalidInputError
        If a number of the move is not finite in its type.
    """
    return _source(move_program(blocks)).encode()


def _source(program: TextProgram) -> str:
    top = EXAMPLE.sub(_example, program.remark).replace(IN_A_TASK, IN_AN_INTERRUPT)
    return f"(* {top} *)\n\n{''.join(map(_block, program.blocks))}"


def _example(found: re.Match[str]) -> str:
    """Return a program that calls the blocks as a block, which is what a cyclic interrupt calls."""
    block = TextBlock(
        name=found["name"],
        remark="",
        declared=found["declared"],
        body=found["body"],
        sections=sections_of(found["declared"]),
    )
    return _bare(block).rstrip("\n")


def _block(block: TextBlock) -> str:
    return f"(* {block.remark} *)\n{_bare(block)}"


def _bare(block: TextBlock) -> str:
    """Return a block without the comment above it."""
    constants = {
        variable.name: variable.values[0]
        for section in block.sections
        for variable in section.variables
        if section.constant and variable.bounds is None
    }
    declared: dict[str, list[str]] = {"VAR_INPUT": [], "VAR_OUTPUT": [], "VAR": []}
    single: list[str] = []
    names: list[str] = []
    for section in block.sections:
        for variable in section.variables:
            names.append(variable.name)
            text = _variable(variable, constants)
            is_single = section.constant and variable.bounds is None
            (single if is_single else declared[section.kind]).append(text)
    sections = {**declared, "VAR CONSTANT": single}
    # A block's own variables; what a call gives has the name of the other block's variable.
    given = "|".join(rf"(?<=,\n{' ' * deep})" for deep in CALL_DEPTHS)
    own = re.compile(
        rf"\(\*.*?\*\)|(?<![.\w])(?!(?:(?<=\()|(?<=, )|{given})\w+ :=)(?:{'|'.join(names)})\b",
        re.DOTALL,
    )
    body = own.sub(lambda found: found[0] if found[0][0] == "(" else f"#{found[0]}", block.body)
    return (
        f'FUNCTION_BLOCK "{block.name}"\n'
        "{ S7_Optimized_Access := 'TRUE' }\n"
        "VERSION : 0.1\n"
        + "".join(f"{kind}\n{''.join(texts)}END_VAR\n" for kind, texts in sections.items() if texts)
        + f"BEGIN\n{body}END_FUNCTION_BLOCK\n\n"
    )


def _variable(variable: TextVariable, constants: dict[str, str]) -> str:
    of = variable.of if variable.of in ELEMENTARY else f'"{variable.of}"'
    if variable.bounds is None:
        initial = f" := {variable.values[0]}" if variable.values else ""
        return f"    {variable.name} : {of}{initial};\n"
    first, last = (constants.get(bound, bound) for bound in variable.bounds)
    initial = f" := [\n{lines(list(variable.values))}]" if variable.values else ""
    return f"    {variable.name} : ARRAY[{first}..{last}] OF {of}{initial};\n"


EXPORT = Export(
    name="scl",
    media_type="text/plain; charset=utf-8",
    suffix=".scl",
    checks=check_program,
    write=write_scl,
    move=move_in_scl,
    live=lambda block: _source(live_program(block)).encode(),
)
