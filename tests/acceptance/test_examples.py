"""Every example of the documentation runs."""

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[2] / "docs" / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
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
    assert left == [0.0, 0.58, 0.58, 0.58, 0.0, 33.61, 33.61, 0.24]
    assert picture.read_bytes().startswith(b"\x89PNG")
