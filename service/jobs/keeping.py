"""The process that runs table jobs, kept alive by the service.

It is another process than the server's, so that what it does for tables, as packing specifications
and recording rows, takes nothing from the loop that answers requests.
"""

import logging
import os
import signal
import subprocess
import sys
import threading

from service.jobs.running import STOP_WAIT_S
from service.settings import Settings
from service.workers import own_path
from service.workers.memory import variables_to_keep_memory

LOG = logging.getLogger("shapersmith.jobs")

COMMAND = (sys.executable, "-m", "service.jobs.running")

RESTART_PAUSE_S = 5.0
"""Before the process is started anew that gave up, as on a full disk, or died [s]."""

KILL_MARGIN_S = 5.0
"""How much longer than it should the process may take to stop before it is killed [s]."""


class Keeper:
    """Starts the process, and starts it anew when it has ended.

    Its standard input is its lifeline: it gets the settings there, and stops when it is closed, be
    it by `close` or because the service was killed.
    """

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._changing = threading.Lock()
        self._stop = threading.Event()
        self._process: subprocess.Popen[bytes] | None = None
        self._thread = threading.Thread(target=self._keep, name="table-jobs", daemon=True)

    def start(self) -> None:
        """Begin to work."""
        self._thread.start()

    def close(self) -> None:
        """Have the process give its chunks back and end; what is not done is left."""
        with self._changing:
            self._stop.set()
            process = self._process
            if process is not None and process.stdin is not None:
                process.stdin.close()
        if not self._thread.is_alive():
            return
        self._thread.join(STOP_WAIT_S + KILL_MARGIN_S)
        if self._thread.is_alive() and process is not None:
            process.kill()
            self._thread.join()

    def _keep(self) -> None:
        while not self._stop.is_set():
            try:
                told = self._until_it_ends()
            except OSError as error:
                told = f"could not be started: {error}"
            if not self._stop.is_set():
                LOG.error("the process of table jobs %s; again in %g s", told, RESTART_PAUSE_S)
            self._stop.wait(RESTART_PAUSE_S)

    def _until_it_ends(self) -> str:
        """Run the process and return how it ended."""
        with self._changing:
            if self._stop.is_set():
                return "was not wanted any more"
            # What a person has set about memory holds.
            env = variables_to_keep_memory() | os.environ | own_path.variables()
            process = self._process = subprocess.Popen(
                COMMAND, stdin=subprocess.PIPE, bufsize=0, env=env
            )
        if process.stdin is None:
            raise OSError("it has no lifeline")
        try:
            process.stdin.write(self._settings.model_dump_json().encode() + b"\n")
        except (BrokenPipeError, ValueError):
            LOG.warning("the process of table jobs ended, or was stopped, before it began")
        code = process.wait()
        how = f"status {code}" if code >= 0 else signal.Signals(-code).name
        return f"{process.pid} ended with {how}"
