"""Which large task comes to a place for such work, and which gives its worker to another."""

from collections import Counter
from collections.abc import Iterable

from service.workers.queue import Ticket
from service.workers.runs import Run


def oldest_overdue(busy: Iterable[Run]) -> Run | None:
    """Return the task that waits longest for a place for large work.

    It waits in its worker; None where no task does.
    """
    return min(_overdue(busy), key=_begin_of, default=None)


def youngest_overdue(busy: Iterable[Run]) -> Run | None:
    """Return the task that loses least by leaving its worker.

    It is the latest begun of those that wait in their workers for a place for large work; None
    where no task does.
    """
    return max(_overdue(busy), key=_begin_of, default=None)


def youngest_second(busy: Iterable[Run], waiting: Iterable[Ticket]) -> Run | None:
    """Return the youngest large task of a client that has several.

    Parameters
    ----------
    busy
        The tasks in workers.
    waiting
        The tickets that wait for a place for large work.

    Returns
    -------
    Run or None
        None where nobody waits who has no large task, or no client has several.
    """
    large = [run for run in busy if run.large]
    holders = Counter(run.client for run in large)
    if all(ticket.flow.client in holders for ticket in waiting):
        return None
    return max((run for run in large if holders[run.client] > 1), key=_begin_of, default=None)


def _overdue(busy: Iterable[Run]) -> list[Run]:
    return [run for run in busy if run.overdue]


def _begin_of(run: Run) -> float:
    return run.begun
