"""Guaranteed band against duration, for every kind of shaper in the catalogue, printed and drawn.

The crane and actuator of the thesis (Kim 2011), superposed steps. The guaranteed band is the
largest half width h such that the residual is at most 5 % wherever the true frequency is within
1 - h and 1 + h of the nominal one. On the front are the shapers that no other beats in both. The
name of a file (.png, .svg or .html) draws it:

    python docs/examples/04_band_and_duration.py band.png
"""

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from design.analysis.insensitivity import insensitivity
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from design.pictures.files import figure_bytes
from design.pictures.style import (
    BRIGHT,
    DEEP,
    GREEN,
    GREY,
    INK,
    PALE,
    PURPLE,
    SMALL_PT,
    house_style,
)
from design.pipeline import Design, design
from design.shapers.numsi import UnityBandOptions
from design.shapers.registry import FOR_SEVERAL_MODES, NEGATIVE, SHAPERS, UNITY

TOLERANCE = 0.05
CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
ACTUATOR = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
)
HALF_WIDTHS = [0.01, 0.02, 0.028, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14, 0.16, 0.18, 0.186]
HALF_WIDTHS += [0.2, 0.22, 0.25, 0.28, 0.31, 0.335, 0.35, 0.38, 0.41, 0.44]

FAMILIES = {
    "unity, over a band: num_si": (DEEP, "."),
    "unity, for this actuator": (DEEP, "o"),
    "unity, for an ideal actuator": (BRIGHT, "s"),
    "negative, for an ideal actuator": (PURPLE, "D"),
    "positive": (GREEN, "^"),
}
"""Colour and mark of each family of shapers."""

PLACES = [
    (reach * across, reach * up)
    for reach in (7, 13, 20, 28)
    for across, up in ((1, 0.3), (1, -1), (-1, 1), (-1, -1), (0, 1.2), (0, -1.6))
]
"""Where a name may stand beside its mark, the best place first [pt]."""


FAR_PT = 16
"""A name farther from its mark than this is joined to it by a line [pt]."""


@dataclass(frozen=True)
class Row:
    """One shaper."""

    name: str
    family: str
    impulses: int
    duration_s: float
    half_width: float


def guaranteed_half_width(shaper: Impulses) -> float:
    """Return the half width of the centred band within the tolerance, 0 if there is none [-]."""
    found = insensitivity(shaper, CRANE.mode, ACTUATOR, TOLERANCE)
    if found is None:
        return 0.0
    below = 1.0 if found.lower_ratio is None else 1 - found.lower_ratio
    above = math.inf if found.upper_ratio is None else found.upper_ratio - 1
    return min(below, above)


def row_of(name: str, family: str, made: Design) -> Row:
    """Return the figures of a design."""
    shaper = made.impulses
    band = guaranteed_half_width(shaper)
    return Row(name, family, shaper.times_s.size, shaper.duration_s, band)


def rows() -> Iterator[Row]:
    """Yield each kind of the catalogue with its own parameters, then `num_si` for many bands."""
    for name, kind in SHAPERS.items():
        if name == "num_si" or kind.large_swings or ACTUATOR.kind not in kind.actuators:
            continue
        made = design(CRANE, ACTUATOR, kind)
        family = "positive"
        if kind in UNITY:
            family = f"unity, for {'an ideal' if made.for_ideal else 'this'} actuator"
        elif kind in NEGATIVE:
            family = "negative, for an ideal actuator"
        yield row_of(name, family, made)
    for half_width in HALF_WIDTHS:
        options = UnityBandOptions(half_width=half_width, tolerance=TOLERANCE)
        made = design(CRANE, ACTUATOR, SHAPERS["num_si"], options)
        yield row_of("num_si", "unity, over a band: num_si", made)


def front_of(every: list[Row]) -> list[Row]:
    """Return the shapers such that none is as fast over a band as wide, by duration."""
    front: list[Row] = []
    for row in sorted(every, key=lambda one: (one.duration_s, -one.half_width)):
        if row.half_width > max((one.half_width for one in front), default=0.0):
            front.append(row)
    return front


