"""Calls to the job store from the event loop: in threads of their own, and not without bound."""

import asyncio
import logging
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import ParamSpec, TypeVar

from sqlalchemy.exc import DBAPIError
from sqlalchemy.exc import TimeoutError as NoConnectionError

from service.jobs.database import LOCK_WAIT_S, reason_of
from service.problems import OVERLOADED, Problem, ProblemError

MAX_WAIT_S = LOCK_WAIT_S + 1.0
"""How long a caller waits for an answer; a little more than the store for a lock [s]."""

Arguments = ParamSpec("Arguments")
Answer = TypeVar("Answer")

ERRORS = logging.getLogger("shapersmith.error")


class UnansweredError(ProblemError):
    """The job store does not answer just now; the message says why."""

    def __init__(self, reason: str) -> None:
        super().__init__(Problem(OVERLOADED, reason))


class Asking:
    """A few threads that ask the store, and how many calls may be with them.

    Parameters
    ----------
    name
        Of the threads.
    threads
        Calls at a time.
    most
        Calls running and waiting beyond which new ones are refused.
    """

    def __init__(self, name: str, *, threads: int, most: int) -> None:
        self._threads = ThreadPoolExecutor(threads, thread_name_prefix=name)
        self._places = threading.BoundedSemaphore(most)

    async def ask(
        self,
        call: Callable[Arguments, Answer],
        *arguments: Arguments.args,
        **named: Arguments.kwargs,
    ) -> Answer:
        """Return what a call of the store returns.

        Parameters
        ----------
        call
            Asks the store, in one of the threads.
        arguments, named
            What the call takes.

        Returns
        -------
        Answer
            What the call returned.

        Raises
        ------
        UnansweredError
            If the database refuses or is late, or too many calls wait for it already.
        """
        if not self._places.acquire(blocking=False):
            raise UnansweredError("the job store does not answer: too many calls wait for it")
        future = self._threads.submit(call, *arguments, **named)
        future.add_done_callback(self._leave)
        try:
            async with asyncio.timeout(MAX_WAIT_S):
                return await asyncio.wrap_future(future)
        except (DBAPIError, NoConnectionError) as error:
            ERRORS.error("the job store does not answer: %s", getattr(error, "orig", error))
            raise UnansweredError(f"the job store does not answer: {reason_of(error)}") from None
        except TimeoutError:
            raise UnansweredError(f"the job store did not answer within {MAX_WAIT_S:g} s") from None

    def _leave(self, future: "Future[Answer]") -> None:
        del future
        self._places.release()

    def close(self) -> None:
        """Take no more calls; those that wait are dropped."""
        self._threads.shutdown(wait=False, cancel_futures=True)
