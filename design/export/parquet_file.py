"""Apache Parquet: a row group for each run, written as it comes, so that memory stays flat.

The head and the units are in the metadata of schema and columns; the status is a dictionary.
"""

import io
from collections.abc import Iterable, Iterator
from typing import Any, BinaryIO

import numpy as np

from design.errors import InvalidInputError
from design.export.header import facts, head_of
from design.export.kind import Export, takes_all
from design.tables.columns import names_of
from design.tables.rows import STATUSES, Rows, TableHead


class _Pieces(io.RawIOBase):
    """A file that only hands on what is written to it."""

    def __init__(self) -> None:
        self.held: list[bytes] = []
        self.position = 0

    def writable(self) -> bool:
        return True

    def tell(self) -> int:
        return self.position

    def write(self, piece: Any) -> int:  # noqa: ANN401
        self.held.append(bytes(piece))
        self.position += len(self.held[-1])
        return len(self.held[-1])

    def take(self) -> bytes:
        """Return what was written since the last call."""
        joined = b"".join(self.held)
        self.held.clear()
        return joined


def _schema(head: TableHead) -> Any:  # noqa: ANN401
    import pyarrow as pa  # noqa: PLC0415

    types = {"status": pa.dictionary(pa.int8(), pa.string()), "reason": pa.string()}
    columns = [
        pa.field(
            column.name,
            types.get(column.kind, pa.float64()),
            metadata={"unit": column.unit, "kind": column.kind},
        )
        for column in head.columns
    ]
    return pa.schema(columns, metadata=facts(head))


def write_parquet(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as Parquet, a row group and a piece for each run.

    Parameters
    ----------
    head, runs
        The table, its runs in order.

    Yields
    ------
    bytes
        A piece for each run, the last with the end of the file.
    """
    import pyarrow as pa  # noqa: PLC0415
    from pyarrow import parquet  # noqa: PLC0415

    schema = _schema(head)
    statuses = pa.array(STATUSES)
    sink = _Pieces()
    # Results seldom repeat: a dictionary would only be built to be thrown away.
    repeating = [column.name for column in head.columns if column.kind != "result"]
    with parquet.ParquetWriter(
        sink, schema, compression="zstd", compression_level=1, use_dictionary=repeating
    ) as writer:
        for rows in runs:
            if not rows.status.size:
                continue
            arrays = [pa.array(column) for column in rows.fields.T]
            arrays += [pa.array(column, from_pandas=True) for column in rows.results.T]
            arrays.append(pa.DictionaryArray.from_arrays(rows.status.astype(np.int8), statuses))
            arrays.append(_reasons(rows))
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
            yield sink.take()
    yield sink.take()


def _reasons(rows: Rows) -> Any:  # noqa: ANN401
    import pyarrow as pa  # noqa: PLC0415

    if not rows.reasons:
        return pa.nulls(rows.status.size, pa.string())
    return pa.array([rows.reasons.get(index) for index in range(rows.status.size)], pa.string())


def read_parquet(file: BinaryIO) -> tuple[TableHead, Iterator[Rows]]:
    """Read back what `write_parquet` wrote, a row group at a time.

    Returns
    -------
    TableHead
        Without a subject.
    iterator of Rows
        Read as they are asked for.

    Raises
    ------
    InvalidInputError
        If it is no such file.
    """
    import pyarrow as pa  # noqa: PLC0415
    from pyarrow import parquet  # noqa: PLC0415

    try:
        opened = parquet.ParquetFile(file)
    except pa.ArrowException as error:
        raise InvalidInputError(
            "file", str(error), "a Parquet file", code="not_parquet_file"
        ) from None
    metadata = opened.schema_arrow.metadata or {}
    wanted = {
        name.decode(): text.decode()
        for name, text in metadata.items()
        if not name.startswith(b"ARROW:")
    }
    head = head_of(wanted)
    if opened.schema_arrow.names != [column.name for column in head.columns]:
        raise InvalidInputError(
            "file",
            opened.schema_arrow.names,
            "the columns that its head names",
            code="columns_unlike_head",
        )
    return head, _runs(head, opened)


def _runs(head: TableHead, opened: Any) -> Iterator[Rows]:  # noqa: ANN401
    first = 0
    fields, results = names_of(head, "field"), names_of(head, "result")
    for group in range(opened.num_row_groups):
        table = opened.read_row_group(group)

        def numbers(names: list[str], table: Any = table) -> Any:  # noqa: ANN401
            columns = [table.column(name).to_numpy() for name in names]
            return np.column_stack(columns) if names else np.empty((table.num_rows, 0))

        statuses = table.column("status").combine_chunks()
        codes = np.array([_code(name) for name in statuses.dictionary.to_pylist()], dtype=np.int8)
        given = table.column("reason")
        reasons = given.to_pylist() if given.null_count < table.num_rows else []
        yield Rows(
            first=first,
            fields=numbers(fields),
            results=numbers(results),
            status=codes[statuses.indices.to_numpy()],
            reasons={index: text for index, text in enumerate(reasons) if text is not None},
        )
        first += table.num_rows


def _code(name: str) -> int:
    if name not in STATUSES:
        raise InvalidInputError(
            "status", name, f"one of {', '.join(STATUSES)}", code="unknown_status"
        )
    return STATUSES.index(name)


EXPORT = Export(
    name="parquet",
    media_type="application/vnd.apache.parquet",
    suffix=".parquet",
    checks=takes_all,
    write=write_parquet,
    read=read_parquet,
)
