"""Experiments of Kim (2011), chapter 3, on a crane that is integrated: tables, and four pictures.

Every number stands twice: linear, by the closed form; nonlinear, by the crane of `design.rig`,
whose swings are as large as they are. The tables are those of docs/thesis-figures.md. The name of a
folder writes the pictures:

    python docs/examples/09_thesis_experiments.py pictures
"""

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from design.analysis.residual import residual_vibration
from design.analysis.unshaped import unshaped_deflection_s
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.commands import pulse
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.moves.parts import mirrored_stop
from design.moves.playback import motion
from design.pictures.files import figure_bytes
from design.pictures.sheet import Sheet
from design.pictures.style import STROKES, house_style
from design.pipeline import design
from design.response.closed_form import travel
from design.rig.crane import Crane
from design.rig.machine import Machine
from design.rig.track import Track
from design.shapers.registry import SHAPERS
from design.types import FloatArray

GRAVITY_M_S2, LENGTH_M, SPEED_M_S = 9.81, 0.8, 0.2
PLANT = Pendulum(cable_length_m=LENGTH_M, gravity_m_s2=GRAVITY_M_S2)
DRIVE = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50, damping_ratio=1.5),
    model="switched",
)
SIDE_M, SIDE_S = 0.42, 4.0
"""A side of the square, and when the next one begins."""
REST_S = 3.0
"""How long after its last step the drive is at rest to rounding: 48 of its time constants [s]."""
SMALL_CM = 0.5
"""What [K] says NUMZV2 stays below."""
CM = 100.0
Make = Callable[[float], Impulses]
"""From the pulse [s] to a whole move."""


def joined(start: Impulses, stop: Impulses, pulse_s: float) -> Impulses:
    """Return a start and, a pulse after its first step, a stop."""
    return Impulses(
        times_s=np.concatenate((start.times_s, pulse_s + stop.times_s)),
        amplitudes=np.concatenate((start.amplitudes, stop.amplitudes)),
    )


@cache
def start_of(kind: str, model: Model | None) -> Impulses:
    """Return a start, designed for a model of the drive or, without one, an ideal drive."""
    drive = Ideal() if model is None else replace(DRIVE, model=model)
    return design(PLANT, drive, SHAPERS[kind]).impulses


def mirrored(start: Impulses) -> Make:
    """Return moves whose stop mirrors the start (3.56-3.59)."""
    return lambda pulse_s: joined(start, mirrored_stop(start), pulse_s)


def solved(kind: str, model: Model) -> Make:
    """Return moves whose stop is solved with the sets of the drive swapped."""
    drive = replace(DRIVE, model=model)
    registered = SHAPERS[kind]
    return lambda pulse_s: (
        maneuver(PLANT, drive, registered, speed_m_s=SPEED_M_S, pulse_s=pulse_s).command
    )


PRINTED = Impulses(
    times_s=np.array([0, 0.1739, 0.6369, 1.1360, 1.2724]), amplitudes=np.array([1.0, -1, 1, -1, 1])
)
"""The start of NUMZVD2 as [K] prints it (3.60)."""
# [K] designs for superposed steps. It swaps the sets for the stop of NUMZV2 (3.42, 3.43), and
# mirrors the start of NUMZVD2. An ideal drive has equal sets: UMZV2 mirrored is UMZV2 solved.
MOVES: dict[str, Make] = {
    "UMZV2": mirrored(start_of("umzv", None)),
    "NUMZV2 of [K]": solved("numzv", "superposed"),
    "NUMZV2": solved("numzv", "switched"),
    "NUMZVD2 (3.60)": mirrored(PRINTED),
    "NUMZVD2 of [K]": mirrored(start_of("numzvd", "superposed")),
    "NUMZVD2": solved("numzvd", "switched"),
}


def linear_cm(command: Impulses, length_m: float = LENGTH_M) -> float:
    """Return the amplitude that a command leaves, by the closed form for small swings [cm]."""
    mode = replace(PLANT, cable_length_m=length_m).mode
    share = residual_vibration(command, mode, DRIVE)
    return CM * SPEED_M_S * share * unshaped_deflection_s(mode, DRIVE)


