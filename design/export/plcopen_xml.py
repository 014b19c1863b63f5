"""PLCopen XML: the blocks of Structured Text as CODESYS and others import them.

References
----------
.. [1] PLCopen TC6, "XML formats for IEC 61131-3", version 2.01, tc6_xml_v201.xsd.
"""

import re
from collections.abc import Iterable, Iterator
from xml.sax.saxutils import escape, quoteattr

from design.export.header import TOOL
from design.export.kind import Export
from design.export.move import MoveBlocks
from design.export.program import check_program, name_of
from design.export.text_blocks import (
    TextBlock,
    TextProgram,
    TextSection,
    TextVariable,
    live_program,
    move_program,
    text_program,
)
from design.tables.rows import Rows, TableHead

NAMESPACE = "http://www.plcopen.org/xml/tc6_0201"
XHTML = "http://www.w3.org/1999/xhtml"

SECTIONS = {"VAR_INPUT": "inputVars", "VAR_OUTPUT": "outputVars", "VAR": "localVars"}
"""Names of sections in Structured Text and here."""

ELEMENTARY = ("BOOL", "SINT", "DINT", "REAL", "LREAL")
"""Types that are elements here; others are names of blocks."""

UNDATED = "1970-01-01T00:00:00"
"""The schema demands a date, and the same table gives the same bytes."""

NOT_IN_XML = re.compile("[\ufffe\uffff]")
"""What a title may have and XML 1.0 may not."""

SCALING = '<scaling x="1" y="1"/>'
"""Of diagrams, of which there are none."""


def write_plcopen(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as a project of PLCopen XML.

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
    yield _project(text_program(head, runs), name_of(head), head.version).encode()


def move_in_plcopen(blocks: MoveBlocks) -> bytes:
    """Return a move as a project of PLCopen XML.

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
    return _project(move_program(blocks), blocks.name, blocks.version).encode()


def _project(program: TextProgram, name: str, version: str) -> str:
    coordinates = "".join(f"<{name}>{SCALING}</{name}>" for name in ("fbd", "ld", "sfc"))
    return "".join([
        '<?xml version="1.0" encoding="utf-8"?>\n'
        f'<project xmlns="{NAMESPACE}">\n'
        f'<fileHeader companyName="" productName="{TOOL}" productVersion={quoteattr(version)} '
        f'creationDateTime="{UNDATED}"/>\n'
        f"<contentHeader name={quoteattr(name)}>\n"
        f"<Comment>{escape(NOT_IN_XML.sub('?', program.remark))}</Comment>\n"
        f"<coordinateInfo>{coordinates}</coordinateInfo>\n"
        "</contentHeader>\n<types>\n<dataTypes/>\n<pous>\n",
        *map(_pou, program.blocks),
        "</pous>\n</types>\n<instances>\n<configurations/>\n</instances>\n</project>\n",
    ])


def _pou(block: TextBlock) -> str:
    sections = "".join(map(_section, block.sections))
    return (
        f'<pou name="{block.name}" pouType="functionBlock">\n'
        f"<interface>\n{sections}</interface>\n"
        f"<body>\n<ST>{_xhtml(block.body)}</ST>\n</body>\n"
        f"<documentation>{_xhtml(block.remark)}</documentation>\n"
        "</pou>\n"
    )


def _xhtml(text: str) -> str:
    return f'<xhtml xmlns="{XHTML}">{escape(text)}</xhtml>'


def _section(section: TextSection) -> str:
    name = SECTIONS[section.kind]
    constant = ' constant="true"' if section.constant else ""
    return f"<{name}{constant}>\n{''.join(map(_variable, section.variables))}</{name}>\n"


def _variable(variable: TextVariable) -> str:
    of = f"<{variable.of}/>" if variable.of in ELEMENTARY else f'<derived name="{variable.of}"/>'
    values = [f'<simpleValue value="{value}"/>' for value in variable.values]
    if variable.bounds is not None:
        first, last = variable.bounds
        of = f'<array><dimension lower="{first}" upper="{last}"/><baseType>{of}</baseType></array>'
        held = "".join(f"<value>{value}</value>\n" for value in values)
        values = [f"<arrayValue>\n{held}</arrayValue>"] if values else []
    initial = f"<initialValue>{values[0]}</initialValue>" if values else ""
    return f'<variable name="{variable.name}"><type>{of}</type>{initial}</variable>\n'


EXPORT = Export(
    name="plcopen",
    media_type="application/xml",
    suffix=".xml",
    checks=check_program,
    write=write_plcopen,
    move=move_in_plcopen,
    live=lambda block: _project(live_program(block), block.name, block.version).encode(),
)
