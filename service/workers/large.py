"""Which large task comes to a place for such work, and which leaves its worker to another."""

from collections import Counter
from collections.abc import Iterable

from service.workers.queue import Ticket
from service.workers.runs import Run


def oldest_overdue(busy: Iterable[Run]) -> Run | None:
    """Return the task that has waited longest in its worker for a place for large work."""
    return min(_overdue(busy), key=_begun, default=None)


def youngest_overdue(busy: Iterable[Run]) -> Run | None:
    """Return the task that loses least where one of those must leave its worker."""
    return max(_overdue(busy), key=_begun, default=None)


def youngest_second(busy: Iterable[Run], waiting: Iterable[Ticket]) -> Run | None:
    """Return the youngest large task of a client that has several, as one waits who has none.

    None where nobody waits who has none.
    """
    large = [run for run in busy if run.large]
    holders = Counter(run.client for run in large)
    if all(ticket.flow.client in holders for ticket in waiting):
        return None
    return max((run for run in large if holders[run.client] > 1), key=_begun, default=None)


def _overdue(busy: Iterable[Run]) -> list[Run]:
    return [run for run in busy if run.overdue]


def _begun(run: Run) -> float:
    return run.begun
