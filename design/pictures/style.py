"""What all pictures share: colours, type sizes, and the panel they are drawn in."""

import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.axes import Axes

INK = "#1b1f24"
GREY = "#646b75"
PALE = "#d5dae1"
DEEP = "#0b4f8a"
"""Blue, as dark in grey print as the text."""
BRIGHT = "#dd7a00"
"""Orange, half as dark in grey print; never distinguished from blue by colour alone."""
GREEN = "#3f9a8a"
WASH = "#dbe8f4"
PURPLE = "#8a4f9e"
PROVEN = "#1c6e5c"
"""Green of what is proven, dark enough for small type."""
AMBER = "#a85500"
AMBER_WASH = "#fdeccf"
"""Of what is not proven for the drive at hand: type, and the ground behind it."""

LIMIT = "#b3261e"
"""Red of what must not be passed: a tolerance, a bound, a longest time."""

Dashes = str | tuple[int, tuple[float, ...]]

STROKES: tuple[tuple[str, Dashes], ...] = (
    (DEEP, "-"),
    (BRIGHT, (0, (5, 2))),
    (INK, (0, (1, 1.4))),
    (GREY, (0, (7, 2, 1.5, 2))),
    (GREEN, "-"),
    (PURPLE, (0, (3, 1.2))),
)
"""Colour and dashes of each curve: distinct in grey print too."""

SMALL_PT = 8.0
"""Type size of notes and tick labels [pt]."""

_RC: dict[Any, Any] = {
    "font.size": 9.0,
    "text.color": INK,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlepad": 7.0,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#edf0f3",
    "grid.linewidth": 0.8,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelsize": SMALL_PT,
    "ytick.labelsize": SMALL_PT,
    "lines.linewidth": 1.8,
    "lines.solid_capstyle": "round",
    "legend.fontsize": SMALL_PT,
    "legend.frameon": False,
    "savefig.dpi": 150,
    # Outlines look the same wherever they are opened; the salt makes the ids of SVG repeatable.
    "svg.fonttype": "path",
    "svg.hashsalt": "shapersmith",
}

_ONE_AT_A_TIME = threading.RLock()


@contextmanager
def house_style() -> Iterator[None]:
    """Draw in the house's style, whatever the user's matplotlibrc says.

    Matplotlib's settings belong to the whole process, and it promises nothing to threads: one
    picture at a time.
    """
    with _ONE_AT_A_TIME, mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_RC)
        yield


def name_panel(axes: Axes, name: str, title: str) -> None:
    """Give a panel its name (label and SVG id) and its title, top left.

    Parameters
    ----------
    axes
        The panel.
    name
        Label and SVG id.
    title
        Text at the top left.
    """
    axes.set_label(name)
    axes.set_gid(name)
    axes.set_title(title)


def legend_above(axes: Axes, columns: int = 3, handles: Mapping[str, Artist] | None = None) -> None:
    """Put the legend on the line of the title, where no curve meets it.

    It stands to the right.

    Parameters
    ----------
    axes
        The panel.
    columns
        Entries to a row.
    handles
        Entries by name; those of the panel if not given.
    """
    entries = {} if handles is None else {"handles": [*handles.values()], "labels": [*handles]}
    axes.legend(
        **entries,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=columns,
        borderpad=0.2,
        borderaxespad=0.15,
        handlelength=1.9,
        handletextpad=0.5,
        columnspacing=1.2,
    )


def percent(share: float) -> str:
    """Return a share as a percentage of three digits.

    Parameters
    ----------
    share
        Share [-].

    Returns
    -------
    str
        Of three digits.

    Examples
    --------
    >>> percent(0.02449)
    '2.45 %'
    >>> percent(1e-9)
    '1e-7 %'
    """
    return f"{100 * share:.3g} %".replace("e-0", "e-")
