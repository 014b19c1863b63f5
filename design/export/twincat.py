"""TwinCAT 3: the blocks of Structured Text as .TcPOU files, one each, in an archive.

A .TcPOU holds one block, its declaration and its statements as text [1]_. Both are those of the
Structured Text, letter by letter. TwinCAT knows a block by an id, which is made of its text here: a
block that has changed has another.

References
----------
.. [1] Beckhoff, TwinCAT 3 PLC, "Separate files: TcPOU".
"""

import io
import uuid
import zipfile
from collections.abc import Iterable, Iterator
from xml.sax.saxutils import quoteattr

from design.export.kind import Export
from design.export.move import MoveBlocks
from design.export.program import check_program
from design.export.text_blocks import (
    TextBlock,
    TextProgram,
    live_program,
    move_program,
    text_program,
)
from design.tables.rows import Rows, TableHead

UNDATED = (1980, 1, 1, 0, 0, 0)
"""Of files in an archive: the same table gives the same bytes."""

FORM = "1.1.0.1"
"""Version of the form of a .TcPOU file."""


def write_twincat(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as an archive of .TcPOU files.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Yields
    ------
    bytes
        The archive, whole; ``README.txt`` in it is the head of the Structured Text.

    Raises
    ------
    InvalidInputError
        If a number of the table is infinite.
    """
    yield _archive(text_program(head, runs))


def move_in_twincat(blocks: MoveBlocks) -> bytes:
    """Return a move as an archive of .TcPOU files.

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
    return _archive(move_program(blocks))


def _archive(program: TextProgram) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for block in program.blocks:
            _add(archive, f"{block.name}.TcPOU", _pou(block))
        _add(archive, "README.txt", f"{program.remark}\n")
    return file.getvalue()


def _add(archive: zipfile.ZipFile, name: str, text: str) -> None:
    archive.writestr(zipfile.ZipInfo(name, date_time=UNDATED), text.encode())


def _pou(block: TextBlock) -> str:
    declared = f"(* {block.remark} *)\nFUNCTION_BLOCK {block.name}\n{block.declared}"
    own = uuid.uuid5(uuid.NAMESPACE_OID, declared + block.body)
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n'
        f'<TcPlcObject Version="{FORM}">\n'
        f'  <POU Name={quoteattr(block.name)} Id="{{{own}}}" SpecialFunc="None">\n'
        f"    <Declaration><![CDATA[{declared}]]></Declaration>\n"
        "    <Implementation>\n"
        f"      <ST><![CDATA[{block.body}]]></ST>\n"
        "    </Implementation>\n"
        "  </POU>\n"
        "</TcPlcObject>\n"
    )


EXPORT = Export(
    name="twincat",
    media_type="application/zip",
    suffix=".zip",
    checks=check_program,
    write=write_twincat,
    move=move_in_twincat,
    live=lambda block: _archive(live_program(block)),
)
