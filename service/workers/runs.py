"""A task on its way through the pool, and how it ends without an answer."""

import asyncio
import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from service.problems import INTERNAL, OVERLOADED, Problem, ProblemError
from service.workers.process import Worker
from service.workers.queue import Kind, Ticket

STOPPING = Problem(OVERLOADED, "the service is stopping; try again later")


class TaskError(ProblemError):
    """A task that has no answer."""


class SplitError(Exception):
    """A task of several parts that takes longer than a slice: its parts are to be run apart."""


@dataclass(eq=False, slots=True, kw_only=True)
class Run:
    """One task on its way: waiting, or in a worker.

    Attributes
    ----------
    shape
        What tasks share that cost alike.
    splits
        Whether it is given up where it is large, for its parts to be run apart.
    callers
        How many wait for it.
    large, overdue
        Whether it has one of the places for large work; whether it should.
    """

    task: Callable[..., object]
    arguments: tuple[object, ...]
    client: str
    kind: Kind
    shape: Hashable
    key: Hashable | None
    limit_s: float
    splits: bool
    done: "asyncio.Future[object]"
    ticket: Ticket
    callers: int = 0
    crashes: int = 0
    deaths: int = 0
    large: bool = False
    overdue: bool = False
    worker: Worker | None = None
    begun: float = 0.0
    timers: list[asyncio.TimerHandle] = field(default_factory=list)

    def stop_timers(self) -> None:
        """Let nothing happen to it by time."""
        for timer in self.timers:
            timer.cancel()
        self.timers.clear()


def no_room_error(detail: str, wait_s: float) -> TaskError:
    """Return the error that there is no room for a task.

    Parameters
    ----------
    detail
        Why there is none, in words.
    wait_s
        When there may be room [s]; the answer says it in whole seconds, at least 1.

    Returns
    -------
    TaskError
        An overload.
    """
    problem = Problem(
        OVERLOADED, f"{detail}; try again later", retry_after_s=max(1, math.ceil(wait_s))
    )
    return TaskError(problem)


def long_wait_error(wait_s: float) -> TaskError:
    """Return the error that a task would wait too long.

    Parameters
    ----------
    wait_s
        When a worker is expected to be free [s].

    Returns
    -------
    TaskError
        An overload.
    """
    return no_room_error(f"a worker is expected to be free in {wait_s:.2g} s only", wait_s)


def failure() -> TaskError:
    """Return the error that a task failed by a fault of ours.

    The log has the reason.
    """
    return TaskError(Problem(INTERNAL, "the service failed; its log has the reason"))
