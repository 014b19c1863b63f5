"""Every format of table. One more: write its file, then list it here."""

from design.export.csv_file import CSV
from design.export.kind import Export
from design.export.parquet_file import PARQUET

EXPORTS: dict[str, Export] = {export.name: export for export in (CSV, PARQUET)}
