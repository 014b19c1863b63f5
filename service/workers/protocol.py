"""What routes need of a pool of workers, whatever its workers are."""

from collections.abc import Callable, Hashable
from typing import Protocol, TypeVar, TypeVarTuple

from service.problems import Problem
from service.workers.costs import Costs
from service.workers.queue import Kind

Arguments = TypeVarTuple("Arguments")
Result = TypeVar("Result")


class Pool(Protocol):
    """Runs tasks for requests.

    Attributes
    ----------
    workers
        How many small tasks run at a time.
    costs
        What tasks are expected to cost.
    """

    workers: int
    costs: Costs

    def start(self) -> None:
        """Start the workers, in the event loop that runs."""

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
        """Run a task in a worker; it ends with the last of its callers.

        A caller that is cancelled waits no more. A task for which nobody waits is ended.

        Parameters
        ----------
        task, arguments
            A function of a module and what it takes, both as pickle has it.
        client, kind
            Whose work it is, and of what kind: those share the workers fairly.
        shape
            What tasks share that cost alike; None where that is not known.
        key
            Tasks of equal keys that are on their way at once are run once; None for each its own.
        limit_s
            Longest run, where not that of the pool [s].
        splits
            Whether it is given up where it takes longer than a slice.

        Returns
        -------
        Result
            What the task returned.

        Raises
        ------
        TaskError
            If it would wait too long, or does; if the time limit or its memory ends it, its worker
            crashes twice, or it fails.
        SplitError
            If it ``splits`` and takes longer than a slice.
        """

    def refusal(self, client: str) -> Problem | None:
        """Return why a small single request would be refused at once.

        It serves those who want to know before they have read the request.

        Parameters
        ----------
        client
            Whose request it is.

        Returns
        -------
        Problem or None
            None where the request would not be refused.
        """

    @property
    def ready(self) -> bool:
        """Whether a worker is there, and there is room for a task."""

    async def close(self) -> None:
        """End the workers; who still waits gets an error."""
