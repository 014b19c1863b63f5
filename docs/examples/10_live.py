"""The same buttons three times: as they are, through a delay line, solved anew at each event.

The crane is nonlinear, and its drive brakes differently from how it accelerates. The name of a file
writes the picture of docs/live.md:

    python docs/examples/10_live.py docs/pictures/live-modes.png
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

from design.live.machine import LiveKind, LiveMachine
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.pendulum import Pendulum
from design.pictures.files import figure_bytes
from design.pictures.sheet import Sheet
from design.pictures.style import STROKES, house_style
from design.pipeline import design
from design.rig.crane import Crane
from design.rig.live_events import live_commands
from design.rig.runs import Run, Scenario, run
from design.rig.scenario import Drive
from design.shapers.registry import SHAPERS

SPEED_M_S, UNTIL_S, MM = 0.2, 12.0, 1000.0
PLANT = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
DRIVE = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50, damping_ratio=1.5),
    model="switched",
)
BUTTONS = ((0.0, 1.0), (0.4, 0.0), (0.8, 1.0), (2.9, -1.0), (5.2, -0.5), (7.0, 0.0))
"""When which level is asked for: a press, a release too early, a reversal, half speed, a stop."""


def runs() -> dict[str, Run]:
    """Return the crane under the same buttons in each mode."""
    drives = [
        Drive(event=number, axis="x", at_s=at_s, level=level)
        for number, (at_s, level) in enumerate(BUTTONS)
    ]
    line = design(PLANT, DRIVE, SHAPERS["numzv"]).impulses
    machine = LiveMachine(plant=PLANT, actuator=DRIVE, kind=LiveKind(name="numzv"))
    solved = live_commands(machine, drives, {}).commands
    crane = Crane(cable_length_m=PLANT.cable_length_m, gravity_m_s2=PLANT.gravity_m_s2)

    def ran(**how: object) -> Run:
        scenario = Scenario(crane=crane, drive=DRIVE, speed_m_s=SPEED_M_S, drives=drives, **how)  # type: ignore[arg-type]
        return run(scenario, UNTIL_S, 1201)

    return {"as pressed": ran(), "delay line": ran(shaper=line), "live": ran(solved=solved)}


def sheet(shown: dict[str, Run]) -> Figure:
    """Draw command, velocity and deflection over time: a column a mode."""
    with house_style():
        figure = Sheet(figsize=(9.0, 4.8))
        rows = figure.subplots(2, len(shown), sharex=True, sharey="row")
        for (mode, one), above, below in zip(shown.items(), *rows, strict=True):
            clock = one.track.times_s
            above.set_title(mode)
            above.plot(clock, one.command_m_s[:, 0], color=STROKES[1][0], linewidth=1.0)
            above.plot(clock, one.track.velocity_m_s[:, 0], color=STROKES[0][0], linewidth=1.4)
            below.plot(clock, MM * one.track.load_m[:, 0], color=STROKES[0][0], linewidth=1.4)
            below.set_xlabel("time [s]")
            left = 100 * (one.residual or 0.0)
            below.set_title(f"left: {left:.3g} %", loc="right", fontweight="normal")
        rows[0][0].set_ylabel("command, velocity [m/s]")
        rows[1][0].set_ylabel("deflection [mm]")
        figure.tight_layout()
        return figure


def main(paths: list[str]) -> None:
    """Tell what is left, and write the picture."""
    shown = runs()
    for mode, one in shown.items():
        sys.stdout.write(f"{mode:<12}{100 * (one.residual or 0.0):.3g} %\n")
    for path in paths:
        Path(path).write_bytes(figure_bytes(sheet(shown), "png"))


if __name__ == "__main__":
    main(sys.argv[1:])
