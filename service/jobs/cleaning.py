"""The thread that drops what nobody needs: deleted and old tables, and files without a table."""

import logging
import math
import threading
import time
from pathlib import Path

from sqlalchemy.exc import DBAPIError

from service.files import LockedError, hold_lock, remove_parts
from service.jobs.database import reason_of
from service.jobs.results import lock_of
from service.jobs.store import Store

LOG = logging.getLogger("shapersmith.jobs")

CLEAN_EVERY_S = 60.0
"""Between two looks for what other processes left behind, and tables kept long enough [s]."""


class Cleaner:
    """Erases what was deleted, soon after it was: whoever deletes need not wait for that.

    Parameters
    ----------
    store
        The store.
    files
        Folder of the tables' files.
    keep_s
        How long after its end a table is dropped [s]; 0: kept.
    """

    def __init__(self, store: Store, files: Path, *, keep_s: float) -> None:
        self._store = store
        self._files = files
        self._keep_s = keep_s
        self._stopping = threading.Event()
        self._woken = threading.Event()
        self._thread = threading.Thread(target=self._run, name="old-tables", daemon=True)

    def start(self) -> None:
        """Begin to work."""
        self._thread.start()

    def wake(self) -> None:
        """Have it look at once: a table was cancelled or deleted."""
        self._woken.set()

    def close(self, wait_s: float) -> None:
        """Stop; what is not erased is left to the next start."""
        self._stopping.set()
        self._woken.set()
        if self._thread.is_alive():
            self._thread.join(wait_s)

    def _run(self) -> None:
        """Erase whenever woken, and look for the rest now and then."""
        looked = -math.inf
        while not self._stopping.is_set():
            self._woken.clear()
            try:
                self._erase()
                if time.monotonic() - looked >= CLEAN_EVERY_S:
                    looked = time.monotonic()
                    self._look_for_old()
            except DBAPIError as error:
                LOG.error("old tables are dropped later: %s", reason_of(error))
            except OSError as error:
                LOG.error("files of old tables are removed later: %s", error)
            except Exception:
                LOG.exception("old tables are dropped later")
            self._woken.wait(CLEAN_EVERY_S)

    def _erase(self) -> None:
        for job in self._store.jobs_to_erase():
            for path in self._files.iterdir():
                if path.stem == job:
                    path.unlink(missing_ok=True)
            self._store.erase(job, self._stopping.is_set)

    def _look_for_old(self) -> None:
        if self._keep_s > 0 and self._store.drop_ended(self._keep_s):
            self.wake()
        self.clean_files()

    def clean_files(self) -> None:
        """Remove files of tables that are gone, and parts of files.

        It does not matter who deleted the tables. Parts of a file that is being written stay.
        """
        for path in self._files.glob("[!.]*"):
            if self._store.job(path.stem) is None:
                path.unlink(missing_ok=True)
        hidden = [file.name[1:] for file in self._files.glob(".*")]
        begun = {name.removesuffix(".lock") for name in hidden if name.endswith(".lock")}
        begun |= {name.rsplit(".", 2)[0] for name in hidden if name.endswith(".part")}
        for path in map(self._files.joinpath, begun):
            try:
                with hold_lock(lock_of(path)):
                    remove_parts(path)
            except LockedError:
                continue  # it is being written
