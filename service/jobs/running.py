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


def run(settings: Settings) -> None:
    """Run jobs until the lifeline is cut.

    Raises
    ------
    StoreError, SchedulerError, DBAPIError, OSError
        If that cannot be for now.
    """
    store = Store(store_url(settings), stalled_s=settings.stalled_s)
    start = starter(settings.job_workers, settings.scheduler)
    runner = Runner(store, start, database_wait_s=settings.database_wait_s)
    threading.Thread(target=_stop_at_the_end, args=(runner,), daemon=True).start()
    runner.run(until=runner.stopping.is_set)
    store.close()


def _stop_at_the_end(runner: Runner) -> None:
    """Stop when the lifeline is cut, whatever the store does."""
    while os.read(sys.stdin.fileno(), 1):
        continue
    runner.stopping.set()
    time.sleep(STOP_WAIT_S)
    os._exit(GAVE_UP)


def main() -> int:
    """Run, and return the exit status."""
    # The service alone hears signals.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    os.setpriority(os.PRIO_PROCESS, 0, NICENESS)
    log_to_stderr()
    try:
        run(Settings.model_validate_json(sys.stdin.buffer.readline()))
    except (StoreError, SchedulerError, DBAPIError, OSError) as error:
        LOG.error("table jobs pause: %s", error)
        return GAVE_UP
    except Exception:
        LOG.exception("table jobs pause")
        return GAVE_UP
    return 0


if __name__ == "__main__":
    sys.exit(main())