def played(x: Impulses, y: Impulses | None, length_m: float, times_s: FloatArray) -> Track:
    """Play commands of both axes on the crane; see it at times, shape (n,) [s]."""
    machine = Machine(
        Crane(cable_length_m=length_m, gravity_m_s2=GRAVITY_M_S2), (DRIVE, DRIVE), SPEED_M_S
    )
    for axis, command in (("x", x), ("y", y)):
        if command is not None:
            for time_s, level in zip(command.times_s, np.cumsum(command.amplitudes), strict=True):
                machine.command("x" if axis == "x" else "y", round(float(level), 12), float(time_s))
    return machine.advance(float(times_s[-1]), times_s)


def crane_cm(command: Impulses, length_m: float = LENGTH_M) -> float:
    """Return the amplitude that a command leaves on the crane, from the energy left [cm]."""
    track = played(command, None, length_m, np.array([command.times_s[-1] + REST_S]))
    weight_n = track.crane.hook_mass_kg * GRAVITY_M_S2
    cosine = 1 - float(track.swing_energy_j[0]) / (weight_n * length_m)
    return CM * length_m * float(np.sqrt(max(1 - cosine**2, 0.0)))


def row(name: str, *cells: float | str) -> str:
    """Return a row of a table, numbers to a hundredth of a millimetre."""
    told = (one if isinstance(one, str) else f"{one:.3f}" for one in cells)
    return f"| {' | '.join((name, *told))} |"


def head(*names: str) -> Iterator[str]:
    """Yield the head of a table."""
    yield row(*names)
    yield f"|{'---|' * len(names)}"


Both = tuple[FloatArray, FloatArray]
"""What is left over an axis, linear and nonlinear, each of shape (n,) [cm]."""


def over_lengths(make: Make, pulse_s: float, lengths_m: FloatArray) -> Both:
    """Return what a move for 0.8 m leaves under cables of other lengths."""
    command = make(pulse_s)
    both = [(linear_cm(command, one), crane_cm(command, one)) for one in lengths_m.tolist()]
    linear, nonlinear = np.array(both).T
    return linear, nonlinear


def over_pulses(make: Make, pulses_s: FloatArray) -> Both:
    """Return what moves of each pulse leave."""
    commands = [make(pulse_s) for pulse_s in pulses_s.tolist()]
    linear, nonlinear = np.array([(linear_cm(one), crane_cm(one)) for one in commands]).T
    return linear, nonlinear


def panels(title: str, x_label: str, x: FloatArray, found: dict[str, Both]) -> Figure:
    """Draw what is left over an axis: linear beside nonlinear."""
    with house_style():
        figure = Sheet(figsize=(8.4, 4.2))
        pair = figure.subplots(1, 2, sharey=True)
        for side, (axes, name) in enumerate(zip(pair, ("linear", "nonlinear"), strict=True)):
            for (move, both), (colour, dashes) in zip(found.items(), STROKES, strict=False):
                axes.plot(x, both[side], color=colour, linestyle=dashes, label=move)
            axes.set(title=name, xlabel=x_label, xlim=(x[0], x[-1]))
        pair[0].set(ylabel="residual deflection [cm]", ylim=(0, None))
        figure.legend(
            *pair[0].get_legend_handles_labels(), loc="upper left", bbox_to_anchor=(0.08, 0.93),
            ncols=5, handlelength=2.4, columnspacing=1.4,
        )  # fmt: skip
        figure.suptitle(title, x=0.09, ha="left", fontsize=12, weight="bold")
        figure.subplots_adjust(left=0.09, right=0.98, bottom=0.13, top=0.8, wspace=0.08)
    return figure


def edge(x: FloatArray, values: FloatArray, step: int) -> float:
    """Return up to where a curve stays small, from 0.8 m on; not a number if it is not there."""
    at = int(np.argmin(np.abs(x - LENGTH_M)))
    if values[at] > SMALL_CM:
        return float("nan")
    while 0 <= at + step < x.size and values[at + step] <= SMALL_CM:
        at += step
    return float(x[at])


Part = tuple[str, Figure | None, list[str]]
"""Name of the picture, the picture if there is one, the table."""


