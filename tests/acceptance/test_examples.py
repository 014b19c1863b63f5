"""Every example of the documentation runs."""

import math
import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from design.types import FloatArray

NUMBER = r"(?<![\w.])\d+(?:\.\d+)?"
DOCS = Path(__file__).parents[2] / "docs"
EXAMPLES = sorted((DOCS / "examples").glob("*.py"))


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


def test_the_experiments_of_the_thesis_are_the_tables_and_pictures_of_the_page(
    tmp_path: Path,
) -> None:
    done = subprocess.run(
        [sys.executable, EXAMPLES[7], tmp_path], capture_output=True, text=True, check=True
    )
    page = (DOCS / "thesis-figures.md").read_text()
    blocks = [block.split(":\n", 1) for block in done.stdout.strip().split("\n\n")]
    tables = {name.strip(): table.strip() for name, table in blocks}
    assert [name for name, table in tables.items() if f"\n\n{table}\n\n" not in page] == []
    pictures = {path.name for path in tmp_path.iterdir()}
    assert pictures == {f"{name}.png" for name in tables if name != "stops"}
    for name in pictures:
        assert f"](pictures/{name})" in page
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
        assert (DOCS / "pictures" / name).stat().st_size < 150_000
    rows = {
        (name, *(cell for cell in cells if not re.fullmatch(NUMBER, cell))): [
            float(cell) for cell in cells if re.fullmatch(NUMBER, cell)
        ]
        for name, table in tables.items()
        for cells in (line.strip("| ").split(" | ") for line in table.splitlines()[2:])
    }
    # What the words of the page say, and Kim (2011) of figs. 3-21, 3-22 and 3-27.
    for model in ("linear", "nonlinear"):
        over_lengths = rows["experiment-lengths", "UMZV2", model]
        assert over_lengths[1] < 0.2 * over_lengths[0]
        assert over_lengths[2] < 0.8
        umzv2, by_kim, numzv2 = (
            rows["experiment-pulses", move, model][2]
            for move in ("UMZV2", "NUMZV2 of [K]", "NUMZV2")
        )
        assert max(by_kim, numzv2) < 0.25 * umzv2 < umzv2 < 1.0
        # No digit of the largest residual of UMZV2 is of large swings.
        assert umzv2 == rows["experiment-pulses", "UMZV2", "linear"][2]
        ranges = {
            move: float(np.ptp(rows["experiment-robustness", move, model][4:]))
            for move in ("NUMZV2 of [K]", "NUMZV2", "NUMZVD2 (3.60)", "NUMZVD2 of [K]", "NUMZVD2")
        }
        narrow, wide = list(ranges.values())[:2], list(ranges.values())[2:]
        assert min(wide) > 4 * max(narrow)
    for move in ("NUMZV2", "NUMZVD2"):
        assert rows["stops", move, "switched", "solved"][0] == 0.0
        assert rows["stops", move, "switched", "mirrored"][0] > 0.0
        assert rows["experiment-square", move, "linear"][2] == 0.0


G_M_S2, CABLE_M, SPEED_M_S = 9.81, 0.8, 0.2
SETS = {True: (20.0, 0.8), False: (50.0, 1.5)}
"""Frequency [rad/s] and damping ratio while |command| has risen, and while it has fallen."""


def on_a_sphere(commands: list[tuple[list[float], list[float]]], cable_m: float) -> float:
    """Integrate a bob on a cable behind two switched drives; return how far it swings then [cm].

    Commands are times and steps of x and y. A third route: the bob is a point in space that the
    tension keeps on a sphere, and SciPy integrates it.
    """
    from scipy.integrate import solve_ivp

    levels, sets = [0.0, 0.0], [SETS[True], SETS[True]]

    def rates(_: float, state: FloatArray) -> FloatArray:
        place, rate, speed, acceleration = np.split(state, (3, 6, 8))
        pull = np.array([*acceleration, G_M_S2])
        tension = (place @ pull - rate @ rate) / cable_m**2
        jerk = [
            w * w * (level - one) - 2 * z * w * other
            for (w, z), level, one, other in zip(sets, levels, speed, acceleration, strict=True)
        ]
        return np.concatenate((rate, tension * place - pull, acceleration, jerk))

    events = sorted(
        (time, axis, step)
        for axis, command in enumerate(commands)
        for time, step in zip(*command, strict=True)
    )
    state, now = np.zeros(10), 0.0
    state[2] = -cable_m
    swing = 0.0
    period_s = 2 * math.pi * math.sqrt(cable_m / G_M_S2)
    rest_s = events[-1][0] + 3.0
    for time, axis, step in [*events, (rest_s, 0, 0.0), (rest_s + period_s, 0, 0.0)]:
        if time > now:
            at = np.linspace(now, time, 401)
            done = solve_ivp(
                rates, (now, time), state, method="DOP853", rtol=1e-10, atol=1e-12, t_eval=at
            )
            state, now = done.y[:, -1], time
            swing = 100 * float(np.hypot(done.y[0], done.y[1]).max())
        if step:
            level = round(levels[axis] + SPEED_M_S * step, 12)
            sets[axis] = SETS[abs(level) > abs(levels[axis])]
            levels[axis] = level
    return swing


@pytest.mark.parametrize("move", ["UMZV2", "NUMZV2", "NUMZVD2 (3.60)", "NUMZVD2"])
@pytest.mark.parametrize("cable_m", [0.6, 0.8, 1.1])
def test_an_experiment_leaves_what_a_point_on_a_sphere_does(move: str, cable_m: float) -> None:
    example = runpy.run_path(str(EXAMPLES[7]))
    command = example["MOVES"][move](2.5)
    steps = (command.times_s.tolist(), command.amplitudes.tolist())
    # The swing is seen 400 times a period: its top to 3e-5.
    found = example["crane_cm"](command, cable_m)
    assert found == pytest.approx(on_a_sphere([steps], cable_m), rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("move", ["UMZV2", "NUMZVD2 of [K]"])
def test_a_square_leaves_what_a_point_on_a_sphere_does(move: str) -> None:
    example = runpy.run_path(str(EXAMPLES[7]))
    side = example["over_side"](example["MOVES"][move])
    x, y = example["square_of"](side, 4.0)
    steps = [(one.times_s.tolist(), one.amplitudes.tolist()) for one in (x, y)]
    _, found = example["left_of_square"](side, 4.0)
    assert found == pytest.approx(on_a_sphere(steps, CABLE_M), rel=1e-4, abs=1e-6)


def test_the_same_buttons_in_three_modes_are_told_and_drawn(tmp_path: Path) -> None:
    picture = tmp_path / "modes.png"
    done = subprocess.run(
        [sys.executable, EXAMPLES[8], picture], capture_output=True, text=True, check=True
    )
    rows = [line.rsplit(maxsplit=2) for line in done.stdout.splitlines()]
    left = {mode: float(percent) for mode, percent, _ in rows}
    assert list(left) == ["as pressed", "delay line", "live"]
    assert left["live"] < 0.5 < 10 < left["delay line"] < left["as pressed"]
    assert picture.read_bytes().startswith(b"\x89PNG")
