"""Every format of table, loaded."""

from importlib import import_module

from design.export.formats import FORMATS
from design.export.kind import Export

EXPORTS: dict[str, Export] = {
    name: import_module(f"design.export.{row.module}").EXPORT for name, row in FORMATS.items()
}
"""Exports by their name on the wire."""
