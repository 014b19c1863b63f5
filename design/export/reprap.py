"""RepRapFirmware: an M593 P"custom" line for each row, for positive shapers.

``H`` has the amplitudes of all impulses but the last, ``T`` a time for each of those [1]_. What the
numbers are changed between versions [2]_:

- from 3.6 on, ``H`` is each impulse's own amplitude and ``T`` the delay of the impulses after the
  first, counted from the first;
- from 3.4 to 3.5, ``H`` is the share of the acceleration in force after each impulse, a running
  sum, and ``T`` how long it is in force, from impulse to impulse.

Both lines are written, the older one in a comment. A firmware of either age takes four numbers
each, hence five impulses.

References
----------
.. [1] Duet3D, G-code dictionary, "M593: Configure Input Shaping".
.. [2] Duet3D/RepRapFirmware, src/Movement/AxisShaper.cpp, AxisShaper::Configure, case custom, of
   the branches 3.4, 3.5 and 3.6; AxisShaper.h, MaxExtraImpulses.
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
"""One more than ``MaxExtraImpulses``, AxisShaper.h."""

DECIMALS = 9
"""The firmware reads single precision: seven digits of a time of 10 ms."""


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