def picture(every: list[Row], front: list[Row]) -> Figure:
    """Draw the shapers by family, their front, and the names of those at one place once."""
    with house_style():
        figure = Figure(figsize=(9.6, 6.4))
        axes = figure.add_axes((0.075, 0.085, 0.9, 0.81))
        wall = [*front, Row("", "", 0, 4.1, front[-1].half_width)]
        axes.step(
            [row.duration_s for row in wall], [100 * row.half_width for row in wall],
            where="post", color=PALE, linewidth=6.0, zorder=1, label="front: no other beats both",
        )  # fmt: skip
        # For one mode the kinds for several are those that they are made of.
        several = {kind.name for kind in FOR_SEVERAL_MODES}
        drawn = [row for row in every if row.name not in several]
        for family, (colour, mark) in FAMILIES.items():
            chosen = [row for row in drawn if row.family == family]
            axes.plot(
                [row.duration_s for row in chosen], [100 * row.half_width for row in chosen],
                mark, color=colour, linestyle="-" if mark == "." else "none", linewidth=1.2,
                markersize=6, label=family, clip_on=False, zorder=3,
            )  # fmt: skip
        axes.set_xlim(0.25, 4.0)
        axes.set_ylim(-3.5, 52)
        axes.set_xlabel("duration [s]")
        axes.set_ylabel("guaranteed band [± % of the frequency]")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.1), handlelength=2.2)
        figure.suptitle(
            "How wide a band costs how long a shaper", x=0.075, y=0.975, ha="left", va="top",
            fontsize=12, weight="bold",
        )  # fmt: skip
        figure.text(
            0.075, 0.928, "residual of at most 5 % over the band; crane and actuator of Kim (2011)",
            color=GREY, fontsize=SMALL_PT + 0.5, va="top",
        )  # fmt: skip
        write_names(figure, axes, drawn)
        return figure


def write_names(figure: Figure, axes: Axes, every: list[Row]) -> None:
    """Write each name beside its mark, where it meets neither a mark nor another name."""
    taken: list[Bbox] = []
    for row in every:
        x, y = axes.transData.transform((row.duration_s, 100 * row.half_width))
        taken.append(Bbox.from_extents(x - 4, y - 4, x + 4, y + 4))
    for row in (row for row in every if row.name != "num_si"):
        at = (row.duration_s, 100 * row.half_width)
        for across, up in PLACES:
            side = "left" if across > 0 else "right" if across < 0 else "center"
            text = axes.annotate(
                row.name, at, (across, up), textcoords="offset points", ha=side, va="center",
                fontsize=SMALL_PT, color=INK, zorder=4,
            )  # fmt: skip
            box = text.get_window_extent().padded(figure.dpi / 72)
            inside = box.y0 > axes.bbox.y0 and box.x0 > axes.bbox.x0 and box.x1 < axes.bbox.x1
            if inside and not any(box.overlaps(other) for other in taken):
                taken.append(box)
                if max(abs(across), abs(up)) > FAR_PT:
                    axes.annotate(
                        "", at, (across, up), textcoords="offset points",
                        arrowprops={"arrowstyle": "-", "color": GREY, "linewidth": 0.6},
                    )  # fmt: skip
                break
            text.remove()


found = list(rows())
sys.stdout.write("shaper         impulses  duration [s]  guaranteed band\n")
for one in found:
    sys.stdout.write(
        f"{one.name:<16} {one.impulses:>6} {one.duration_s:>13.4f}   "
        f"+- {100 * one.half_width:5.2f} %\n"
    )
best = front_of(found)
told = ", ".join(f"{one.name} {one.duration_s:.4f} s" for one in best)
sys.stdout.write(f"\non the front: {told}\n")
if len(sys.argv) > 1:
    file = Path(sys.argv[1])
    image = {".svg": "svg", ".html": "html"}.get(file.suffix, "png")
    file.write_bytes(figure_bytes(picture(found, best), image))  # type: ignore[arg-type]
