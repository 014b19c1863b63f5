"""Figures 3-13 to 3-27 of Kim (2011), computed anew; draws them into the folder given.

The thesis designs for superposed steps (3.23-3.26) and plays them on one state (4.23-4.28): so does
this. docs/thesis-figures.md tells what reproduces.
"""

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
from matplotlib.figure import Figure

from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.fields import Axis
from design.maps.field_map import field_map
from design.maps.map_case import MapCase, Move, Quantity, Recipe
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.moves.parts import mirrored_stop
from design.moves.playback import motion
from design.pictures.curve_sheet import Curve, curve_sheet
from design.pictures.files import figure_bytes
from design.pictures.map_sheet import axis_label, panel_sheet
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.types import FloatArray

CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
SPEED_M_S = 0.2
CM = 100.0
Drawn = tuple[str, Figure, str]


def drive(w1: float = 20.0, w2: float = 50.0, z1: float = 0.8, z2: float = 1.5) -> SecondOrder:
    """Return the switched actuator of the thesis, of which it varies one number or two."""
    return SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=w1, damping_ratio=z1),
        decel=SecondOrderSet(natural_frequency_rad_s=w2, damping_ratio=z2),
        model="switched",
    )


def axis(field: str, first: float, last: float, points: int) -> Axis:
    """Return an even axis over a field."""
    return Axis(path=tuple(field.split("/")), values=np.linspace(first, last, points))


W1, W2 = "actuator/accel/natural_frequency_rad_s", "actuator/decel/natural_frequency_rad_s"
Z1, Z2 = "actuator/accel/damping_ratio", "actuator/decel/damping_ratio"
PULSE = "move/pulse_s"
INNER = {"natural_frequency_rad_s": 10.0, "damping_ratio": 0.5, "pulse_s": 0.0}
"""From where on the text of figs. 3-17 to 3-20 expects little of NUMZV: 10 rad/s; dampings not
near 0.3."""


def case(
    kind: str,
    actuator: SecondOrder,
    quantity: Quantity = "deflection_m",
    pulse_s: float | None = None,
    *,
    each: bool = True,
    stop: Literal["solved", "mirrored"] = "solved",
    settle: bool = False,
) -> MapCase:
    """Return a map of a shaper, or of the move that it starts and stops, as the thesis does it."""
    registered = SHAPERS[kind]
    options = registered.options(settle=True) if settle else registered.options()
    return MapCase(
        plant=CRANE,
        actuator=actuator,
        shaper=Recipe(kind=registered, options=options, each=each, designed_for="superposed"),
        move=None if pulse_s is None else Move(pulse_s=pulse_s, stop=stop),
        quantity=quantity,
        speed_m_s=SPEED_M_S if quantity == "deflection_m" else None,
    )


def compare(
    title: str, actuator: SecondOrder, x: Axis, y: Axis
) -> tuple[Figure, FloatArray, FloatArray]:
    """Map what moves by NUMZV, designed in each cell, and by UMZV leave [cm]."""
    moves = (case("numzv", actuator, pulse_s=3.0), case("umzv", actuator, pulse_s=3.0, each=False))
    # UMZV knows no actuator: designed once is designed anywhere.
    knowing, ignorant = (field_map(move, x, y).values[:, :, 0] for move in moves)
    panels = {"NUMZV, start and stop": knowing, "UMZV, start and stop": ignorant}
    return panel_sheet(title, x, y, panels, "deflection_m"), CM * knowing, CM * ignorant


