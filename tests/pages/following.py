"""A page followed in an empty folder: files written, commands typed, programs run."""

import contextlib
import io
import os
import re
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from itertools import zip_longest
from pathlib import Path

from tests.conftest import free_port
from tests.pages.reading import OMITTED, ROOT, Block, Command, blocks
from tests.patience import PATIENT_S

LISTENS = {"serve": "8000", "nginx": "8080", "dask scheduler": "8786"}
"""What goes on, and its port on the pages; each gets a free one in its place."""

READY = "/health/ready"
"""What a service answers once it answers designs."""

BY_CI = ("make test", "make check test", "make acceptance")
"""What CI runs itself."""

GIVEN = {"crane.json": "docs/designs.md", "which.json": "docs/recommendations.md"}
"""Files of one page that others go on with."""

ROUNDING = 1e-9
"""Printed numbers below this differ from machine to machine [-]."""

DIGITS = 2e-3
"""Share by which other printed numbers may differ: those of four digits by one of the last [-]."""


@dataclass
class Follower:
    """Someone who follows a page: a folder, and what has been done in it."""

    folder: Path
    ports: dict[str, str] = field(
        default_factory=lambda: {port: str(free_port()) for port in LISTENS.values()}
    )
    names: dict[str, object] = field(default_factory=dict)
    status: int = 0
    printed: list[str] = field(default_factory=list)
    running: "list[subprocess.Popen[bytes]]" = field(default_factory=list)

    def follow(self, block: Block) -> list[list[str]]:
        """Do what a block says.

        Parameters
        ----------
        block
            The next block of the page.

        Returns
        -------
        list of list of str
            Lines that each of its commands printed; of a block that shows what the program before
            it printed, these.
        """
        if block.commands:
            return [self._type(command) for command in block.commands]
        if block.file:
            path = self.folder / block.file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(self._with_own_ports(block.text))
        elif block.language == "python":
            with contextlib.chdir(self.folder), contextlib.redirect_stdout(io.StringIO()) as out:
                exec(compile(self._with_own_ports(block.text), "block", "exec"), self.names)
            self.printed = out.getvalue().rstrip("\n").split("\n")
            return []
        elif self.printed:
            return [self.printed]
        else:
            raise AssertionError(f"no file is named, and nothing was run: {block.text}")
        self.printed = []
        return []

    def _type(self, command: Command) -> list[str]:
        if command.line in BY_CI:
            return []
        line = self._with_own_ports(command.line.replace("$?", str(self.status)))
        folder = ROOT if line.startswith("make ") else self.folder
        if line.endswith("&"):
            self._begin(line.rstrip("& "), folder)
            return []
        ran = subprocess.run(
            ["bash", "-c", line],
            cwd=folder,
            env=self._environment(),
            check=False,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=PATIENT_S,
        )
        self.status = ran.returncode
        # What fails is on the page with what it says.
        assert ran.returncode == 0 or command.prints, (line, ran.stdout)
        return self._with_ports_of_page(ran.stdout).rstrip("\n").split("\n")

    def _begin(self, line: str, folder: Path) -> None:
        """Start a command that goes on; a service, until it is ready."""
        output = self.folder / f"output-{len(self.running)}"
        with output.open("wb") as out:
            process = subprocess.Popen(
                ["bash", "-c", f"exec {line}"],
                cwd=folder,
                env=self._environment(),
                stdout=out,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        self.running.append(process)
        ports = [self.ports[port] for name, port in LISTENS.items() if name in line]
        path = READY if "serve" in line else "/"
        for port in ports:
            self._wait_until(f"http://127.0.0.1:{port}{path}", process, output)

    def _wait_until(self, address: str, process: "subprocess.Popen[bytes]", output: Path) -> None:
        """Wait until an address is answered."""
        deadline = time.monotonic() + PATIENT_S
        while time.monotonic() < deadline and process.poll() is None:
            try:
                urllib.request.urlopen(address).close()
            except urllib.error.HTTPError as answer:
                if not address.endswith(READY):
                    answer.close()
                    return
            except OSError:
                pass
            else:
                return
            time.sleep(0.1)
        raise RuntimeError(f"nothing listens: {output.read_text()}")

    def _with_own_ports(self, text: str) -> str:
        serving = re.sub(r"shapersmith serve(?! --port)", "shapersmith serve --port 8000", text)
        return re.sub(
            rf"\b({'|'.join(LISTENS.values())})\b", lambda found: self.ports[found[0]], serving
        )

    def _with_ports_of_page(self, text: str) -> str:
        for port, own in self.ports.items():
            text = re.sub(rf"\b{own}\b", port, text)
        return text

    def _environment(self) -> dict[str, str]:
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        own = {
            "PATH": path,
            "no_proxy": "127.0.0.1",
            "PORT": self.ports["8000"],
            "COLUMNS": "80",
            "SHAPERSMITH": str(ROOT),
        }
        if "PYTHONPATH" in os.environ:  # of a checkout that is not installed
            own["PYTHONPATH"] = str(ROOT)
        return {**os.environ, **own}

    def end(self) -> None:
        """End what goes on."""
        for process in self.running:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGTERM)
            process.wait(2 * PATIENT_S)


@contextmanager
def follower(page: str, folder: Path) -> Iterator[Follower]:
    """Open an empty folder in which a page is followed, with the files that it goes on with."""
    for name, origin in GIVEN.items():
        if page != origin:
            (folder / name).write_text(_file(origin, name))
    (folder / ".venv").symlink_to(Path(sys.executable).parents[1])
    one = Follower(folder)
    try:
        yield one
    finally:
        one.end()


def _file(page: str, name: str) -> str:
    return next(block.text for block in blocks(page) if block.file == name)


def differences(printed: list[str], expected: list[str]) -> list[str]:
    """Return where a page shows other lines than were printed.

    Parameters
    ----------
    printed
        Lines of a program.
    expected
        Lines of the page; around `...` those that it shows of them.

    Returns
    -------
    list of str
        A line for each difference.
    """
    if OMITTED in expected:
        expected = [line for line in expected if line != OMITTED]
        printed = [line for line in printed if any(map(partial(alike, line), expected))]
    pairs = zip_longest(printed, expected, fillvalue="")
    return [f"{one!r}, not {other!r}" for one, other in pairs if not alike(one, other)]


def alike(printed: str, expected: str) -> bool:
    """Return whether two lines have the same words, and numbers of the same size."""
    words, others = printed.split(), expected.split()
    return len(words) == len(others) and all(
        one == other or _close(one, other) for one, other in zip(words, others, strict=True)
    )


def _close(one: str, other: str) -> bool:
    """Return whether two words are numbers that differ by rounding."""
    try:
        a, b = (float(word.strip(",:%()[]")) for word in (one, other))
    except ValueError:
        return False
    return max(abs(a), abs(b)) < ROUNDING or abs(a - b) <= DIGITS * max(abs(a), abs(b))
