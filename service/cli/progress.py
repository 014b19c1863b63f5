"""Progress of a job in the terminal."""

import sys
import time
from collections.abc import Callable

from service.jobs.records import Job

BAR_CELLS = 30
REDRAWN_AFTER_S = 0.2
LINE_EVERY_S = 10.0
"""Without a terminal: a line now and then, for logs [s]."""


class Progress:
    """A bar on stderr where that is a terminal, else a line now and then.

    That rows wait for what is compiled is said at once.

    Parameters
    ----------
    compiling
        Returns whether the rows wait for code that is compiled.
    """

    def __init__(self, compiling: Callable[[], bool]) -> None:
        self._compiling = compiling
        self._width = 0
        self._waits = False
        self._live = sys.stderr.isatty()
        self._every_s = REDRAWN_AFTER_S if self._live else LINE_EVERY_S
        self._shown = time.monotonic() if not self._live else 0.0

    def show(self, job: Job) -> None:
        """Tell how far a job is, if it is time to."""
        now = time.monotonic()
        before, self._waits = self._waits, self._waits_for_code(job)
        due = now - self._shown >= self._every_s or (self._live and job.ended)
        if not due and (before or not self._waits):
            return
        self._shown = now
        text = line_of(job)
        if self._waits:
            text += ", compiling, first use only"
        if self._live:
            filled = BAR_CELLS * job.done // max(job.rows, 1)  # a damaged one has none
            bar = "#" * filled + "." * (BAR_CELLS - filled)
            line = f"[{bar}] {text}"
            # Not every screen of Windows knows the code that clears the rest of a line.
            sys.stderr.write(f"\r{line:{self._width}}")
            self._width = len(line)
        else:
            sys.stderr.write(f"{text}\n")
        sys.stderr.flush()

    def _waits_for_code(self, job: Job) -> bool:
        return not job.done and not job.ended and self._compiling()

    def end(self) -> None:
        """Leave the line of the bar."""
        if self._live:
            sys.stderr.write("\n")
            sys.stderr.flush()


def line_of(job: Job) -> str:
    """Return how far a job is, in words."""
    left = "" if job.left_s is None else f", {_duration(job.left_s)} left"
    rate = f", {job.rate_rows_s:,.0f} rows/s" if job.rate_rows_s else ""
    return f"{job.done:,} of {job.rows:,} rows{rate}{left}"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}"
