"""Table jobs inside the service: their store, what runs them, where their files lie."""

from collections.abc import AsyncIterator, Callable
from functools import partial
from pathlib import Path

from sqlalchemy.exc import DBAPIError

from service.jobs.asking import Asking
from service.jobs.cleaning import Cleaner
from service.jobs.database import StoreError
from service.jobs.keeping import Keeper
from service.jobs.records import Event, Job, NewJob
from service.jobs.results import write_result_of
from service.jobs.running import STOP_WAIT_S, store_url
from service.jobs.store import Store
from service.jobs.watching import Watching
from service.problems import Problem
from service.settings import Settings

DAY_S = 86_400.0

READERS, MAX_READS = 4, 256
"""Threads that read from the store for requests; calls with them beyond which one is refused."""

WRITERS, MAX_WRITES = 2, 32
"""The same of those that write, who may wait for a lock."""


class JobService:
    """The jobs of this process.

    Attributes
    ----------
    store
        The store, which from the event loop is asked by the methods that are awaited alone.
    cleaner
        Erases what is cancelled or deleted.
    stopping
        Whether the service stops, as the server says.
    """

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._folder = Path(settings.data_dir).absolute()
        self._files = self._folder / "results"
        try:
            self.store = Store(store_url(settings), stalled_s=settings.stalled_s)
        except DBAPIError as error:
            raise StoreError(f"the job store does not answer: {error.orig}") from None
        self._reading = Asking("store-reads", threads=READERS, most=MAX_READS)
        self._writing = Asking("store-writes", threads=WRITERS, most=MAX_WRITES)
        self.stopping: Callable[[], bool] = lambda: False
        self._watching = Watching(self.find, lambda: self.stopping())
        self._keeper = Keeper(settings)
        self.cleaner = Cleaner(self.store, self._files, keep_s=settings.keep_tables_days * DAY_S)

    def start(self) -> None:
        """Begin to work: unfinished jobs go on.

        Raises
        ------
        StoreError
            If there can be no folder for the files of tables.
        """
        try:
            self._files.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(f"no folder for the files of tables: {error}") from None
        if self._settings.job_workers > 0 or self._settings.scheduler:
            self._keeper.start()
        self.cleaner.start()

    async def add(self, job: NewJob, key: str | None) -> str:
        """Add a job, unless its key has begun one already.

        Parameters
        ----------
        job, key
            As of `Jobs.add`.

        Returns
        -------
        str
            Id of the new job, or of the one that the key has begun.

        Raises
        ------
        KeyReusedError
            If the key began a job of another specification.
        UnansweredError
            If the database refuses or is late, or too many calls wait for it already.
        """
        return await self._writing.ask(self.store.add, job, key)

    async def find(self, job: str) -> Job | None:
        """Return a job, or None."""
        return await self._reading.ask(self.store.job, job)

    async def newest(self, most: int) -> list[Job]:
        """Return the newest jobs, newest first."""
        return await self._reading.ask(self.store.jobs, most)

    async def cancel(self, job: str) -> bool:
        """Cancel a job, and return whether it is cancelled now."""
        cancelled = await self._writing.ask(self.store.cancel, job)
        if cancelled:
            self.cleaner.wake()
        return cancelled

    async def delete(self, job: str) -> bool:
        """Delete a job that has ended, and return whether it had.

        Its rows and files are erased thereafter.
        """
        deleted = await self._writing.ask(self.store.delete, job)
        if deleted:
            self.cleaner.wake()
        return deleted

    async def resume(self, job: str) -> bool:
        """Let a failed job be tried again; return whether it is unfinished now."""
        return await self._writing.ask(self.store.resume, job)

    def events(self, job: Job) -> AsyncIterator[Event]:
        """Yield an event for each state of a job, until its last."""
        return self._watching.events(job)

    def path_of(self, job: str, name: str) -> Path:
        """Return where the file of a job in a format is, or is to be.

        Parameters
        ----------
        job, name
            As of `Jobs.path_of`.

        Returns
        -------
        Path
            A file in the folder of results.
        """
        return self._files / f"{job}.{name}"

    def writing_of(self, job: str, name: str) -> Callable[[], Problem | None]:
        """Return the task that writes the file of a job in a format.

        Parameters
        ----------
        job, name
            As of `Jobs.writing_of`.

        Returns
        -------
        Callable
            The task, for a worker; it returns why it could not write, or None.
        """
        return partial(write_result_of, self.store.url, job, name, str(self.path_of(job, name)))

    def close(self) -> None:
        """Stop working; what is not done is left to the next start."""
        self._keeper.close()
        self.cleaner.close(STOP_WAIT_S)
        self._reading.close()
        self._writing.close()
        self.store.close()
