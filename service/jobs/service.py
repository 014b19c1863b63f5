"""Table jobs inside the service: their store, what runs them, where their files lie."""

import logging
import threading
from collections.abc import Callable
from pathlib import Path

from sqlalchemy.exc import DBAPIError

from service.files import LockedError, locked, remove_parts
from service.jobs.asking import Asking
from service.jobs.database import StoreError, reason_of
from service.jobs.keeping import Keeper
from service.jobs.records import Job
from service.jobs.results import lock_of
from service.jobs.running import STOP_WAIT_S, store_url
from service.jobs.store import Store
from service.jobs.watching import Watching
from service.settings import Settings

LOG = logging.getLogger("shapersmith.jobs")

CLEAN_EVERY_S = 60.0
"""Between two looks for files that nobody needs, and tables kept long enough [s]."""

DAY_S = 86_400.0

READERS, MOST_READS = 4, 256
"""Threads that read from the store for requests; calls with them beyond which one is refused."""

WRITERS, MOST_WRITES = 2, 32
"""The same of those that write, who may wait for a lock."""


class JobService:
    """The jobs of this process.

    Attributes
    ----------
    store
        The store; from the event loop it is asked by way of ``reading`` and ``writing``.
    watching
        Shows jobs to streams of events.
    stopping
        Whether the service stops; the server tells.
    """

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._folder = Path(settings.data_dir).absolute()
        self._files = self._folder / "results"
        try:
            self.store = Store(store_url(settings), stalled_s=settings.stalled_s)
        except DBAPIError as error:
            raise StoreError(f"the job store does not answer: {error.orig}") from None
        self.reading = Asking("store-reads", threads=READERS, most=MOST_READS)
        self.writing = Asking("store-writes", threads=WRITERS, most=MOST_WRITES)
        self.stopping: Callable[[], bool] = lambda: False
        self.watching = Watching(self.found, lambda: self.stopping())
        self._stop = threading.Event()
        self._keeper = Keeper(settings)
        self._cleaner = threading.Thread(target=self._clean, name="old-tables", daemon=True)

    def start(self) -> None:
        """Begin to work: unfinished jobs go on."""
        try:
            self._files.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(f"no folder for the files of tables: {error}") from None
        if self._settings.job_workers > 0 or self._settings.scheduler:
            self._keeper.start()
        self._cleaner.start()

    async def found(self, job: str) -> Job | None:
        """Return a job, or None.

        Raises
        ------
        UnansweredError
            If the store does not answer.
        """
        return await self.reading.ask(self.store.job, job)

    def path_of(self, job: str, name: str) -> Path:
        """Return where the file of a job in a format is, or is to be."""
        return self._files / f"{job}.{name}"

    def remove_files(self, job: str) -> None:
        """Remove the files of a job that is no more."""
        for path in self._files.glob(f"{job}.*"):
            path.unlink(missing_ok=True)

    def _clean(self) -> None:
        """Drop what nobody needs: old tables, their files, and what killed writers left behind."""
        while not self._stop.is_set():
            try:
                if self._settings.keep_tables_days > 0:
                    self.store.drop_ended(self._settings.keep_tables_days * DAY_S)
                self.store.erase_deleted()
                self._clean_files()
            except DBAPIError as error:
                LOG.error("old tables are dropped later: %s", reason_of(error))
            except OSError as error:
                LOG.error("files of old tables are removed later: %s", error)
            except Exception:
                LOG.exception("old tables are dropped later")
            self._stop.wait(CLEAN_EVERY_S)

    def _clean_files(self) -> None:
        """Remove files of tables that are no more, whoever deleted those, and parts of files."""
        for path in self._files.glob("[!.]*"):
            if self.store.job(path.stem) is None:
                path.unlink(missing_ok=True)
        hidden = [file.name[1:] for file in self._files.glob(".*")]
        begun = {name.removesuffix(".lock") for name in hidden if name.endswith(".lock")}
        begun |= {name.rsplit(".", 2)[0] for name in hidden if name.endswith(".part")}
        for path in map(self._files.joinpath, begun):
            try:
                with locked(lock_of(path)):
                    remove_parts(path)
            except LockedError:
                continue  # it is being written

    def close(self) -> None:
        """Stop working; what is not done is left to the next start."""
        self._stop.set()
        self._keeper.close()
        if self._cleaner.is_alive():
            self._cleaner.join(STOP_WAIT_S)
        self.reading.close()
        self.writing.close()
        self.store.close()
