"""Every format of table: a row names its module, which this table does not import.

One more: write its file with an ``EXPORT``, then add its row here. The command line reads this
table before it prints its help.
"""

from typing import NamedTuple


class Format(NamedTuple):
    """One format; no dataclass, which takes as long to import as the rest of the help.

    Attributes
    ----------
    module
        The module in `design.export` that writes it.
    is_program
        Whether it is a program or a line of firmware, which a single design has too.
    plays_moves
        Whether it is a program that plays a whole move, and one that shapes live commands.
    has_real
        Whether its numbers are of a type that is asked for, LREAL or REAL.
    """

    module: str
    is_program: bool = False
    plays_moves: bool = False
    has_real: bool = False


FORMATS: dict[str, Format] = {
    "csv": Format("csv_file"),
    "json": Format("json_file"),
    "parquet": Format("parquet_file"),
    "mat": Format("mat_file"),
    "c": Format("c_header", is_program=True, plays_moves=True),
    "st": Format("structured_text", is_program=True, plays_moves=True, has_real=True),
    "plcopen": Format("plcopen_xml", is_program=True, plays_moves=True, has_real=True),
    "twincat": Format("twincat", is_program=True, plays_moves=True, has_real=True),
    "scl": Format("scl", is_program=True, plays_moves=True, has_real=True),
    "klipper": Format("klipper", is_program=True),
    "rrf": Format("reprap", is_program=True),
    "marlin": Format("marlin", is_program=True),
    "arduino": Format("arduino", is_program=True),
}
"""Formats by their name on the wire."""

LOG_FORMAT = "mat"
"""Format of the log of a run, beside JSON and CSV; `log_mat` writes it."""
