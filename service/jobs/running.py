"""`python -m service.jobs.running`: runs the jobs of a service until its lifeline is cut.

The settings are the first line of standard input, which is the lifeline: at its end the chunks in
flight are given back, and the process ends. Why it cannot go on, it logs.
"""

import logging
import os
import signal
import sys
import threading
import time
from pathlib import Path

from sqlalchemy.exc import DBAPIError

from service.jobs.database import StoreError, url_of
from service.jobs.executors import SchedulerError, starter
from service.jobs.runner import Runner
from service.jobs.store import Store
from service.log import log_to_stderr
from service.settings import Settings
from service.workers import system

LOG = logging.getLogger("shapersmith.jobs")

STOP_WAIT_S = 10.0
"""How long the chunks may take to be given back [s]."""

NICENESS = 10
"""Of all that computes tables: requests go first."""

GAVE_UP = 1
"""The exit status of a process that cannot go on."""


def store_url(settings: Settings) -> str:
    """Return the URL of the job store of a service."""
    return settings.database_url or url_of(Path(settings.data_dir).absolute() / "jobs.sqlite")


def run(settings: Settings, lifeline: int) -> None:
    """Run jobs until the lifeline is cut.

    Parameters
    ----------
    settings
        Those of the service.
    lifeline
        Descriptor of a pipe, which ends when the service wants no more.

    Raises
    ------
    StoreError, SchedulerError, DBAPIError, OSError
        If that cannot be for now.
    """
    store = Store(store_url(settings), stalled_s=settings.stalled_s)
    start = starter(settings.job_workers, settings.scheduler)
    runner = Runner(store, start, database_wait_s=settings.database_wait_s)
    threading.Thread(target=_stop_at_the_end, args=(runner, lifeline), daemon=True).start()
    runner.run(until=runner.stopping.is_set)
    store.close()


def _lifeline() -> int:
    """Return standard input by another descriptor, and leave an empty one in its place.

    A worker that Windows starts asks what its standard input is, which is this process's, and
    would wait for as long as this process reads from it.
    """
    lifeline = os.dup(sys.stdin.fileno())
    empty = os.open(os.devnull, os.O_RDONLY)
    os.dup2(empty, sys.stdin.fileno())
    os.close(empty)
    return lifeline


def _stop_at_the_end(runner: Runner, lifeline: int) -> None:
    """Stop when the lifeline is cut, whatever the store does."""
    while os.read(lifeline, 1):
        continue
    runner.stopping.set()
    time.sleep(STOP_WAIT_S)
    os._exit(GAVE_UP)


def main() -> int:
    """Run, and return the exit status."""
    # The service alone hears signals.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    system.make_way(NICENESS)
    log_to_stderr()
    try:
        settings = Settings.model_validate_json(sys.stdin.buffer.readline())
        run(settings, _lifeline())
    except (StoreError, SchedulerError, DBAPIError, OSError) as error:
        LOG.error("table jobs pause: %s", error)
        return GAVE_UP
    except Exception:
        LOG.exception("table jobs pause")
        return GAVE_UP
    return 0


if __name__ == "__main__":
    sys.exit(main())
