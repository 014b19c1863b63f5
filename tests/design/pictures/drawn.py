"""What the tests of pictures ask of a figure: its panels, lines and words."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text

from design.types import FloatArray


def panel(figure: Figure, name: str) -> Axes:
    """Return the panel of a name."""
    return next(axes for axes in figure.axes if axes.get_label() == name)


def lines(axes: Axes, gid: str) -> list[Line2D]:
    """Return the lines of a panel whose id begins so."""
    return [one for one in axes.lines if str(one.get_gid() or "").startswith(gid)]


def points(line: Line2D) -> tuple[FloatArray, FloatArray]:
    """Return the points of a line."""
    across, up = line.get_xdata(), line.get_ydata()
    return np.asarray(across, dtype=np.float64), np.asarray(up, dtype=np.float64)


def line(figure: Figure, name: str, gid: str) -> tuple[FloatArray, FloatArray]:
    """Return the points of the one line of an id in a panel."""
    (found,) = [one for one in panel(figure, name).lines if one.get_gid() == gid]
    return points(found)


def texts(figure: Figure) -> Iterator[Text]:
    """Every text but the tick labels, of which matplotlib keeps some that it does not show."""
    every = [one for axes in figure.axes for one in (axes, *axes.child_axes)]
    every_axis = [axis for axes in every for axis in (axes.xaxis, axes.yaxis)]
    ticks = {text for axis in every_axis for text in axis.findobj(Text) if text != axis.label}
    for text in figure.findobj(Text):
        if isinstance(text, Text) and text.get_text() and text not in ticks:
            yield text


def words(figure: Figure) -> str:
    """Return all words of a figure, tick labels left out."""
    return " ".join(" ".join(text.get_text() for text in texts(figure)).split())


def collisions(figure: Figure) -> list[tuple[str, ...]]:
    """Return the texts that meet one another, and those that leave the page."""
    figure.draw_without_rendering()
    boxes = [(text.get_text(), text.get_window_extent()) for text in texts(figure)]
    met = [
        (one, other)
        for (one, first), (other, second) in combinations(boxes, 2)
        if first.overlaps(second)
    ]
    page = figure.bbox
    gone = [
        (text,)
        for text, box in boxes
        if box.x0 < page.x0 or box.x1 > page.x1 or box.y0 < page.y0 or box.y1 > page.y1
    ]
    return [*met, *gone]
