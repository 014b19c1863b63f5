"""Every format of table. One more: write its file, then list it here."""

from design.export.c_header import C
from design.export.csv_file import CSV
from design.export.json_file import JSON
from design.export.kind import Export
from design.export.klipper import KLIPPER
from design.export.mat_file import MAT
from design.export.parquet_file import PARQUET
from design.export.reprap import REPRAP
from design.export.structured_text import STRUCTURED_TEXT

EXPORTS: dict[str, Export] = {
    export.name: export for export in (CSV, JSON, PARQUET, MAT, C, STRUCTURED_TEXT, KLIPPER, REPRAP)
}
