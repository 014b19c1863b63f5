"""The programs of the page on PLCs shape a joystick as the page says, in both languages."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from design.model.actuators.first_order import FirstOrder
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from tests.expm_route import outcome
from tests.pages.following import follower
from tests.pages.reading import blocks
from tests.structured_text import Block

PAGE = "docs/plc.md"
LENGTH_M = 3.0
CYCLE_S = 0.01
DRIVE = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.15, model="switched")

AT_WORST = 0.0635
"""What the page says that commands leave which end at any time [-]."""

SETTLED = 1e-4
"""What cycles of 10 ms leave of commands that last: they share delays between cycles [-]."""

LIVE_BOUND, LIVE_ADDED_S = 1.1e-6, (1.21, 1.74)
"""Residual and added time, in the median and at most, of the live block by the page [-], [s]."""

MAIN = """
#include <stdio.h>
#include "task.c"
int main(void)
{
    double length_m, joystick;
    task_begin();
    while (scanf("%lf %lf", &length_m, &joystick) == 2) {
        printf("%.17g\\n", task(length_m, joystick));
    }
    return 0;
}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of someone who has followed the page up to its program in C."""
    path = tmp_path_factory.mktemp("plc")
    with follower(PAGE, path) as reader:
        for block in blocks(PAGE):
            reader.follow(block)
            if block.file == "task.c":
                break
    return path


def joystick_on(seconds: float, calls: int) -> list[tuple[float, float]]:
    on = round(seconds / CYCLE_S)
    return [(LENGTH_M, 1.0 if 1 <= call <= on else 0.0) for call in range(calls)]


def shaped_in_text(folder: Path, given: list[tuple[float, float]]) -> list[float]:
    text = (folder / "main.st").read_text() + (folder / "crane.st").read_text()
    main = Block(text, "main")
    return [
        main(cable_length_m=length_m, joystick=joystick)["velocity"] for length_m, joystick in given
    ]


def shaped_in_c(folder: Path, given: list[tuple[float, float]]) -> list[float]:
    (folder / "played.c").write_text(MAIN)
    subprocess.run(
        ["gcc", "-std=c99", "-Wall", "-Werror", "-o", "played", "played.c", "-lm"],
        cwd=folder,
        check=True,
    )
    lines = "\n".join(f"{length_m!r} {joystick!r}" for length_m, joystick in given)
    ran = subprocess.run(
        ["./played"], cwd=folder, input=lines.encode(), capture_output=True, check=True
    )
    return [float(line) for line in ran.stdout.split()]


@pytest.mark.parametrize(("on_s", "at_most"), [(0.4, AT_WORST), (1.8, AT_WORST), (8.0, SETTLED)])
def test_what_the_programs_shape_leaves_what_the_page_says(
    folder: Path, on_s: float, at_most: float
) -> None:
    given = joystick_on(on_s, round((on_s + 4) / CYCLE_S))
    velocities = shaped_in_text(folder, given)
    np.testing.assert_allclose(shaped_in_c(folder, given), velocities, rtol=0, atol=1e-12)
    changes = np.diff(velocities)
    held = np.flatnonzero(np.abs(changes) > 1e-12)
    command = Impulses(times_s=held * CYCLE_S, amplitudes=changes[held])
    assert command.amplitudes.sum() == pytest.approx(0.0, abs=1e-12)
    assert min(velocities) >= 0
    assert max(velocities) <= 1 + 1e-12
    mode = Pendulum(cable_length_m=LENGTH_M).mode
    assert outcome(command, mode, DRIVE).residual <= at_most


def test_a_length_outside_of_the_table_is_reported_and_keeps_the_times(folder: Path) -> None:
    text = (folder / "main.st").read_text() + (folder / "crane.st").read_text()
    main = Block(text, "main")
    assert main(cable_length_m=2.9, joystick=0.0)["unknown_length"] is True
    assert main(cable_length_m=2.9, joystick=1.0)["velocity"] == 1.0
    assert main(cable_length_m=3.0, joystick=1.0)["unknown_length"] is False
    held = list(main.values["times"].values["times_s"].values)
    assert main(cable_length_m=12.1, joystick=1.0)["unknown_length"] is True
    assert main.values["times"].values["times_s"].values == held


def test_the_live_block_adds_the_time_of_the_page_and_keeps_its_bound(tmp_path: Path) -> None:
    with follower(PAGE, tmp_path) as reader:
        for block in blocks(PAGE):
            if block.file in {"joystick.json", "live_main.st"} or any(
                "joystick.json" in command.typed for command in block.commands
            ):
                reader.follow(block)
    text = (tmp_path / "live_main.st").read_text() + (tmp_path / "joystick.st").read_text()
    mode = Pendulum(cable_length_m=LENGTH_M).mode
    added_s = []
    for on_s in np.linspace(0.025, 1.25, 40) * mode.period_s:
        main = Block(text, "live_main")
        on = round(on_s / CYCLE_S)
        shares = [
            main(enable=True, wanted=float(call < on), cable_length_m=LENGTH_M)["velocity_m_s"]
            for call in range(on + round(mode.period_s / CYCLE_S))
        ]
        changes = np.diff(shares, prepend=0.0)
        held = np.flatnonzero(changes)
        command = Impulses(times_s=held * CYCLE_S, amplitudes=changes[held])
        assert outcome(command, mode, DRIVE).residual <= LIVE_BOUND
        added_s.append((held[-1] - on) * CYCLE_S)
    assert (np.median(added_s), max(added_s)) == pytest.approx(LIVE_ADDED_S, abs=CYCLE_S / 2)
