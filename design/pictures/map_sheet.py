"""A map as a picture: colours over two fields, curves over one."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, LogNorm, Normalize
from matplotlib.figure import Figure

from design.fields import Axis, unit_of
from design.maps.map_case import Map, MapCase, Quantity
from design.pictures.curve_sheet import LINE_IN, Curve, curve_sheet, write_subtitle
from design.pictures.map_words import (
    axis_in_words,
    design_point,
    subtitle_of,
    title_of,
    worst_of_drives,
)
from design.pictures.sheet import Sheet
from design.pictures.style import INK, SMALL_PT, house_style
from design.types import FloatArray

MIN_DRAWN = 0.01
"""Residuals below it are drawn alike [%]."""

TOLERANCE = 0.05
"""The residual usually allowed, at which a line is drawn [-]."""

MIN_REACH = 0.01
"""Least that the colours of a gain ratio reach to either side of 1 [-]."""

DECADES = 3
"""How far down the colours of a deflection reach below the largest [-]."""

MAX_PER_LOWEST_LINE = 20
"""Lines of equal deflection are drawn down to this share of the largest; then colours do [-]."""

LEVELS = 6
"""About how many lines of equal value are drawn on an even scale."""


@dataclass(frozen=True, slots=True)
class Look:
    """How a quantity is drawn.

    Attributes
    ----------
    label
        Its name with its unit.
    unit
        What its values are multiplied by for that.
    levels
        Lines of equal value, in that unit; none for even ones.
    heavy
        The one of them that is drawn heavier.
    colours, ink
        Name of matplotlib's colour map, and the colour of the lines upon it.
    """

    label: str
    unit: float = 1.0
    levels: tuple[float, ...] = ()
    heavy: float | None = None
    colours: str = "cividis"
    ink: str = "white"


LOOKS: dict[Quantity, Look] = {
    "residual": Look(
        "residual vibration [%]", 100.0, (1.0, 100 * TOLERANCE, 20.0), 100 * TOLERANCE
    ),
    "deflection_m": Look(
        "residual deflection of the payload [cm]",
        100.0,
        tuple(digit * 10.0**power for power in range(-4, 5) for digit in (1, 5)),
    ),
    "times_s": Look("time of the impulse [s]"),
    "duration_s": Look("first to last impulse [s]"),
    "branch": Look("whole periods"),
    "alpha": Look(
        "α = |G_decel / G_accel| [-]",
        1.0,
        (0.25, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 1, 1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2, 4),
        1,
        "PuOr_r",
        INK,
    ),
    "beta_rad": Look("β, phase lag of G_decel / G_accel [rad]"),
}

TITLE_IN = 0.22
"""From the top of the page to its title [in]."""

BRANCH_NAMES = ("n, added to the second impulse", "m, added to the third", "sign of the branch")


def map_sheet(case: MapCase, x: Axis, y: Axis | None, found: Map) -> Figure:
    """Draw a map: a panel, or without y a curve, for each of its layers.

    A residual has lines at 1, 5 and 20 %, that at 5 % heavier. The plant as given is marked.

    Parameters
    ----------
    case
        What is mapped.
    x, y
        The axes; without y, curves over x.
    found
        The map, of shape (len(y), len(x), k).

    Returns
    -------
    Figure
        A panel for each layer; not a number is left blank.
    """
    look = LOOKS[found.quantity]
    names = _layer_names(found)
    layers = [found.values[:, :, layer] for layer in range(found.values.shape[2])]
    if found.quantity == "times_s":
        names, layers = names[1:], layers[1:]  # the first is at 0
    point = design_point(case, x, y)
    title = title_of(case, found.quantity)
    subtitle = subtitle_of(case, found.quantity, marked=point is not None)
    subtitle += worst_of_drives(case, found, x, y)
    if y is None:
        curves = [
            Curve(name, x.values, look.unit * layer[0])
            for name, layer in zip(names, layers, strict=True)
        ]
        level = 100 * TOLERANCE if found.quantity == "residual" else None
        return curve_sheet(
            title, axis_label(x), look.label, curves, level=level,
            subtitle=subtitle, point=None if point is None else point[0],
        )  # fmt: skip
    panels = dict(zip(names, layers, strict=True))
    return panel_sheet(title, x, y, panels, found.quantity, subtitle=subtitle, point=point)


def panel_sheet(
    title: str,
    x: Axis,
    y: Axis,
    panels: dict[str, FloatArray],
    quantity: Quantity,
    *,
    subtitle: Sequence[str] = (),
    point: tuple[float, float] | None = None,
) -> Figure:
    """Draw maps of one quantity side by side, in the same colours.

    All are over the same fields.

    Parameters
    ----------
    title
        Above all.
    x, y
        The axes.
    panels
        By title, values of shape (len(y), len(x)), in the quantity's own unit; not a number is
        left blank.
    quantity
        The quantity of the map.
    subtitle
        Lines below the title.
    point
        A place on the axes that is marked; None for none.

    Returns
    -------
    Figure
        One panel, or two to a row.
    """
    look = LOOKS[quantity]
    shown = {name: look.unit * values for name, values in panels.items()}
    columns = 1 if len(shown) == 1 else 2
    rows = -(-len(shown) // columns)
    with house_style():
        tall = 5.6 if rows == 1 else 4.4 * rows
        figure = Sheet(figsize=(7.2 if columns == 1 else 10.6, tall + LINE_IN * len(subtitle)))
        inches = float(figure.get_figheight())
        head = (0.9 if any(shown) else 0.6) + LINE_IN * len(subtitle)
        grid = figure.add_gridspec(
            rows, columns, left=0.1 if columns == 1 else 0.07, right=0.86 if columns == 1 else 0.9,
            bottom=0.62 / inches, top=1 - head / inches, wspace=0.12, hspace=0.26,
        )  # fmt: skip
        norm = _norm(quantity, list(shown.values()))
        # On a logarithmic scale the smallest are drawn alike, zero included.
        floor = (norm.vmin or 0.0) if isinstance(norm, LogNorm) else -np.inf
        mesh = None
        for number, (name, values) in enumerate(shown.items()):
            place = grid[number // columns, number % columns]
            axes = figure.add_subplot(place)
            mesh = axes.pcolormesh(
                x.values, y.values, np.ma.masked_invalid(np.maximum(values, floor)),
                norm=norm, cmap=look.colours, shading="nearest", rasterized=True,
            )  # fmt: skip
            axes.grid(visible=False)
            _draw_levels(axes, x, y, values, _levels(quantity, norm), look)
            _scale(axes, x, y)
            if point is not None:
                mark_point(axes, point)
            axes.set_title(name)
            if number + columns >= len(shown):
                axes.set_xlabel(axis_label(x))
            if number % columns == 0:
                axes.set_ylabel(axis_label(y))
        figure.suptitle(
            title, x=0.1 if columns == 1 else 0.07, y=1 - TITLE_IN / inches, ha="left", va="top",
            fontsize=12, weight="bold",
        )  # fmt: skip
        write_subtitle(figure, subtitle, 0.1 if columns == 1 else 0.07, TITLE_IN)
        if mesh is not None:
            _draw_scale(figure, mesh, look, norm, columns, head)
        return figure


def _layer_names(found: Map) -> list[str]:
    if found.quantity == "branch":
        return list(BRANCH_NAMES)
    if found.quantity == "times_s":
        return [f"$t_{{{number + 1}}}$" for number in range(found.values.shape[2])]
    return [""]


def mark_point(axes: Axes, point: tuple[float, float]) -> None:
    """Mark plant and actuator as given, on light ground and on dark.

    Parameters
    ----------
    axes
        The panel of a map.
    point
        Its place on the axes.
    """
    for colour, width in (("white", 4.6), (INK, 2.2)):
        axes.plot(
            *point, "+", color=colour, markersize=13, markeredgewidth=width, clip_on=False,
            zorder=6, gid="as-given",
        )  # fmt: skip


def _norm(quantity: Quantity, shown: Sequence[FloatArray]) -> Normalize:
    """Return the scale of colours that all panels share."""
    if quantity == "residual":
        return LogNorm(vmin=MIN_DRAWN, vmax=100)
    finite = np.concatenate([values[np.isfinite(values)] for values in shown])
    if finite.size == 0:
        return Normalize(0, 1)
    lowest, highest = float(finite.min()), float(finite.max())
    if quantity == "branch":
        return BoundaryNorm(np.arange(lowest - 0.5, highest + 1), 256)
    if quantity == "deflection_m" and highest > 0:
        return LogNorm(vmin=highest / 10**DECADES, vmax=highest)
    if quantity == "alpha":
        # As far to either side of 1, where the sets are alike.
        reach = max(highest - 1, 1 - lowest, MIN_REACH)
        return Normalize(1 - reach, 1 + reach)
    return Normalize(lowest, highest if highest > lowest else lowest + 1)


def _levels(quantity: Quantity, norm: Normalize) -> list[float]:
    if quantity == "branch":
        return []
    levels = LOOKS[quantity].levels
    if quantity == "deflection_m":
        return [level for level in levels if level > (norm.vmax or 0.0) / MAX_PER_LOWEST_LINE]
    if levels:
        return list(levels)
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    lowest, highest = norm.vmin or 0.0, norm.vmax or 1.0
    return [float(level) for level in MaxNLocator(LEVELS).tick_values(lowest, highest)]


def _draw_levels(
    axes: Axes, x: Axis, y: Axis, values: FloatArray, levels: Sequence[float], look: Look
) -> None:
    """Draw lines of equal value, one of them heavier."""
    finite = values[np.isfinite(values)]
    inside = [one for one in levels if finite.size and finite.min() < one < finite.max()]
    if not inside or min(values.shape) == 1:
        return
    heavier = [1.8 if level == look.heavy else 0.9 for level in inside]
    lines = axes.contour(
        x.values, y.values, np.ma.masked_invalid(values), levels=inside, colors=look.ink,
        linewidths=heavier, negative_linestyles="solid",
    )  # fmt: skip
    axes.clabel(lines, fmt="%g", fontsize=SMALL_PT)


def _scale(axes: Axes, x: Axis, y: Axis) -> None:
    """Make an axis logarithmic where its values are evenly spaced so."""
    for axis, scale in ((x, axes.set_xscale), (y, axes.set_yscale)):
        if axis.values.size > 2 and axis.values[0] > 0:  # noqa: PLR2004 - two are evenly spaced
            ratios = axis.values[1:] / axis.values[:-1]
            if np.allclose(ratios, ratios[0]) and ratios[0] != 1:
                scale("log")


def _draw_scale(
    figure: Figure, mesh: ScalarMappable, look: Look, norm: Normalize, columns: int, head: float
) -> None:
    inches = float(figure.get_figheight())
    left = 0.885 if columns == 1 else 0.915
    height = 1 - (head + 0.62) / inches
    bar = figure.add_axes((left, 0.62 / inches, 0.024 if columns == 1 else 0.016, height))
    beyond: Literal["both", "neither"] = "both" if isinstance(norm, LogNorm) else "neither"
    drawn = figure.colorbar(mesh, cax=bar, label=look.label, extend=beyond)
    bar.grid(visible=False)
    if isinstance(norm, BoundaryNorm):
        edges = np.asarray(norm.boundaries)
        drawn.set_ticks([*((edges[:-1] + edges[1:]) / 2)])
        drawn.ax.minorticks_off()
        drawn.ax.set_yticklabels([f"{edge + 0.5:g}" for edge in edges[:-1]])
    if isinstance(norm, LogNorm):
        drawn.ax.yaxis.set_major_formatter("{x:g}")
        if look.heavy is not None:
            bar.axhline(look.heavy, color=look.ink, linewidth=1.8)
    drawn.outline.set_edgecolor(INK)


def axis_label(axis: Axis) -> str:
    """Name a field in words, its unit in brackets."""
    words = axis_in_words(axis)
    words = "pulse duration" if words == "pulse" else words
    unit = unit_of(axis.path[-1])
    return f"{words} [{'-' if unit == '1' else unit.replace('^2', '²')}]"
