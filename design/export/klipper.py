"""Klipper: a SET_INPUT_SHAPER line for each row.

Klipper takes no impulses, it takes the name of a shaper, a frequency and a damping ratio, and
computes the impulses itself [1]_ [2]_. So only its own six kinds can be handed over, designed for a
drive that follows its command; anything else is refused by name.

References
----------
.. [1] Klipper, docs/G-Codes.md, "SET_INPUT_SHAPER", and docs/Config_Reference.md,
   "[input_shaper]".
.. [2] Klipper, klippy/extras/shaper_defs.py: INPUT_SHAPERS, with the largest damping ratio of each.
"""

import math
from collections.abc import Iterable, Iterator

from design.actuators import Ideal
from design.errors import InvalidInputError
from design.export.firmware import (
    firmware_lines,
    positive_amplitudes,
    require_positive_shaper,
)
from design.export.kind import Export
from design.tables.description import described, mode_of, names_of
from design.tables.rows import Rows, TableHead

LARGEST_DAMPING_RATIOS = {
    "zv": 0.99,
    "mzv": 0.99,
    "zvd": 0.99,
    "ei": 0.4,
    "2hump_ei": 0.3,
    "3hump_ei": 0.2,
}
"""What Klipper calls its shapers, and up to which damping ratio it takes them (shaper_defs.py)."""


def check_klipper(head: TableHead) -> None:
    """Raise InvalidInputError unless Klipper would compute the same impulses itself."""
    description = described(head)
    if description.shaper not in LARGEST_DAMPING_RATIOS:
        raise InvalidInputError(
            "shaper.kind",
            description.shaper,
            f"one of Klipper's own, {', '.join(LARGEST_DAMPING_RATIOS)}: it takes no impulses",
        )
    require_positive_shaper(head, "Klipper")
    if not isinstance(description.actuator, Ideal):
        raise InvalidInputError(
            "actuator.kind",
            description.actuator.kind,
            "ideal for Klipper: its shapers know no drive",
        )


def write_klipper(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as lines for Klipper, both axes alike."""
    description = described(head)
    shaper, fields = description.shaper, names_of(head, "field")
    largest = LARGEST_DAMPING_RATIOS[shaper]

    def commands(rows: Rows, index: int) -> list[str]:
        positive_amplitudes(head, rows, index, "Klipper")
        row = slice(index, index + 1)
        frequencies, dampings = mode_of(description.plant, fields, rows.fields[row])
        frequency_hz, damping = float(frequencies[0]) / (2 * math.pi), float(dampings[0])
        if damping > largest:
            return [f"; Klipper takes {shaper} up to a damping ratio of {largest}"]
        return [
            f"SET_INPUT_SHAPER SHAPER_TYPE={shaper} SHAPER_FREQ_X={frequency_hz!r} "
            f"SHAPER_FREQ_Y={frequency_hz!r} DAMPING_RATIO_X={damping!r} "
            f"DAMPING_RATIO_Y={damping!r}"
        ]

    remarks = [
        "take the line of your row, frequencies in Hz; to keep it, write its parameters in lower",
        "case into the section [input_shaper] of printer.cfg, as shaper_type: ...",
    ]
    return firmware_lines(head, runs, remarks, commands)


KLIPPER = Export(
    name="klipper",
    media_type="text/plain; charset=utf-8",
    suffix=".gcode",
    checks=check_klipper,
    write=write_klipper,
)
