"""A file held against the rows that its specification gives now."""

from dataclasses import replace
from pathlib import Path

from design.export.registry import EXPORTS
from schemas.tables import Tolerances
from service.cli.checks import drifts_of_file
from tests.designed_tables import CRANE, designed_table
from tests.refusals import refused


def test_a_file_with_other_columns_than_its_specification_gives_is_refused(tmp_path: Path) -> None:
    head, rows = designed_table(CRANE, {"plant.cable_length_m": [0.7, 0.8]})
    path = tmp_path / "table.csv"
    path.write_bytes(b"".join(EXPORTS["csv"].write(head, [rows])))
    assert drifts_of_file(path, "csv", head, [rows], Tolerances()).count == 0
    renamed = tuple(
        replace(column, name="left") if column.name == "residual" else column
        for column in head.columns
    )
    with refused("other_columns", "file"):
        drifts_of_file(path, "csv", replace(head, columns=renamed), [rows], Tolerances())
