"""The log: nobody waits for its reader."""

import json
import logging
import os
import subprocess
import sys
from pathlib import Path

import pytest

from service import log
from tests.conftest import Running, free_port, wait_until_ready
from tests.patience import PATIENT_S


def record(number: int) -> logging.LogRecord:
    return logging.makeLogRecord({"name": "shapersmith", "levelname": "INFO", "msg": f"{number}"})


def test_lines_that_nobody_reads_are_dropped_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(log, "MAX_LINES", 10)
    monkeypatch.setattr(log, "LAST_LINES_S", 0.01)
    reading, writing = os.pipe()
    handler = log.Log(writing)
    sent = 5000  # more than a pipe holds
    for number in range(sent):
        handler.handle(record(number))
    handler.finish()  # in vain
    monkeypatch.setattr(log, "LAST_LINES_S", PATIENT_S)
    told = []
    with os.fdopen(reading) as lines:
        for line in lines:
            told.append(json.loads(line)["message"])
            if "dropped" in told[-1]:
                break
        handler.finish()
        os.close(writing)
        told += [json.loads(line)["message"] for line in lines]
    written = [one for one in told if one.isdigit()]
    dropped = [int(one.split()[0]) for one in told if "dropped" in one]
    assert written == sorted(written, key=int)
    assert len(written) + sum(dropped) == sent
    assert dropped


def test_a_service_whose_log_nobody_reads_answers_and_stops(tmp_path: Path) -> None:
    port = free_port()
    process = subprocess.Popen(
        [sys.executable, "-m", "service", "serve", "--port", str(port)],
        stderr=subprocess.PIPE,
        env={
            **os.environ,
            "SHAPERSMITH_DATA_DIR": str(tmp_path / "data"),
            "SHAPERSMITH_WORKERS": "1",
            "SHAPERSMITH_JOB_WORKERS": "0",
        },
    )
    service = Running(process, port, tmp_path / "data")
    try:
        wait_until_ready(service)
        with service.client() as client:
            for _ in range(1500):  # more lines than a pipe holds
                assert client.get("/health/live").status_code == 200
        process.terminate()
        assert process.wait(PATIENT_S) == 0
    finally:
        process.kill()
        process.communicate()