def lengths() -> Iterator[Part]:
    """Tell figs. 3-21 (pulse 3 s) and 3-27 (2.5 s): errors of the cable's length."""
    x = np.linspace(0.4, 1.4, 201)
    for name, pulse_s, moves in (
        ("experiment-lengths", 3.0, ("UMZV2", "NUMZV2 of [K]", "NUMZV2")),
        (
            "experiment-robustness",
            2.5,
            ("NUMZV2 of [K]", "NUMZV2", "NUMZVD2 (3.60)", "NUMZVD2 of [K]", "NUMZVD2"),
        ),
    ):
        found = {move: over_lengths(MOVES[move], pulse_s, x) for move in moves}
        told = list(head(
            "move", "model", "at 0.8 m [cm]", "least [cm]", "at [m]", "largest [cm]",
            "small from [m]", "to [m]",
        ))  # fmt: skip
        for move, both in found.items():
            for model, values in zip(("linear", "nonlinear"), both, strict=True):
                least = int(values.argmin())
                told.append(row(
                    move, model, float(np.interp(LENGTH_M, x, values)), float(values[least]),
                    float(x[least]), float(values.max()), edge(x, values, -1), edge(x, values, 1),
                ))  # fmt: skip
        title = f"Moves for a cable of 0.8 m, under others; pulse {pulse_s:g} s"
        yield name, panels(title, "length of the cable [m]", x, found), told


def pulses() -> Iterator[Part]:
    """Tell fig. 3-22: the pulse."""
    x = np.linspace(1.0, 4.0, 121)
    found = {move: over_pulses(MOVES[move], x) for move in ("UMZV2", "NUMZV2 of [K]", "NUMZV2")}
    told = list(head("move", "model", "at 3 s [cm]", "least [cm]", "largest [cm]", "of UMZV2 [%]"))
    for move, both in found.items():
        for model, values, umzv2 in zip(("linear", "nonlinear"), both, found["UMZV2"], strict=True):
            at = float(values[int(np.argmin(np.abs(x - 3)))])
            share = f"{100 * values.max() / umzv2.max():.1f}"
            told.append(row(move, model, at, float(values.min()), float(values.max()), share))
    yield "experiment-pulses", panels("Moves over the pulse", "pulse [s]", x, found), told


def stops() -> Iterator[Part]:
    """Tell what the stop that mirrors the start leaves, and the solved one."""
    told = list(head("move", "designed for", "stop", "linear [cm]", "nonlinear [cm]"))
    models: tuple[Model, Model] = ("superposed", "switched")
    for kind, pulse_s in (("numzv", 3.0), ("numzvd", 2.5)):
        for model in models:
            makes = {"mirrored": mirrored(start_of(kind, model)), "solved": solved(kind, model)}
            for stop, make in makes.items():
                command = make(pulse_s)
                left = linear_cm(command), crane_cm(command)
                told.append(row(f"{kind.upper()}2", model, stop, *left))
    command = MOVES["NUMZVD2 (3.60)"](2.5)
    told.append(
        row("NUMZVD2", "as printed (3.60)", "mirrored", linear_cm(command), crane_cm(command))
    )
    yield "stops", None, told


def over_side(make: Make) -> Impulses:
    """Return the move over one side of the square, behind the drive as it is."""
    pulse_s = SIDE_M / SPEED_M_S
    for _ in range(8):
        pulse_s -= travel(make(pulse_s), DRIVE) - SIDE_M / SPEED_M_S
    return make(pulse_s)


def there_and_back(side: Impulses, begins_s: float, back_s: float) -> Impulses:
    """Return the command of an axis: a side, and later the opposite one."""
    return Impulses(
        times_s=np.concatenate((begins_s + side.times_s, back_s + side.times_s)),
        amplitudes=np.concatenate((side.amplitudes, -side.amplitudes)),
    )


def square_of(side: Impulses, side_s: float) -> tuple[Impulses, Impulses]:
    """Return the commands of x and y of a square whose sides begin at a distance in time."""
    return there_and_back(side, 0.0, 2 * side_s), there_and_back(side, side_s, 3 * side_s)


