"""What routes need of table jobs, whatever keeps them."""

from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Protocol

from service.jobs.records import Event, Job, NewJob
from service.problems import Problem


class Jobs(Protocol):
    """Keeps table jobs and shows them; what is awaited raises UnansweredError if it cannot now.

    Attributes
    ----------
    stopping
        Whether the service stops, as the server says.
    """

    stopping: Callable[[], bool]

    def start(self) -> None:
        """Begin to work: unfinished jobs go on."""

    def close(self) -> None:
        """Stop working; what is not done is left to the next start."""

    async def add(self, job: NewJob, key: str | None) -> str:
        """Add a job, unless its key has begun one already.

        Parameters
        ----------
        job
            The new job.
        key
            Names the request that asks for the job; None of one that may not be repeated.

        Returns
        -------
        str
            Id of the new job, or of the one that the key has begun.

        Raises
        ------
        KeyReusedError
            If the key began a job of another specification.
        UnansweredError
            If the jobs cannot be asked now.
        """

    async def find(self, job: str) -> Job | None:
        """Return a job, or None."""

    async def newest(self, most: int) -> list[Job]:
        """Return the newest jobs, newest first."""

    async def cancel(self, job: str) -> bool:
        """Cancel a job, and return whether it is cancelled now."""

    async def delete(self, job: str) -> bool:
        """Delete a job that has ended, and return whether it had."""

    async def resume(self, job: str) -> bool:
        """Let a failed job be tried again; return whether it is unfinished now."""

    def events(self, job: Job) -> AsyncIterator[Event]:
        """Yield an event for each state of a job, until its last."""

    def path_of(self, job: str, name: str) -> Path:
        """Return where the file of a job in a format is, or is to be.

        Parameters
        ----------
        job
            Id of the job.
        name
            Name of the format.

        Returns
        -------
        Path
            The file, whether it is there or not.
        """

    def writing_of(self, job: str, name: str) -> Callable[[], Problem | None]:
        """Return the task that writes the file of a job in a format.

        Parameters
        ----------
        job
            Id of the job.
        name
            Name of the format.

        Returns
        -------
        Callable
            The task, for a worker; it returns why it could not write, or None.
        """
