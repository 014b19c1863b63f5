"""Table jobs inside the service: a runner in a thread of its own, files made in a process."""

import asyncio
import logging
import threading
import time
from concurrent.futures import BrokenExecutor
from pathlib import Path

from sqlalchemy.exc import DBAPIError

from service.jobs.database import StoreError, url_of
from service.jobs.executors import SchedulerError, Started, processes, starter
from service.jobs.records import Job
from service.jobs.results import write_result_of
from service.jobs.runner import Runner
from service.jobs.store import Store
from service.settings import Settings

LOG = logging.getLogger("shapersmith.jobs")

RESTART_PAUSE_S = 5.0
"""Before the runner is tried again that gave up, as on a full disk [s]."""

STOP_WAIT_S = 10.0
"""How long the runner may take to give its chunks back [s]."""

CLEAN_EVERY_S = 60.0
"""Between two looks for tables that have been kept long enough [s]."""

DAY_S = 86_400.0

PART_AGE_S = DAY_S
"""A part of a file so old was left behind by a process that was killed [s]."""


class JobService:
    """The jobs of this process: where its store is, what runs them, where their files lie."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._folder = Path(settings.data_dir).absolute()
        url = settings.database_url or url_of(self._folder / "jobs.sqlite")
        self._files = self._folder / "results"
        try:
            self.store = Store(url, stalled_s=settings.stalled_s)
        except DBAPIError as error:
            raise StoreError(f"the job store does not answer: {error.orig}") from None
        self._stop = threading.Event()
        self._runner: Runner | None = None
        self._thread = threading.Thread(target=self._work, name="table-jobs", daemon=True)
        self._cleaner = threading.Thread(target=self._clean, name="old-tables", daemon=True)
        self._exporter: Started | None = None
        self._making: dict[Path, asyncio.Lock] = {}

    def start(self) -> None:
        """Begin to work: unfinished jobs go on."""
        try:
            self._files.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(f"no folder for the files of tables: {error}") from None
        for part in self._files.glob(".*.part"):
            if time.time() - part.stat().st_mtime > PART_AGE_S:
                part.unlink(missing_ok=True)
        if self._settings.job_workers > 0 or self._settings.scheduler:
            self._thread.start()
        if self._settings.keep_tables_days > 0:
            self._cleaner.start()

    def _clean(self) -> None:
        """Drop old tables, and files here of tables that are no more: another may have dropped."""
        kept_s = self._settings.keep_tables_days * DAY_S
        while not self._stop.is_set():
            try:
                self.store.drop_ended(kept_s)
                for path in self._files.glob("[!.]*"):
                    if self.store.job(path.stem) is None:
                        path.unlink(missing_ok=True)
            except (DBAPIError, OSError) as error:
                LOG.error("old tables are dropped later: %s", error)
            self._stop.wait(CLEAN_EVERY_S)

    def _work(self) -> None:
        settings = self._settings
        start = starter(settings.job_workers, settings.scheduler)
        while not self._stop.is_set():
            self._runner = Runner(self.store, start, database_wait_s=settings.database_wait_s)
            if self._stop.is_set():
                return
            try:
                self._runner.run(until=self._stop.is_set)
            except (StoreError, SchedulerError, DBAPIError, OSError) as error:
                LOG.error("table jobs pause for %g s: %s", RESTART_PAUSE_S, error)
                self._stop.wait(RESTART_PAUSE_S)
            except Exception:
                LOG.exception("table jobs pause for %g s", RESTART_PAUSE_S)
                self._stop.wait(RESTART_PAUSE_S)

    def close(self) -> None:
        """Stop working; what is not done is left to the next start."""
        self._stop.set()
        if self._runner is not None:
            self._runner.stopping.set()
        for thread in (self._thread, self._cleaner):
            if thread.is_alive():
                thread.join(STOP_WAIT_S)
        if self._exporter is not None:
            self._exporter.end()
        self.store.close()

    async def file_of(self, job: Job, name: str) -> Path:
        """Return the file of a job in one format, made if need be.

        Raises
        ------
        OSError
            If there is no space for it.
        """
        path = self._files / f"{job.id}.{name}"
        async with self._making.setdefault(path, asyncio.Lock()):
            if not path.is_file():
                await self._make(job, name, path)
        self._making.pop(path, None)
        return path

    async def _make(self, job: Job, name: str, path: Path) -> None:
        if self._exporter is None:
            self._exporter = processes(1)
        try:
            future = self._exporter.executor.submit(
                write_result_of, self.store.url, job.id, name, str(path)
            )
            await asyncio.wrap_future(future)
        except BrokenExecutor:
            self._exporter.end()
            self._exporter = None
            raise
