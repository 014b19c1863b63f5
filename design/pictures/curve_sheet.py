"""Curves over one axis as a picture."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from design.pictures.style import GREY, STROKES, house_style
from design.types import FloatArray

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
    title: str, x_label: str, y_label: str, curves: Sequence[Curve], *, level: float | None = None
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

    Returns
    -------
    Figure
        One panel.
    """
    with house_style():
        figure = Figure(figsize=(7.2, 4.6))
        axes = figure.add_axes((0.11, 0.125, 0.85, 0.73))
        for number, curve in enumerate(curves):
            colour, dashes = STROKES[number % len(STROKES)]
            axes.plot(curve.x, curve.y, color=colour, linestyle=dashes, label=curve.name or None)
        if level is not None:
            axes.axhline(level, color=GREY, linewidth=1.0, linestyle=(0, (2, 2)))
            axes.annotate(
                f"{level:g}", (1.0, level), xycoords=("axes fraction", "data"), xytext=(3, 0),
                textcoords="offset points", ha="left", va="center", color=GREY,
            )  # fmt: skip
        values = np.concatenate([curve.y[np.isfinite(curve.y)] for curve in curves])
        if values.size and values.min() >= 0:
            axes.set_ylim(0, max(HEADROOM * max(float(values.max()), level or 0.0), 1e-12))
        ends = [curve.x[end] for curve in curves for end in (0, -1)]
        if min(ends) < max(ends):
            axes.set_xlim(min(ends), max(ends))
        axes.set_xlabel(x_label)
        axes.set_ylabel(y_label)
        figure.suptitle(title, x=0.11, y=0.97, ha="left", va="top", fontsize=12, weight="bold")
        if any(curve.name for curve in curves):
            axes.legend(
                loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, borderaxespad=0.2,
                handlelength=2.4, columnspacing=1.4,
            )  # fmt: skip
        return figure
