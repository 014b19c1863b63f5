"""The function blocks of a program in Structured Text, in parts that other files put together."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from design.export.live_blocks.block import LiveBlock
from design.export.live_blocks.text import live_in_text
from design.export.move import MoveBlocks
from design.export.move_text import move_in_text
from design.export.structured_text import write_st
from design.tables.rows import Rows, TableHead

BLOCK = re.compile(
    r"^\(\* (?P<remark>(?:(?!\*\)).)*) \*\)\nFUNCTION_BLOCK (?P<name>\w+)\n"
    r"(?P<declared>(?:VAR.*?^END_VAR\n)+)(?P<body>.*?)^END_FUNCTION_BLOCK$",
    re.DOTALL | re.MULTILINE,
)
SECTION = re.compile(
    r"^(?P<kind>VAR\w*)(?P<constant> CONSTANT)?\n(?P<lines>.*?)^END_VAR$", re.DOTALL | re.MULTILINE
)
VARIABLE = re.compile(
    r"^    (?P<name>\w+) : (?:ARRAY\[(?P<first>\w+)\.\.(?P<last>\w+)\] OF )?(?P<of>\w+)"
    r"(?: := (?:\[(?P<values>[^\]]*)\]|(?P<value>[^;\[]+)))?;$",
    re.MULTILINE,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class TextVariable:
    """A variable of a block."""

    name: str
    of: str  # Its type, or that of its elements; a block's name of an instance
    bounds: tuple[str, str] | None  # First and last index of an array, numbers or constants
    values: tuple[str, ...]  # At first: one, those of an array, or none


@dataclass(frozen=True, slots=True, kw_only=True)
class TextSection:
    """Variables that are declared together."""

    kind: str  # VAR, VAR_INPUT or VAR_OUTPUT
    constant: bool
    variables: tuple[TextVariable, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class TextBlock:
    """A function block."""

    name: str
    remark: str  # The comment above it
    declared: str  # Text of its variables
    body: str  # Text of its statements
    sections: tuple[TextSection, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class TextProgram:
    """A program: what its head says, and its blocks."""

    remark: str
    blocks: tuple[TextBlock, ...]


def text_program(head: TableHead, runs: Iterable[Rows]) -> TextProgram:
    """Return the Structured Text of a table in parts.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Returns
    -------
    TextProgram
        With the comments of its head, the example of a call among them.

    Raises
    ------
    InvalidInputError
        As of `design.export.structured_text.write_st`.
    """
    return parts_of(b"".join(write_st(head, runs)).decode())


def move_program(blocks: MoveBlocks) -> TextProgram:
    """Return the Structured Text of a move in parts.

    Parameters
    ----------
    blocks
        The move.

    Returns
    -------
    TextProgram
        With the comments of its head, the example of a call among them.

    Raises
    ------
    InvalidInputError
        As of `design.export.move_text.move_in_text`.
    """
    return parts_of(move_in_text(blocks))


def live_program(block: LiveBlock) -> TextProgram:
    """Return the Structured Text of live shaping in parts.

    Parameters
    ----------
    block
        The machine.

    Returns
    -------
    TextProgram
        With the comments of its head, the example of a call among them.

    Raises
    ------
    InvalidInputError
        As of `design.export.live_blocks.text.live_in_text`.
    """
    return parts_of(live_in_text(block))


def parts_of(text: str) -> TextProgram:
    """Return Structured Text in parts: the comments of its head, its blocks."""
    found = list(BLOCK.finditer(text))
    top = text[: found[0].start()]
    return TextProgram(
        remark=re.sub(r"^\(\* | ?\*\)$", "", top.strip(), flags=re.MULTILINE),
        blocks=tuple(
            TextBlock(
                name=match["name"],
                remark=match["remark"],
                declared=match["declared"],
                body=match["body"],
                sections=sections_of(match["declared"]),
            )
            for match in found
        ),
    )


def sections_of(declared: str) -> tuple[TextSection, ...]:
    """Return the sections of the variables of a block or a program."""
    return tuple(_section(one) for one in SECTION.finditer(declared))


def _section(match: re.Match[str]) -> TextSection:
    return TextSection(
        kind=match["kind"],
        constant=match["constant"] is not None,
        variables=tuple(_variable(one) for one in VARIABLE.finditer(match["lines"])),
    )


def _variable(match: re.Match[str]) -> TextVariable:
    values: tuple[str, ...] = ()
    if match["values"] is not None:
        values = tuple(value.strip() for value in match["values"].split(","))
    elif match["value"] is not None:
        values = (match["value"],)
    return TextVariable(
        name=match["name"],
        of=match["of"],
        bounds=None if match["first"] is None else (match["first"], match["last"]),
        values=values,
    )