def ranges() -> Iterator[Drawn]:
    """Draw figs. 3-13 to 3-15: where the shaper exists, and with how many whole periods."""
    for number, varied, actuator, fixed in (
        ("3-13", (axis(W1, 4, 60, 57), axis(W2, 4, 60, 57)), drive(z2=0.8), "both damping .8"),
        ("3-14", (axis(Z1, 0.3, 2, 52), axis(Z2, 0.3, 2, 52)), drive(w1=50), "both 50 rad/s"),
    ):
        x, y = varied
        gains = MapCase(plant=CRANE, actuator=actuator, quantity="alpha")
        alpha = field_map(gains, x, y).values[:, :, 0]
        off = float(np.abs(np.diagonal(alpha) - 1).max())
        told = f"alpha {alpha.min():.3f} to {alpha.max():.3f}; equal sets: 1, off by {off:.0e}"
        figure = panel_sheet(f"Gain ratio of the sets, {fixed}", x, y, {"": alpha}, "alpha")
        yield number, figure, told

    corners = (axis(W1, 1.5, 20, 22), axis(W2, 1.5, 20, 22))
    dampings = (0.5, 0.8, 1.0, 1.5)
    found = {
        f"both damping ratios {z:g}": field_map(
            case("numzv", replace(drive(z1=z, z2=z), model="superposed"), "branch", settle=True),
            *corners,
        ).values
        for z in dampings
    }
    for layer, letter in enumerate("nm"):
        panels = {name: values[:, :, layer] for name, values in found.items()}
        largest = max(float(np.nanmax(values)) for values in panels.values())
        none = [float(np.isnan(values).mean()) for values in panels.values()]
        fast = corners[0].values > 2 * CRANE.mode.natural_frequency_rad_s
        zero = [float((values[np.ix_(fast, fast)] == 0).mean()) for values in panels.values()]
        figure = panel_sheet(
            f"Whole periods {letter} of NUMZV, settled to 80 %", *corners, panels, "branch"
        )
        told = (
            f"{letter} up to {largest:.0f}; 0 on {100 * min(zero):.0f} to {100 * max(zero):.0f} % "
            f"beyond 2 w_n; none on {100 * min(none):.0f} to {100 * max(none):.0f} %"
        )
        yield f"3-15-{letter}", figure, told


def times() -> Iterator[Drawn]:
    """Draw figs. 3-16 and 3-24: times over the plant's frequency."""
    for number, kind, pulse_s, last in (
        ("3-16", "numzv", 3.0, 10.0),
        ("3-24", "numzvd", None, 4.0),
    ):
        over = axis("plant/natural_frequency_rad_s", 1.0, last, 61)
        of = replace(case(kind, drive(), "times_s", pulse_s), plant=Mode(natural_frequency_rad_s=1))
        found = field_map(of, over).values[0]
        curves = [
            Curve(f"$t_{impulse + 1}$", over.values, found[:, impulse])
            for impulse in range(1, found.shape[1])
        ]
        figure = curve_sheet(
            f"Times of {kind} over the plant's frequency", axis_label(over),
            "time of the impulse [s]", curves,
        )  # fmt: skip
        falling = bool(np.all(np.diff(found[:, 1:3], axis=0) < 0))
        last_s = found[:, -1]
        told = f"t2 and t3 fall throughout: {falling}; last {last_s[0]:.3f} to {last_s[-1]:.3f} s"
        yield number, figure, told


def residuals() -> Iterator[Drawn]:
    """Draw figs. 3-17 to 3-20: what NUMZV and UMZV leave over two numbers of drive and move."""
    pulses = axis(PULSE, 1.5, 4, 22)
    for number, title, actuator, x, y in (
        (
            "3-17",
            "ω₁ and pulse; ω₂ 50 rad/s, damping .8",
            drive(z2=0.8),
            axis(W1, 7, 40, 22),
            pulses,
        ),
        (
            "3-18",
            "ω₁ and ω₂; damping .8, pulse 3 s",
            drive(z2=0.8),
            axis(W1, 7, 50, 22),
            axis(W2, 7, 50, 22),
        ),
        (
            "3-19",
            "ζ₁ and pulse; 20 and 50 rad/s, ζ₂ .8",
            drive(z2=0.8),
            axis(Z1, 0.3, 2, 22),
            pulses,
        ),
        (
            "3-20",
            "ζ₁ and ζ₂; both 20 rad/s, pulse 3 s",
            drive(w2=20),
            axis(Z1, 0.3, 2, 22),
            axis(Z2, 0.3, 2, 22),
        ),
    ):
        figure, knowing, ignorant = compare(f"Residual over {title}", actuator, x, y)
        # Beyond the corner of the map where a set is slow or little damped.
        inner = np.ix_(y.values >= INNER[y.path[-1]], x.values >= INNER[x.path[-1]])
        told = "; ".join(
            f"{name} up to {values.max():.2f} cm, inside {values[inner].max():.3f}"
            for name, values in (("NUMZV", knowing), ("UMZV", ignorant))
        )
        yield number, figure, told


