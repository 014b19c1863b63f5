"""What is printed can be read back, whatever the screen and the system know of letters."""

import io
import json
import os
import subprocess
import sys
from typing import Any

import pytest

from service.cli.streams import prepare
from service.operations.table import TABLE
from tests.service.cli.commands import COMMAND
from tests.shapersmith.requests import REQUESTS

LETTERS = "ζ ✓ m/s² 🏗 \udcff\n"
"""Greek, a tick, a letter that Western Europe has, one beyond 16 bits, and half of one."""

NARROW = ["ascii", "cp1252", "cp437", "latin-1"]
"""Encodings of screens that lack letters."""


class Stream(io.TextIOWrapper):
    """A stream that is a screen or none, and begins as one of Windows does."""

    def __init__(self, encoding: str, *, screen: bool) -> None:
        super().__init__(io.BytesIO(), encoding=encoding, newline="\r\n")
        self._screen = screen

    def isatty(self) -> bool:
        return self._screen


def printed(monkeypatch: pytest.MonkeyPatch, name: str, stream: Stream) -> bytes:
    """Return what is written where the letters are printed."""
    monkeypatch.setattr(sys, name, stream)
    prepare()
    print(LETTERS, end="", file=getattr(sys, name))
    getattr(sys, name).flush()
    written = stream.buffer
    assert isinstance(written, io.BytesIO)
    return written.getvalue()


def unescaped(text: str) -> str:
    """Return a text in which letters are escaped as in JSON."""
    whole: str = json.loads(f'"{text}"')
    return whole


@pytest.mark.parametrize("name", ["stdout", "stderr"])
@pytest.mark.parametrize("encoding", ["utf-8", *NARROW])
def test_a_file_has_the_same_bytes_on_every_system(
    monkeypatch: pytest.MonkeyPatch, name: str, encoding: str
) -> None:
    monkeypatch.delenv("PYTHONIOENCODING", raising=False)
    found = printed(monkeypatch, name, Stream(encoding, screen=False))
    assert found == LETTERS.replace("\udcff", "\\udcff").encode()


@pytest.mark.parametrize("name", ["stdout", "stderr"])
@pytest.mark.parametrize("encoding", ["utf-8", *NARROW])
def test_a_screen_keeps_its_encoding_and_its_lines(
    monkeypatch: pytest.MonkeyPatch, name: str, encoding: str
) -> None:
    found = printed(monkeypatch, name, Stream(encoding, screen=True)).decode(encoding)
    assert found.endswith("\r\n")
    assert unescaped(found.rstrip()) == LETTERS.rstrip()


def test_whoever_reads_text_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("stdout", "stderr"):
        monkeypatch.setattr(sys, name, io.StringIO())
    prepare()


def answer(encoding: str, *arguments: str, given: Any = None) -> bytes:
    """Return what a command prints where Python is told an encoding."""
    done = subprocess.run(
        [*COMMAND, *arguments],
        input=json.dumps(given).encode(),
        env=os.environ | {"PYTHONIOENCODING": encoding},
        capture_output=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    return done.stdout


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
@pytest.mark.parametrize("name", ["design", "recommendation"])
def test_a_narrow_encoding_gets_the_same_answer(encoding: str, name: str) -> None:
    command = TABLE[name].command
    one, other = (answer(kind, command, "-", given=REQUESTS[name]) for kind in ("utf-8", encoding))
    assert json.loads(one) == json.loads(other.decode(encoding))


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
@pytest.mark.parametrize("arguments", [("--help",), ("shapers",), ("shapers", "--format", "table")])
def test_help_and_catalogue_are_printed_in_any_encoding(
    encoding: str, arguments: tuple[str, ...]
) -> None:
    assert answer(encoding, *arguments).decode(encoding)
