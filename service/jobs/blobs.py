"""Runs of rows as bytes: an Arrow IPC stream each, compressed."""

import json

import numpy as np

from design.tables.rows import Rows


def to_blob(rows: Rows) -> bytes:
    """Return a run of rows as bytes; the same rows always give the same bytes."""
    import pyarrow as pa  # noqa: PLC0415 - a fifth of a second

    arrays = [pa.array(column) for column in (*rows.fields.T, *rows.results.T)]
    arrays.append(pa.array(rows.status))
    schema = pa.schema(
        [pa.field(str(number), array.type) for number, array in enumerate(arrays)],
        metadata={
            "first": str(rows.first),
            "fields": str(rows.fields.shape[1]),
            "reasons": json.dumps(rows.reasons, sort_keys=True),
        },
    )
    sink = pa.BufferOutputStream()
    options = pa.ipc.IpcWriteOptions(compression="zstd")
    with pa.ipc.new_stream(sink, schema, options=options) as writer:
        writer.write_batch(pa.record_batch(arrays, schema=schema))
    return bytes(sink.getvalue().to_pybytes())


def from_blob(blob: bytes) -> Rows:
    """Return the run of rows that `to_blob` wrote."""
    import pyarrow as pa  # noqa: PLC0415

    with pa.ipc.open_stream(blob) as reader:
        metadata = reader.schema.metadata
        columns = [column.to_numpy() for column in reader.read_all().columns]
    count = int(metadata[b"fields"])
    size = columns[-1].size
    numbers = columns[:-1]
    return Rows(
        first=int(metadata[b"first"]),
        fields=_stack(numbers[:count], size),
        results=_stack(numbers[count:], size),
        status=columns[-1].astype(np.int8),
        reasons={int(row): text for row, text in json.loads(metadata[b"reasons"]).items()},
    )


def _stack(columns: list[np.ndarray], size: int) -> np.ndarray:
    return np.stack(columns, axis=1) if columns else np.empty((size, 0))
