"""The command line: called in this process, or in one of its own."""

import json
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from tempfile import TemporaryFile

import pytest

from service.__main__ import main

COMMAND = (sys.executable, "-m", "service")

Done = subprocess.CompletedProcess[str]


def shapersmith(*arguments: object, given: object = None) -> Done:
    """Run one command in this process, which saves the start of another.

    ``given`` goes to its standard input, as JSON if it is no text. All three streams are files, as
    those of a process are.
    """
    with (
        TemporaryFile("w+") as stdin,
        TemporaryFile("w+") as stdout,
        TemporaryFile("w+") as stderr,
        pytest.MonkeyPatch.context() as patch,
        redirect_stdout(stdout),
        redirect_stderr(stderr),
    ):
        stdin.write(_text(given))
        stdin.seek(0)
        patch.setattr(sys, "stdin", stdin)
        try:
            status = main([*map(str, arguments)])
        except SystemExit as ended:  # argparse ends so
            status = int(ended.code or 0)
        told = []
        for stream in (stdout, stderr):
            stream.seek(0)
            told.append(stream.read())
    return Done([*map(str, arguments)], status, *told)


def shapersmith_apart(*arguments: object, given: object = None) -> Done:
    """Run one command as a user does."""
    return subprocess.run(
        [*COMMAND, *map(str, arguments)],
        input=_text(given),
        capture_output=True,
        text=True,
        check=False,
    )


def _text(given: object) -> str:
    return given if isinstance(given, str) else json.dumps(given)
