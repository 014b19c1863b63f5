"""RepRapFirmware: an M593 P"custom" line for each row, for positive shapers.

``H`` and ``T`` changed their meaning with version 3.6 [1]_ [2]_:

- from 3.6 on, ``H`` is the individual amplitude of each impulse but the last, which gets what is
  left of 1, and ``T`` the delay of each impulse but the first, in seconds, strictly increasing;
- from 3.4 to 3.5, ``H`` is the cumulative amplitude of each impulse but the last, and ``T`` the
  duration of each of those.

Both lines are written, the older one in a comment. Firmware of either age holds four numbers of
each, hence five impulses.

References
----------
.. [1] Duet3D, G-code dictionary, "M593: Configure Input Shaping", sections "RepRapFirmware 3.6 and
   later" and "RepRapFirmware 3.3 to 3.5".
.. [2] Duet3D/RepRapFirmware, src/Movement/AxisShaper.cpp, AxisShaper::Configure, case custom;
   AxisShaper.h, MaxImpulses = 5 (before: MaxExtraImpulses = 4).
"""

from collections.abc import Iterable, Iterator
from itertools import accumulate, pairwise

from design.errors import InvalidInputError
from design.export.firmware import (
    firmware_lines,
    positive_amplitudes,
    require_positive_shaper,
)
from design.export.kind import Export
from design.tables.description import require_times, times_of
from design.tables.rows import Rows, TableHead

MOST_IMPULSES = 5
"""``MaxImpulses`` of AxisShaper.h."""

DECIMALS = 9
"""The firmware reads single precision: seven digits of a time of 10 ms."""

SHORTEST_GAP_S = 2e-6
"""Delays must strictly increase, as counts of a step clock of 750 kHz or faster [s]."""


def check_reprap(head: TableHead) -> None:
    """Raise InvalidInputError unless RepRapFirmware takes the impulses."""
    require_positive_shaper(head, "RepRapFirmware")
    if not 1 < head.impulses <= MOST_IMPULSES:
        raise InvalidInputError(
            "impulses", head.impulses, f"2 to {MOST_IMPULSES} for RepRapFirmware"
        )
    require_times(head)


def write_reprap(head: TableHead, runs: Iterable[Rows]) -> Iterator[bytes]:
    """Write a table as lines for RepRapFirmware."""

    def commands(rows: Rows, index: int) -> list[str]:
        amplitudes = positive_amplitudes(head, rows, index, "RepRapFirmware")
        times = times_of(head, rows)[index].tolist()
        delays = [time - times[0] for time in times[1:]]
        gaps = [after - before for before, after in pairwise(times)]
        if min(gaps) < SHORTEST_GAP_S:
            raise InvalidInputError(
                f"times_s of row {rows.first + index}",
                times,
                f"{SHORTEST_GAP_S:g} s or more apart for RepRapFirmware",
            )
        newer = _command(amplitudes[:-1], delays)
        older = _command(list(accumulate(amplitudes[:-1])), gaps)
        return [newer, f"; 3.4 to 3.5: {older}"]

    remarks = [
        'take the line of your row; M593 P"custom" as of RepRapFirmware 3.6, below it in a comment',
        "the line for 3.4 to 3.5, which reads the same letters in another way",
    ]
    return firmware_lines(head, runs, remarks, commands)


def _command(amplitudes: list[float], times_s: list[float]) -> str:
    heights, times = (":".join(f"{x:.{DECIMALS}f}" for x in xs) for xs in (amplitudes, times_s))
    return f'M593 P"custom" H{heights} T{times}'


REPRAP = Export(
    name="rrf",
    media_type="text/plain; charset=utf-8",
    suffix=".g",
    checks=check_reprap,
    write=write_reprap,
)
