"""What a format says of itself: its entry in the registry."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import BinaryIO

from design.export.live_blocks.block import LiveBlock
from design.export.move import MoveBlocks
from design.tables.rows import Rows, TableHead


@dataclass(frozen=True, slots=True, kw_only=True)
class Export:
    """One format of table.

    Attributes
    ----------
    name
        Its ``format`` on the wire.
    media_type
        Of its bytes.
    suffix
        Of its files, with the dot.
    checks
        Raises InvalidInputError where the format cannot take the table, before any row is known.
    write
        From the head and the runs of rows, in order, to the file's bytes in pieces. The same rows
        in the same runs always give the same bytes.
    read
        From an opened file to the head and the runs of rows; None of formats that do not hold a
        table whole.
    move
        From a whole move to the file's bytes; None of formats that play none.
    live
        From a machine to the file's bytes: a block that shapes live commands; None of formats that
        hold none.
    """

    name: str
    media_type: str
    suffix: str
    checks: Callable[[TableHead], None]
    write: Callable[[TableHead, Iterable[Rows]], Iterator[bytes]]
    read: Callable[[BinaryIO], tuple[TableHead, Iterator[Rows]]] | None = None
    move: Callable[[MoveBlocks], bytes] | None = None
    live: Callable[[LiveBlock], bytes] | None = None


def takes_all(head: TableHead) -> None:
    """Check nothing: the format takes any table."""
