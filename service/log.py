"""The log: one JSON object a line, on stderr."""

import atexit
import contextlib
import json
import logging
import os
import queue
import sys
import threading
import time

MAX_LINES = 10_000
"""Lines that wait for a slow reader of stderr, beyond which they are dropped, and counted."""

GATHERED_S = 0.01
"""How long lines are gathered before they are written [s]."""

FULL_PAUSE_S = 0.01
"""Between two attempts to write where there is no room just now [s]."""

LAST_LINES_S = 1.0
"""How long a process that ends waits for its last lines to be taken [s]."""


class JsonFormatter(logging.Formatter):
    """One JSON object a line."""

    default_time_format = "%Y-%m-%dT%H:%M:%S%z"

    def __init__(self) -> None:
        super().__init__()
        self._second, self._time = 0, ""

    def formatTime(self, record: logging.LogRecord, datefmt: str | None = None) -> str:
        """Return the record's time, to the second; a second's lines share it.

        Parameters
        ----------
        record
            The record.
        datefmt
            Format as of `time.strftime`; ISO 8601 with the zone if not given.

        Returns
        -------
        str
            Local time.
        """
        second = int(record.created)
        if second != self._second:
            self._time = time.strftime(datefmt or self.default_time_format, time.localtime(second))
            self._second = second
        return self._time

    def format(self, record: logging.LogRecord) -> str:
        """Return a record as one JSON object.

        It has the time, level, logger and message, and the fields given beside the message.
        """
        line = {
            "time": self.formatTime(record),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            **getattr(record, "fields", {}),
        }
        if record.exc_info:
            line["traceback"] = self.formatException(record.exc_info)
        return json.dumps(line)


class Log(logging.Handler):
    """Writes lines in a separate thread: a reader that does not read holds up nobody.

    Parameters
    ----------
    file
        Descriptor of what is written to.
    """

    def __init__(self, file: int) -> None:
        # One without a bound of its own, which costs a tenth of one that has.
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        super().__init__()
        self.setFormatter(JsonFormatter())
        self._file = file
        self._dropped = 0
        self._counting = threading.Lock()
        self._thread = threading.Thread(target=self._write, name="log", daemon=True)
        self._thread.start()

    def emit(self, record: logging.LogRecord) -> None:
        """Leave a line to the thread."""
        if self._lines.qsize() < MAX_LINES:
            self._lines.put(self.format(record))
            return
        with self._counting:
            self._dropped += 1

    def finish(self) -> None:
        """Wait for the last lines, if they are taken."""
        self._lines.put(None)
        self._thread.join(LAST_LINES_S)

    def _write(self) -> None:
        try:
            while lines := self._waiting():
                self._put("\n".join(filter(None, lines)))
                if self._dropped:
                    self._tell_dropped()
                if lines[-1] is None:
                    return
                # To be woken for each line would cost the caller more than the line.
                time.sleep(GATHERED_S)
        except BrokenPipeError:
            return  # there is nobody left to tell

    def _waiting(self) -> list[str | None]:
        """Wait for a line; return all that are there, None last of all."""
        lines = [self._lines.get()]
        with contextlib.suppress(queue.Empty):
            while lines[-1] is not None:
                lines.append(self._lines.get_nowait())
        return lines

    def _tell_dropped(self) -> None:
        with self._counting:
            dropped, self._dropped = self._dropped, 0
        told = f"{dropped} lines were dropped: stderr was not read"
        fields = {"name": "shapersmith", "levelname": "WARNING", "msg": told}
        self._put(self.format(logging.makeLogRecord(fields)))

    def _put(self, line: str) -> None:
        if not line:
            return
        left = memoryview(f"{line}\n".encode())
        while left:
            try:
                left = left[os.write(self._file, left) :]
            except BlockingIOError:  # another process has made it so
                time.sleep(FULL_PAUSE_S)


def log_to_stderr() -> None:
    """Have this process log what it and its server tell."""
    # Nothing of a line says where in the code it comes from: a request need not pay for it.
    logging._srcfile = None
    logging.logThreads = logging.logProcesses = logging.logMultiprocessing = False
    log = Log(sys.stderr.fileno())
    atexit.register(log.finish)
    for name in ("shapersmith", "uvicorn"):
        logger = logging.getLogger(name)
        logger.addHandler(log)
        logger.setLevel(logging.INFO)
        logger.propagate = False
