"""Every example of the documentation runs."""

import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

NUMBER = r"(?<![\w.])\d+(?:\.\d+)?"
EXAMPLES = sorted((Path(__file__).parents[2] / "docs" / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES[:2], ids=lambda path: path.stem)
def test_an_example_runs_and_says_something(example: Path) -> None:
    done = subprocess.run([sys.executable, example], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(done.stdout.splitlines()) > 1


def test_the_disagreement_of_the_two_models_is_printed() -> None:
    printed = subprocess.run(
        [sys.executable, EXAMPLES[0]], capture_output=True, text=True, check=True
    ).stdout
    rows = [line.split() for line in printed.splitlines()[1:]]
    left = {(kind, made_for): (float(a), float(b)) for kind, made_for, a, b in rows}
    assert left["numzvd", "superposed"][1] == pytest.approx(0.0074, abs=5e-5)
    assert left["umzvd", "ideal"][1] == pytest.approx(0.029, abs=5e-4)
    assert left["numzvd", "switched"][1] < 1e-9


def test_figure_5_of_the_thesis_is_printed_and_drawn(tmp_path: Path) -> None:
    picture = tmp_path / "digital.png"
    command = [sys.executable, str(EXAMPLES[1]), str(picture)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    left = [float(line.rsplit(" %", 1)[0].split()[-1]) for line in printed.splitlines()[1:]]
    assert left == [0.0, 0.58, 0.58, 0.58, 0.0, 33.61, 33.61, 0.76]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_every_figure_of_the_thesis_is_drawn_and_says_what_the_docs_say(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, EXAMPLES[2], tmp_path / "figures"],
        capture_output=True,
        text=True,
        check=True,
    )
    told = dict(line.split(maxsplit=1) for line in done.stdout.splitlines())
    numbers = {f"3-{number}" for number in (13, 14, *range(16, 23), *range(24, 28))}
    assert set(told) == numbers | {"3-15-n", "3-15-m"}
    for number in told:
        picture = (tmp_path / "figures" / f"{number}.png").read_bytes()
        assert picture.startswith(b"\x89PNG")
    figures = {number: [float(one) for one in re.findall(NUMBER, told[number])] for number in told}
    # As printed in docs/thesis-figures.md; what Kim (2011) says of them holds.
    assert figures["3-17"] == pytest.approx([0.89, 0.112, 6.87, 4.973], abs=0.02)
    assert figures["3-18"][1] < 0.12 < 2.0 < figures["3-18"][3]
    assert figures["3-22"] == pytest.approx(
        [0.003, 0.004, 0.001, 1.61, 0.428, 0.833, 0.003, 2.69], abs=0.0011
    )
    assert told["3-27"] == "NUMZV2 5 % width 0.0298; NUMZVD2, mirrored stop 5 % width 0.1757"


def beats(one: tuple[str, float, float], other: tuple[str, float, float]) -> bool:
    """Return whether a shaper is no slower over a band no narrower, and better in either."""
    return one[1] <= other[1] and one[2] >= other[2] and one[1:] != other[1:]


def test_every_band_is_as_wide_as_asked_and_the_shorter_for_it_than_numzvd(tmp_path: Path) -> None:
    picture = tmp_path / "band.png"
    command = [sys.executable, str(EXAMPLES[3]), str(picture)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    table, front = printed.split("\n\n")
    rows = [line.split() for line in table.splitlines()[1:]]
    told = [(name, float(duration), float(band)) for name, _, duration, _, band, _ in rows]
    (numzvd,) = (row for row in told if row[0] == "numzvd")
    bands = [row for row in told if row[0] == "num_si"]
    assert bands == sorted(bands, key=lambda row: row[1])
    assert [row[2] for row in bands] == sorted(row[2] for row in bands)
    assert max(row[2] for row in bands if row[1] < numzvd[1]) >= 18.0 > numzvd[2]
    best = [row for row in told if row[2] > 0 and not any(beats(one, row) for one in told)]
    named = re.findall(r"(\w+) ([\d.]+) s", front.partition(": ")[2])
    # Kinds for several modes are here what they are made of, which stands before them.
    assert {float(duration) for _, duration in named} == {row[1] for row in best}
    assert {name for name, _ in named} <= {row[0] for row in best}
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_end_of_the_last_ramp_rises_with_the_ramps(tmp_path: Path) -> None:
    picture = tmp_path / "ramps.png"
    command = [sys.executable, str(EXAMPLES[4]), str(picture)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = [[float(one) for one in line.split()] for line in printed.splitlines()[1:]]
    assert [tuple(row[:2]) for row in rows] == [
        (ratio, damping) for ratio in (1.0, 0.25) for damping in (0.0, 0.05, 0.2)
    ]
    for row in rows:
        assert row[2:] == sorted(row[2:])
        assert row[-1] > 3.0  # the ramp alone
    for equal, stronger in zip(rows[:3], rows[3:], strict=True):
        assert all(late >= early for late, early in zip(equal[2:], stronger[2:], strict=True))
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_residual_over_the_sample_time_is_printed_and_drawn(tmp_path: Path) -> None:
    picture = tmp_path / "samples.png"
    done = subprocess.run(
        [sys.executable, EXAMPLES[5], picture], capture_output=True, text=True, check=True
    )
    rows = [line.split() for line in done.stdout.splitlines()[1:]]
    left = {(row[0], row[1]): [float(one) for one in row[-4:]] for row in rows}
    for kind in ("zv", "ei", "si", "umzv", "numzvd"):
        limit = {"zv": 0.0, "ei": 5.0, "si": 5.0}.get(kind, 1.0)
        # Three tenths of a period are longer than the gaps of unity magnitude.
        assert max(left[kind, "shapersmith"][: 3 if limit == 1.0 else 4]) <= limit
        assert max(left[kind, "nearest"]) > limit or math.isnan(left[kind, "nearest"][-1])
    # The peers' figures of a longer sample: one split swings alike, and is not of unity magnitude.
    assert left["umzv", "split"] == [0.0] * 4
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_shapers_of_a_changing_cable_are_printed_and_a_move_is_drawn(tmp_path: Path) -> None:
    picture = tmp_path / "move.png"
    done = subprocess.run(
        [sys.executable, EXAMPLES[6], picture], capture_output=True, text=True, check=True
    )
    *table, refusal = done.stdout.splitlines()
    rows = {name: [float(one) for one in told] for name, *told in map(str.split, table[2:])}
    assert len(rows) == 4
    assert [row[0] for row in rows.values()] == sorted(row[0] for row in rows.values())
    assert max(max(row[1:]) for row in rows.values()) <= 5.0
    assert rows["umzvd"][3] == 2.45  # as docs/examples/07_python.py says of the thesis's crane
    assert rows["numzvd"][3] == 0.0
    assert refusal.startswith("within 0.5 s: none of ")
    assert picture.read_bytes().startswith(b"\x89PNG")
