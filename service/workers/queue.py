"""Who is next: fair between clients and between small and large work, in order within each.

Start-time fair queueing (Goyal, Vin and Cheng 1996): each flow has a virtual time that advances by
the work it is given over its weight; served next is what starts earliest in virtual time. A flow
that was idle starts at the present virtual time, so that nobody saves up and nobody is starved.
"""

import heapq
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

Kind = Literal["single", "batch", "background"]

WEIGHTS: dict[Kind, float] = {"single": 4.0, "batch": 1.0, "background": 1.0}
"""Shares of those that wait: a batch and what nobody looks at yield to single requests."""


@dataclass(frozen=True, slots=True)
class Flow:
    """Work that is served in order: of one client, of one kind, small or large."""

    client: str = ""
    kind: Kind = "single"
    large: bool = False


@dataclass(eq=False, slots=True)
class Ticket:
    """A place in a queue.

    Attributes
    ----------
    flow
        Whose work it is.
    cost_s
        What it is expected to take [s].
    start
        Its start in virtual time.
    waiting
        Whether it is still in a queue.
    """

    flow: Flow
    cost_s: float
    start: float = 0.0
    waiting: bool = False


class FairQueue:
    """Tickets that wait, served by virtual time; those of one flow first come, first served."""

    def __init__(self) -> None:
        self._heap: list[tuple[float, int, Ticket]] = []
        self._numbers = itertools.count()
        self._now = 0.0
        self._finish: dict[Flow, float] = {}
        self._last: dict[Flow, float] = {}
        self._held: dict[Flow, float] = {}
        self._count: dict[Flow, int] = {}
        self._held_in_all = 0.0
        self._count_in_all = 0
        self._weights = 0.0

    def __len__(self) -> int:
        return self._count_in_all

    def __iter__(self) -> Iterator[Ticket]:
        """Yield the tickets in the order in which they are served if nothing comes between."""
        return (ticket for _, _, ticket in sorted(self._heap) if ticket.waiting)

    def add(self, ticket: Ticket, start: float | None = None) -> None:
        """Let a ticket wait.

        Parameters
        ----------
        ticket
            The ticket; its start and that it waits are written to it.
        start
            Start in virtual time of one that was served in vain and is put back; None of a new one.
        """
        flow = ticket.flow
        if start is None:
            # Not before the last of the flow either, whose finish may have been charged less since.
            start = max(self._now, self._finish.get(flow, 0.0), self._last.get(flow, 0.0))
            self._last[flow] = start
        ticket.start = start
        ticket.waiting = True
        finish = ticket.start + ticket.cost_s / WEIGHTS[flow.kind]
        self._finish[flow] = max(self._finish.get(flow, 0.0), finish)
        if flow not in self._count:
            self._count[flow], self._held[flow] = 0, 0.0
            self._weights += WEIGHTS[flow.kind]
        self._held[flow] += ticket.cost_s
        self._count[flow] += 1
        self._held_in_all += ticket.cost_s
        self._count_in_all += 1
        heapq.heappush(self._heap, (ticket.start, next(self._numbers), ticket))

    def pop(self) -> Ticket | None:
        """Return the ticket that is next, or None."""
        while self._heap:
            start, _, ticket = heapq.heappop(self._heap)
            if ticket.waiting:
                self._now = max(self._now, start)
                self._let_go(ticket)
                return ticket
        return None

    def remove(self, ticket: Ticket) -> None:
        """Take a ticket out that nobody waits for any more."""
        if ticket.waiting:
            self._let_go(ticket)
            self.charge(ticket, 0.0)

    def charge(self, ticket: Ticket, spent_s: float) -> None:
        """Count what a ticket has cost in place of what it was expected to.

        Parameters
        ----------
        ticket
            A ticket that is not in the queue any more.
        spent_s
            What it has cost [s].
        """
        flow = ticket.flow
        if flow in self._finish:
            self._finish[flow] += (spent_s - ticket.cost_s) / WEIGHTS[flow.kind]
            self._forget_if_idle(flow)

    def wait_s(self, flow: Flow, cost_s: float, servers: int) -> float:
        """Return how long a new ticket is expected to wait [s].

        Everything that waits is before it at most, and at most what its flow's fair share of the
        servers makes by itself.

        Parameters
        ----------
        flow
            Whose ticket it is.
        cost_s
            What it is expected to take [s].
        servers
            How many tickets are served at a time.

        Returns
        -------
        float
            The expected wait [s].
        """
        weight = WEIGHTS[flow.kind]
        others = self._weights - (weight if flow in self._count else 0.0)
        shares = 1 + others / weight
        own = self._held.get(flow, 0.0)
        return min(self._held_in_all, shares * own + (shares - 1) * cost_s) / servers

    def _let_go(self, ticket: Ticket) -> None:
        flow = ticket.flow
        ticket.waiting = False
        self._count[flow] -= 1
        self._held[flow] -= ticket.cost_s
        self._held_in_all -= ticket.cost_s
        self._count_in_all -= 1
        if not self._count[flow]:
            del self._count[flow], self._held[flow]
            self._last.pop(flow, None)
            self._weights -= WEIGHTS[flow.kind]
            self._forget_if_idle(flow)
        if not self._count_in_all:
            self._heap.clear()
            self._held_in_all = self._weights = 0.0  # rounding adds up no further
            # Where nobody waits nobody owes: all begin anew, and nothing is kept of who has left.
            self._now = max(self._now, *self._finish.values()) if self._finish else self._now
            self._finish.clear()

    def _forget_if_idle(self, flow: Flow) -> None:
        """Drop what need not be known: a flow whose time has come would begin now anyway."""
        if flow not in self._count and self._finish[flow] <= self._now:
            del self._finish[flow]
