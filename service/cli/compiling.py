"""Whether a table waits for code that is compiled at its first use on a machine."""

import time
from functools import cached_property

from design.tables.specification import TableSpecification
from service.compiled_code import holds_nothing
from service.jobs.records import NewJob

ASKED_AFTER_S = 0.4
"""Where code is on disk, nobody asks sooner: that imports numba, whose time workers need [s]."""

LOOKS_EVERY_S = 0.1
"""Between two looks at what is on disk [s]."""


class Compiling:
    """Answers whether the workers of a table compile, for as long as they may.

    Parameters
    ----------
    job
        The table.
    """

    def __init__(self, job: NewJob) -> None:
        self._job = job
        self._began_s = time.monotonic()
        self._looks_s = self._began_s
        self._answer = False

    def __call__(self) -> bool:
        """Return whether they compile, as it was at the last look."""
        now = time.monotonic()
        if now >= self._looks_s:
            self._answer = self._look(now - self._began_s)
            self._looks_s = now + LOOKS_EVERY_S
        return self._answer

    def _look(self, since_s: float) -> bool:
        if not self._rows_are_compiled:
            return False
        if holds_nothing():
            return True
        if since_s < ASKED_AFTER_S:
            return False
        from design.tables.needed_code import code_is_kept  # noqa: PLC0415 - it imports numba

        return not code_is_kept(self._specification)

    @cached_property
    def _specification(self) -> TableSpecification:
        from service.jobs.plan import specification_of  # noqa: PLC0415 - most tables are quick

        return specification_of(self._job.specification, self._job.impulses)

    @cached_property
    def _rows_are_compiled(self) -> bool:
        """Whether the rows are computed by compiled code."""
        from design.tables.compute import compiled_rows_of  # noqa: PLC0415

        specification = self._specification
        return specification.grid is None and compiled_rows_of(specification) is not None
