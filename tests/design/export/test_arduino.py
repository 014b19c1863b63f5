"""The Arduino library: what its editor demands of it, and its example, compiled and run."""

import io
import re
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from design.export.arduino import EXPORT as ARDUINO
from design.export.c_header import EXPORT as C
from tests.design.export.test_lookup import table
from tests.played_tables import computed, random_request
from tests.refusals import refused

DEMANDED = {
    "name",
    "version",
    "author",
    "maintainer",
    "sentence",
    "paragraph",
    "category",
    "url",
    "architectures",
}
"""Of library.properties."""

BOARD = """
#include <stddef.h>
#define A0 0
inline unsigned long now_ms = 0;
inline int last = -1;
inline unsigned long millis() { return now_ms; }
inline int analogRead(int) { return 1023; }
inline void analogWrite(int, int value) { last = value; }
"""

MAIN = """
#include <cstdio>
#include "Arduino.h"
#include "example.ino"
int main()
{
    setup();
    for (now_ms = 0; now_ms < 60000; ++now_ms) {
        loop();
        if (now_ms == 0) {
            std::printf("%d ", last);
        }
    }
    std::printf("%d\\n", last);
    return 0;
}
"""


def files_of(which: str) -> dict[str, bytes]:
    head, rows = table(which)
    text = b"".join(ARDUINO.write(replace(head, title="the crane"), [rows]))
    with zipfile.ZipFile(io.BytesIO(text)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_the_folder_is_as_the_specification_says() -> None:
    files = files_of("length")
    assert set(files) == {
        "the_crane/library.properties",
        "the_crane/src/the_crane.h",
        "the_crane/examples/the_crane/the_crane.ino",
    }
    lines = files["the_crane/library.properties"].decode().splitlines()
    found = dict(line.split("=", 1) for line in lines)
    assert set(found) == DEMANDED
    assert re.fullmatch(r"\d+\.\d+\.\d+", found["version"])
    assert re.fullmatch(r"[A-Za-z0-9_. -]{1,63}", found["name"])
    head, rows = table("length")
    header = b"".join(C.write(replace(head, title="the crane"), [rows]))
    assert files["the_crane/src/the_crane.h"] == header


@pytest.mark.parametrize("which", ["length", "switched"])
def test_the_example_shapes_a_command(which: str, tmp_path: Path) -> None:
    files = files_of(which)
    (tmp_path / "Arduino.h").write_text(BOARD)
    (tmp_path / "the_crane.h").write_bytes(files["the_crane/src/the_crane.h"])
    (tmp_path / "example.ino").write_bytes(files["the_crane/examples/the_crane/the_crane.ino"])
    (tmp_path / "main.cpp").write_text(MAIN)
    flags = ["-std=c++17", "-Wall", "-Wextra", "-Werror", f"-I{tmp_path}"]
    made = subprocess.run(
        ["g++", *flags, "-o", str(tmp_path / "main"), str(tmp_path / "main.cpp"), "-lm"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stderr
    told = subprocess.run([str(tmp_path / "main")], capture_output=True, text=True, check=True)
    first, last = map(int, told.stdout.split())
    # The first impulse of either shaper is 1; what all add up to is 1.
    assert (first, last) == (255, 255)


def test_samples_are_for_the_header_alone() -> None:
    with refused("arduino_not_on_samples", "shaper.sample_time_s"):
        ARDUINO.checks(computed(random_request(0)).head)