Seen = tuple[FloatArray, FloatArray]
"""Deflection of the payload at times, linear and nonlinear, each of shape (n,) [cm]."""


def seen_on_square(side: Impulses, side_s: float, times_s: FloatArray) -> Seen:
    """Return how far the payload is from below the trolley."""
    x, y = square_of(side, side_s)
    parts = [motion(PLANT, DRIVE, one, SPEED_M_S, times_s).deflection_m for one in (x, y)]
    hook_m = played(x, y, LENGTH_M, times_s).hook_m
    return CM * np.hypot(*parts), CM * np.hypot(hook_m[:, 0], hook_m[:, 1])


def left_of_square(side: Impulses, side_s: float) -> tuple[float, float]:
    """Return the largest deflection in a period after the square, linear and nonlinear [cm]."""
    rest_s = 3 * side_s + side.duration_s + REST_S
    period = np.linspace(rest_s, rest_s + PLANT.mode.period_s, 401)
    linear, nonlinear = seen_on_square(side, side_s, period)
    return float(linear.max()), float(nonlinear.max())


def square() -> Iterator[Part]:
    """Tell the square of 42 cm (chapter 4 of [K]) by the shapers of chapter 3."""
    sides = {"unshaped": over_side(pulse)} | {move: over_side(make) for move, make in MOVES.items()}
    clock = np.linspace(0.0, 4 * SIDE_S + REST_S, 1901)
    told = list(head(
        "move", "a side takes [s]", "model", "largest on the way [cm]", "left [cm]",
        "most left, sides every 4 to 6 s [cm]", "of UMZV2 [%]",
    ))  # fmt: skip
    drawn = {move: seen_on_square(side, SIDE_S, clock) for move, side in sides.items()}
    over_s = np.linspace(SIDE_S, 6.0, 21).tolist()
    left = {
        move: np.array([left_of_square(side, side_s) for side_s in over_s])
        for move, side in sides.items()
    }
    for move, side in sides.items():
        for index, model in enumerate(("linear", "nonlinear")):
            largest = left[move][:, index].max()
            told.append(row(
                move, side.duration_s, model, float(drawn[move][index].max()),
                float(left[move][0, index]), float(largest),
                f"{100 * largest / left['UMZV2'][:, index].max():.1f}",
            ))  # fmt: skip
    shown = {move: drawn[move] for move in ("unshaped", "UMZV2", "NUMZV2", "NUMZVD2")}
    yield "experiment-square", square_sheet(clock, shown), told


def square_sheet(clock: FloatArray, shown: dict[str, Seen]) -> Figure:
    """Draw the deflection on the square over time: a row a move, linear beside nonlinear."""
    with house_style():
        figure = Sheet(figsize=(7.0, 5.4))
        grid = figure.subplots(len(shown), 2, sharex=True, sharey=True)
        for line, (move, both) in zip(grid, shown.items(), strict=True):
            for axes, values, model in zip(line, both, ("linear", "nonlinear"), strict=True):
                axes.plot(clock, values, color=STROKES[0][0], linewidth=1.2)
                axes.set_title(f"{move}, {model}")
            line[0].set_ylabel("[cm]")
        for axes in grid[-1]:
            axes.set(xlabel="time [s]", xlim=(clock[0], clock[-1]), ylim=(0, None))
        figure.suptitle(
            "Deflection of the payload, square of 42 cm, a side every 4 s", x=0.07, ha="left",
            fontsize=12, weight="bold",
        )  # fmt: skip
        figure.subplots_adjust(
            left=0.07, right=0.98, bottom=0.08, top=0.89, wspace=0.06, hspace=0.4
        )
    return figure


def main(arguments: Sequence[str]) -> None:
    """Tell all, and write the pictures where a folder is given."""
    folder = Path(arguments[0]) if arguments else None
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    for part in (lengths, pulses, stops, square):
        for name, figure, told in part():
            if folder is not None and figure is not None:
                (folder / f"{name}.png").write_bytes(figure_bytes(figure, "png"))
            sys.stdout.write("\n".join((f"{name}:", *told, "\n")))


if __name__ == "__main__":
    main(sys.argv[1:])