def robustness() -> Iterator[Drawn]:
    """Draw figs. 3-21, 3-22 and 3-27: errors of the cable's length, pulses, of the frequency."""
    lengths = axis("plant/cable_length_m", 0.4, 1.4, 201)
    pulses = axis(PULSE, 1.0, 4.0, 301)
    for number, x, title in (
        ("3-21", lengths, "Moves for 0.8 m of cable, at others; pulse 3 s"),
        ("3-22", pulses, "Moves over the pulse"),
    ):
        found = {
            f"{kind.upper()}2": CM
            * field_map(case(kind, drive(), pulse_s=3.0, each=False), x).values[0, :, 0]
            for kind in ("numzv", "umzv")
        }
        figure = curve_sheet(
            title, axis_label(x), "residual deflection [cm]",
            [Curve(name, x.values, values) for name, values in found.items()],
        )  # fmt: skip
        nominal = int(np.argmin(np.abs(x.values - (0.8 if x is lengths else 3.0))))
        told = "; ".join(
            f"{name} {values[nominal]:.3f} cm at the nominal, up to {values.max():.3f}, "
            f"least {values.min():.3f} at {x.values[values.argmin()]:.3g}"
            for name, values in found.items()
        )
        yield number, figure, told

    superposed = replace(drive(), model="superposed")
    zv = maneuver(CRANE, superposed, SHAPERS["numzv"], speed_m_s=SPEED_M_S, pulse_s=2.5).command
    start = design(CRANE, superposed, SHAPERS["numzvd"]).impulses
    stop = mirrored_stop(start)
    zvd = Impulses(
        times_s=np.concatenate((start.times_s, 2.5 + stop.times_s)),
        amplitudes=np.concatenate((start.amplitudes, stop.amplitudes)),
    )
    curves, widths = [], []
    for name, command in (("NUMZV2", zv), ("NUMZVD2, mirrored stop", zvd)):
        curve = sensitivity(command, CRANE.mode, drive(), SensitivityRange(points=401))
        curves.append(Curve(name, curve.frequency_ratios, 100 * curve.residuals))
        width = None if curve.insensitivity is None else curve.insensitivity.width
        widths.append(f"{name} 5 % width {width or 0.0:.4f}")
    figure = curve_sheet(
        "Whole moves off the frequency; pulse 2.5 s", "true over nominal frequency [-]",
        "residual vibration [%]", curves, level=5,
    )  # fmt: skip
    yield "3-27", figure, "; ".join(widths)
    yield from motions(start, zvd)


def motions(start: Impulses, whole: Impulses) -> Iterator[Drawn]:
    """Draw figs. 3-25 and 3-26: the payload after NUMZVD, and the velocities of NUMZVD2."""
    clock = np.linspace(-0.1, 6, 1500)
    step = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
    played = {
        name: motion(CRANE, drive(), command, SPEED_M_S, clock)
        for name, command in (("NUMZVD", start), ("unshaped", step))
    }
    figure = curve_sheet(
        "Payload of a step to 0.2 m/s", "time [s]", "deflection [cm]",
        [Curve(name, clock, CM * one.deflection_m) for name, one in played.items()],
    )  # fmt: skip
    peaks = {name: CM * one.peak.deflection_m for name, one in played.items()}
    left = CM * (played["NUMZVD"].remaining.deflection_m if played["NUMZVD"].remaining else 0.0)
    yield "3-25", figure, (
        f"peak {peaks['NUMZVD']:.2f} cm, unshaped {peaks['unshaped']:.2f}; leaves {left:.3f} cm"
    )  # fmt: skip
    moved = motion(CRANE, drive(), whole, SPEED_M_S, clock)
    figure = curve_sheet(
        "Velocities of NUMZVD2, pulse 2.5 s", "time [s]", "velocity [m/s]",
        [Curve("actuator", clock, moved.velocity_m_s), Curve("command", clock, moved.command_m_s)],
    )  # fmt: skip
    yield "3-26", figure, f"ten steps, the last at {whole.times_s[-1]:.4f} s"


def main() -> None:
    """Compute all, tell what they show, and write them where a folder is given."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    for part in (ranges, times, residuals, robustness):
        for number, figure, told in part():
            if folder is not None:
                (folder / f"{number}.png").write_bytes(figure_bytes(figure, "png"))
            sys.stdout.write(f"{number:<7} {told}\n")


if __name__ == "__main__":
    main()
