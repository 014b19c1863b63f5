"""CSV, JSON, Parquet and .mat: what is written reads back, bit for bit, by us and by others."""

import csv
import io
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.errors import InvalidInputError
from design.export.formats import FORMATS
from design.export.mat_file import MAX_MATRIX_BYTES, check_mat
from design.export.reading import READERS, rows_of
from design.export.registry import EXPORTS
from design.tables.rows import STATUSES
from tests.designed_tables import CRANE, designed_table, head_of, join, made_up_table, same
from tests.refusals import refused

ROWS, RUN_ROWS = 2_500, 1_000


def write(name: str, rows: int = ROWS) -> bytes:
    return b"".join(EXPORTS[name].write(*made_up_table(rows, RUN_ROWS)))


@pytest.mark.parametrize("name", READERS)
def test_what_is_written_reads_back_bit_for_bit(name: str) -> None:
    head, runs = made_up_table(ROWS, RUN_ROWS)
    got_head, got_runs = rows_of(name, io.BytesIO(write(name)))
    assert got_head == head
    assert same(join(got_runs), join(runs))


@pytest.mark.parametrize("name", READERS)
def test_a_table_without_rows_is_a_file_too(name: str) -> None:
    head, runs = rows_of(name, io.BytesIO(write(name, 0)))
    assert head.rows == 0
    assert sum(run.status.size for run in runs) == 0


@pytest.mark.parametrize("name", READERS)
def test_the_bytes_are_the_same_in_another_process_at_another_time(name: str) -> None:
    code = (
        "import sys; from tests.design.export.test_data_files import write;"
        f"sys.stdout.buffer.write(write({name!r}))"
    )
    other = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert other.stdout == write(name)


@pytest.mark.parametrize("name", READERS)
def test_every_file_names_tool_specification_and_units(name: str) -> None:
    head, _ = made_up_table(ROWS, RUN_ROWS)
    data = write(name)
    assert b"shapersmith 0.1.0" in data
    assert head.specification_sha256.encode() in data
    assert b'["t1_s", "s", "result"]' in data


@pytest.mark.parametrize("name", READERS)
def test_something_else_is_refused_by_name(name: str) -> None:
    for data in (b"", b"\xff\xfe nothing of the kind", b'{"rows": []}\n', b"a,b\n1,2\n"):
        with pytest.raises(InvalidInputError, match="file"):
            rows_of(name, io.BytesIO(data))


def test_a_table_that_ends_early_is_refused() -> None:
    for name, end in (("csv", ""), ("json", "]}")):
        lines = write(name).decode().splitlines(keepends=True)[:2_000]
        _, runs = rows_of(name, io.BytesIO("".join([*lines, end]).encode()))
        with refused("rows_unlike_head", "file", says="of 2500 rows"):
            list(runs)


def test_a_mat_file_cut_anywhere_is_refused() -> None:
    data = write("mat")
    for length in (200, 5_000, 150_000, len(data) - 9):
        with refused("mat_file_damaged", "file"):
            rows_of("mat", io.BytesIO(data[:length]))


def test_a_format_that_only_goes_out_is_not_read() -> None:
    with refused("format_not_readable", "format"):
        rows_of("st", io.BytesIO())


def test_a_bad_line_of_csv_is_named_by_its_number() -> None:
    lines = write("csv").decode().splitlines(keepends=True)
    lines[40] = lines[40].replace(",", ",x", 1)
    _, runs = rows_of("csv", io.BytesIO("".join(lines).encode()))
    with refused("unreadable_csv_row", "line 41", says="8 numbers"):
        list(runs)
    lines[40] = "1.0,2.0\n"
    _, runs = rows_of("csv", io.BytesIO("".join(lines).encode()))
    with refused("unreadable_csv_row", "line 41"):
        list(runs)


def test_a_bad_line_of_json_is_named_by_its_number() -> None:
    lines = write("json").decode().splitlines(keepends=True)
    lines[40] = lines[40].replace("[", "[[", 1)
    _, runs = rows_of("json", io.BytesIO("".join(lines).encode()))
    with refused("unreadable_json_row", "line 41"):
        list(runs)


