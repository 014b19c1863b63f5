"""Curves over one axis as a picture."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from design.pictures.sheet import Sheet
from design.pictures.style import GREY, INK, SMALL_PT, STROKES, house_style
from design.types import FloatArray

HEIGHT_IN, BOTTOM_IN, HEAD_IN = 4.6, 0.575, 0.667
"""Height of the page without a subtitle, and the room below and above its panel [in]."""

TITLE_IN, SUBTITLE_IN, LINE_IN = 0.138, 0.26, 0.165
"""From the top of the page to its title, from there to the subtitle, and a line of it [in]."""

HEADROOM = 1.08
"""Height of the panel over that of the highest curve [-]."""


@dataclass(frozen=True, slots=True)
class Curve:
    """One curve.

    Attributes
    ----------
    name
        For the legend; empty for none.
    x, y
        Shape (n,); not a number interrupts it.
    """

    name: str
    x: FloatArray
    y: FloatArray


def curve_sheet(
    title: str,
    x_label: str,
    y_label: str,
    curves: Sequence[Curve],
    *,
    level: float | None = None,
    subtitle: Sequence[str] = (),
    point: float | None = None,
) -> Figure:
    """Draw curves over one axis, and a dashed level where given.

    Parameters
    ----------
    title
        Above the panel.
    x_label, y_label
        Of the axes, with units.
    curves
        One or more.
    level
        In the unit of y.
    subtitle
        Lines below the title.
    point
        A place on the axis that is marked by a line; None for none.

    Returns
    -------
    Figure
        One panel.
    """
    with house_style():
        height = HEIGHT_IN + LINE_IN * len(subtitle)
        figure = Sheet(figsize=(7.2, height))
        bottom, head = BOTTOM_IN / height, (height - HEIGHT_IN + HEAD_IN) / height
        axes = figure.add_axes((0.11, bottom, 0.85, 1 - bottom - head))
        for number, curve in enumerate(curves):
            colour, dashes = STROKES[number % len(STROKES)]
            axes.plot(curve.x, curve.y, color=colour, linestyle=dashes, label=curve.name or None)
        if level is not None:
            axes.axhline(level, color=GREY, linewidth=1.0, linestyle=(0, (2, 2)))
            axes.annotate(
                f"{level:g}", (1.0, level), xycoords=("axes fraction", "data"), xytext=(3, 0),
                textcoords="offset points", ha="left", va="center", color=GREY,
            )  # fmt: skip
        if point is not None:
            axes.axvline(point, color=INK, linewidth=1.0, linestyle=(0, (1, 1.6)), gid="as-given")
        values = np.concatenate([curve.y[np.isfinite(curve.y)] for curve in curves])
        if values.size and values.min() >= 0:
            axes.set_ylim(0, max(HEADROOM * max(float(values.max()), level or 0.0), 1e-12))
        ends = [curve.x[end] for curve in curves for end in (0, -1)]
        if min(ends) < max(ends):
            axes.set_xlim(min(ends), max(ends))
        axes.set_xlabel(x_label)
        axes.set_ylabel(y_label)
        figure.suptitle(
            title, x=0.11, y=1 - TITLE_IN / height, ha="left", va="top", fontsize=12, weight="bold"
        )
        write_subtitle(figure, subtitle, 0.11, TITLE_IN)
        if any(curve.name for curve in curves):
            axes.legend(
                loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, borderaxespad=0.2,
                handlelength=2.4, columnspacing=1.4,
            )  # fmt: skip
        return figure


def write_subtitle(figure: Figure, lines: Sequence[str], left: float, title_in: float) -> None:
    """Write lines below the title of a page.

    Parameters
    ----------
    figure
        The page.
    lines
        None or more.
    left
        Share of the page's width [-].
    title_in
        From the top of the page to the title [in].
    """
    height = float(figure.get_figheight())
    for row, line in enumerate(lines):
        figure.text(
            left, 1 - (title_in + SUBTITLE_IN + row * LINE_IN) / height, line, ha="left", va="top",
            fontsize=SMALL_PT + 0.5, color=GREY,
        )  # fmt: skip
