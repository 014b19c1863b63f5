"""Whether a table waits for code that is compiled at its first use on a machine."""

import time

from service.jobs.records import NewJob

ASKED_AFTER_S = 0.8
"""Before, nobody wonders: to ask imports numba, whose time the workers need [s]."""


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
        self._rows_are_compiled: bool | None = None

    def __call__(self) -> bool:
        """Return whether they compile now."""
        if time.monotonic() - self._began_s < ASKED_AFTER_S:
            return False
        if self._rows_are_compiled is None:
            self._rows_are_compiled = are_compiled(self._job)
        return self._rows_are_compiled and not is_compiled()


def are_compiled(job: NewJob) -> bool:
    """Return whether the rows of a table are computed by compiled code."""
    from design.tables.compute import compiled_rows_of  # noqa: PLC0415 - most tables are quick
    from service.jobs.plan import specification_of  # noqa: PLC0415

    specification = specification_of(job.specification, job.impulses)
    return specification.grid is None and compiled_rows_of(specification) is not None


def is_compiled() -> bool:
    """Return whether that code is on disk by now: its last function is."""
    from design.tables.compiled import is_kept  # noqa: PLC0415 - numba takes half a second
    from design.tables.proofs import prove_rows  # noqa: PLC0415

    return is_kept(prove_rows)