def test_csv_reads_by_the_standard_library_once_comments_are_skipped() -> None:
    lines = [line for line in write("csv").decode().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    expected = join(made_up_table(ROWS, RUN_ROWS)[1])
    times = [float(row["t2_s"] or "nan") for row in rows]
    assert np.array_equal(times, expected.results[:, 1], equal_nan=True)
    assert {index: row["reason"] for index, row in enumerate(rows) if row["reason"]} == (
        expected.reasons
    )


def test_json_is_one_document() -> None:
    document = json.loads(write("json"))
    expected = join(made_up_table(ROWS, RUN_ROWS)[1])
    assert document["specification"]["design"]["shaper"] == {"kind": "numzvd"}
    assert len(document["rows"]) == document["row_count"] == ROWS
    first = document["rows"][0]
    assert first[2:8] == expected.results[0].tolist()
    assert first[8:] == ["verified", None]


def test_parquet_keeps_units_a_group_for_each_run_and_status_as_dictionary() -> None:
    import pyarrow.parquet

    file = pyarrow.parquet.ParquetFile(io.BytesIO(write("parquet")))
    assert [file.metadata.row_group(group).num_rows for group in range(3)] == [1000, 1000, 500]
    schema = file.schema_arrow
    assert schema.field("t1_s").metadata[b"unit"] == b"s"
    assert str(schema.field("status").type).startswith("dictionary<values=string")
    expected = join(made_up_table(ROWS, RUN_ROWS)[1])
    statuses = [STATUSES[code] for code in expected.status.tolist()]
    assert file.read().column("status").to_pylist() == statuses
    assert file.read().column("t1_s").null_count == statuses.count("infeasible") + statuses.count(
        "failed"
    )


def test_mat_holds_matrices_and_names_for_matlab() -> None:
    from scipy.io import loadmat

    data = write("mat")
    assert data.startswith(b"MATLAB 5.0 MAT-file, shapersmith 0.1.0 ")
    table = loadmat(io.BytesIO(data), simplify_cells=True)["table"]
    expected = join(made_up_table(ROWS, RUN_ROWS)[1])
    assert np.array_equal(table["times_s"], expected.results[:, :5], equal_nan=True)
    assert np.array_equal(table["residual"], expected.results[:, 5], equal_nan=True)
    assert table["amplitudes"].tolist() == [1.0, -1.0, 1.0, -1.0, 1.0]
    assert np.array_equal(table["fields"]["cable_length_m"], expected.fields[:, 0])
    assert table["units"] == {
        "cable_length_m": "m",
        "damping_ratio": "1",
        "times_s": "s",
        "residual": "1",
    }
    assert (table["row_count"], table["impulses"]) == (ROWS, 5)
    assert np.array_equal(table["reason_rows"] - 1, list(expected.reasons))


def test_the_axes_of_a_grid_stand_in_a_mat_file() -> None:
    from scipy.io import loadmat

    axes = {"plant.cable_length_m": [1.4, 0.3, 0.8], "plant.damping_ratio": [0.0, 0.05]}
    head, rows = designed_table(CRANE, axes)
    data = b"".join(EXPORTS["mat"].write(head, [rows]))
    table = loadmat(io.BytesIO(data), simplify_cells=True)["table"]
    assert table["axes"]["cable_length_m"].tolist() == [1.4, 0.3, 0.8]
    assert table["axes"]["damping_ratio"].tolist() == [0.0, 0.05]


def test_the_example_for_matlab_uses_what_is_in_the_file() -> None:
    from scipy.io import loadmat

    page = (Path(__file__).parents[3] / "docs/tables.md").read_text()
    (program,) = re.findall(r"(?s)```matlab\n(.*?)```", page)
    head, rows = designed_table(CRANE, {"plant.cable_length_m": [0.3, 0.8, 1.4]})
    data = b"".join(EXPORTS["mat"].write(head, [rows]))
    table = loadmat(io.BytesIO(data), simplify_cells=True)["table"]
    used = re.findall(r"\bshapers((?:\.[a-z_]+)+)", program)
    assert used
    for path in used:
        held = table
        for name in path.split(".")[1:]:
            held = held[name]


def test_mat_refuses_what_its_sizes_cannot_count() -> None:
    most = MAX_MATRIX_BYTES // (8 * (2 + 6 + 2))
    amplitudes = (1.0, -1.0, 1.0, -1.0, 1.0)
    check_mat(head_of(CRANE, ("plant.cable_length_m",), most, amplitudes))
    with refused("too_many_rows_for_mat", "rows", says="at most 26843545 for a"):
        check_mat(head_of(CRANE, ("plant.cable_length_m",), most + 1, amplitudes))


PEAK = """
import resource
from design.export.registry import EXPORTS
from tests.designed_tables import made_up_table
size = sum(map(len, EXPORTS["parquet"].write(*made_up_table({rows}, 10_000))))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, size)
"""


def test_parquet_needs_no_more_memory_for_ten_times_the_rows() -> None:
    peaks = []
    for rows in (100_000, 1_000_000):
        code = PEAK.format(rows=rows)
        out = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout
        peak, size = map(int, out.split())
        assert size > 40 * rows  # the rows are really there
        peaks.append(peak)
    # The rows take 76 MB more; a tenth of the whole process is noise of the allocator.
    assert peaks[1] < 1.1 * peaks[0], peaks


@pytest.mark.parametrize("name", ["csv", "json"])
def test_a_specification_that_was_changed_in_the_file_is_refused(name: str) -> None:
    text = write(name, 3).decode().replace('"cable_length_m":0.8', '"cable_length_m":0.9')
    with refused("wrong_hash", "specification_sha256"):
        rows_of(name, io.BytesIO(text.encode()))


def test_every_format_is_named_as_its_row() -> None:
    assert [export.name for export in EXPORTS.values()] == list(FORMATS) == list(EXPORTS)


def read(name: str, data: bytes) -> None:
    """Read a whole file."""
    _, runs = rows_of(name, io.BytesIO(data))
    list(runs)


def test_a_csv_file_that_is_none_of_ours_has_a_code_for_what_is_wrong() -> None:
    lines = write("csv", 20).decode().splitlines(keepends=True)
    heading = next(number for number, line in enumerate(lines) if not line.startswith("#"))
    with refused("unsound_head", "file"):
        read("csv", "".join(lines[1:]).encode())
    with refused("wrong_heading", "file"):
        read("csv", "".join([*lines[:heading], f"x{lines[heading]}"]).encode())
    with refused("unreadable_cells"):
        read("csv", "".join([*lines[: heading + 1], '"1.0\n']).encode())


def test_a_parquet_file_that_is_none_of_ours_has_a_code_for_what_is_wrong() -> None:
    import pyarrow as pa
    from pyarrow import parquet

    def read_changed(table: Any) -> None:
        changed = io.BytesIO()
        parquet.write_table(table, changed)
        read("parquet", changed.getvalue())

    whole = parquet.read_table(io.BytesIO(write("parquet", 20)))
    odd = pa.array(["odd"] * whole.num_rows).dictionary_encode()
    with refused("not_parquet_file", "file"):
        read("parquet", b"nothing of the kind")
    with refused("columns_unlike_head", "file"):
        read_changed(whole.drop_columns(["reason"]))
    with refused("unknown_status", "status"):
        read_changed(whole.set_column(whole.column_names.index("status"), "status", odd))


def test_a_mat_file_that_is_none_of_ours_has_a_code_for_what_is_wrong() -> None:
    from scipy.io import loadmat, savemat

    data = write("mat", 20)
    table = loadmat(io.BytesIO(data))["table"]

    def changed(**others: Any) -> bytes:
        names = table.dtype.names
        kept = {name: table[0, 0][name] for name in names if others.get(name, 1) is not None}
        part = io.BytesIO()
        numbers = {name: value for name, value in others.items() if value is not None}
        savemat(part, {"table": {**kept, **numbers}}, long_field_names=True)
        return data[:116] + part.getvalue()[116:]  # under our text in front

    with refused("not_mat_file", "file"):
        read("mat", b"nothing of the kind")
    with refused("table_incomplete", "file", says="without reasons"):
        read("mat", changed(reasons=None))
    with refused("counts_unlike_head", "file"):
        read("mat", changed(impulses=6.0))
    with refused("unsound_head", "file"):
        read("mat", changed(head=None))
    part = io.BytesIO()
    savemat(part, {"other": 1.0})
    with refused("table_incomplete", "file", says="without table"):
        read("mat", data[:116] + part.getvalue()[116:])
