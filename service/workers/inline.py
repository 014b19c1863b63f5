"""A pool without processes, for tests and tools: each task is run at once, in this process."""

import logging
import pickle
from collections.abc import Callable, Hashable

from service.problems import Problem
from service.workers.costs import Costs
from service.workers.protocol import Arguments, Result
from service.workers.queue import Kind
from service.workers.runs import STOPPING, TaskError, failure

LOG = logging.getLogger("shapersmith.pool")


class InlinePool:
    """Answers as `WorkerPool` does where nothing takes long and nothing dies.

    Tasks, arguments and results are pickled all the same, as they would be on their way to a
    worker and back. Limits of time and memory are not kept.
    """

    def __init__(self) -> None:
        self.workers = 1
        self.costs = Costs()
        self.full: Problem | None = None  # why every task is refused

    def start(self) -> None:
        """Do nothing: there is nothing to start."""

    async def run(
        self,
        task: Callable[[*Arguments], Result],
        *arguments: *Arguments,
        client: str = "",
        kind: Kind = "single",
        shape: Hashable = None,
        key: Hashable = None,
        limit_s: float | None = None,
        splits: bool = False,
    ) -> Result:
        """Run a task at once, in this process.

        Parameters
        ----------
        task, arguments, client, kind, shape, key, limit_s, splits
            As of `Pool.run`; those after the arguments have no effect.

        Returns
        -------
        Result
            What the task returned, pickled and read back.

        Raises
        ------
        TaskError
            If the pool is full or closed, or the task fails.
        """  # noqa: DOC501 - `failure` returns a TaskError
        del client, kind, shape, key, limit_s, splits
        if self.full is not None:
            raise TaskError(self.full)
        sent = pickle.dumps((task, arguments))
        try:
            called, given = pickle.loads(sent)
            result: Result = pickle.loads(pickle.dumps(called(*given)))
        except Exception as error:
            LOG.exception("a task failed")
            raise failure() from error
        return result

    def refusal(self, client: str) -> Problem | None:
        """Return why every request is refused, if it is."""
        del client
        return self.full

    @property
    def ready(self) -> bool:
        """Whether there is room for a task."""
        return self.full is None

    async def close(self) -> None:
        """Refuse every task from now on."""
        self.full = STOPPING
