"""The report as a page of the documentation, with a picture of the ratios to peers."""

import os
import platform
import re
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from matplotlib.figure import Figure as Picture

from benchmarks.measure import Figure
from design.pictures.style import BRIGHT, DEEP, INK, SMALL_PT, house_style

DOCS = Path(__file__).parents[1] / "docs"

PAGE = """\
# Speed beside peers

Measured on {date}: {processor}, {count} processors, Python {python}.

Two things that are compared take turns in one run, and a ratio is the median of the rounds' ratios.
Absolute times vary by a third with the neighbours of a shared machine; ratios hardly vary.
`make bench` measures all of it anew. `python -m benchmarks --page` writes this page.

![Time of shapersmith over the time of a peer](pictures/figures.png)

The peers solve the same problem. Most of them prove nothing. The times of shapersmith have a
certificate in them, and a bound where the class has one.

| what | measured | limit | |
|---|---|---|---|
{rows}

What the figures are made of, and what the service withstands, is in `benchmarks/README.md`.
"""


def write_page(figures: Sequence[Figure]) -> None:
    """Write `docs/figures.md` and its picture.

    Parameters
    ----------
    figures
        All lines of the report.
    """
    beside_peers = [figure for figure in figures if figure.over_peer is not None]
    ratios_picture(beside_peers).savefig(DOCS / "pictures/figures.png")
    text = PAGE.format(
        date=datetime.now(UTC).date(),
        processor=_processor(),
        count=len(os.sched_getaffinity(0)),
        python=platform.python_version(),
        rows="\n".join(figure.row for figure in figures),
    )
    (DOCS / "figures.md").write_text(text)


def ratios_picture(figures: Sequence[Figure]) -> Picture:
    """Return a bar for each figure: our time over that of its peer, on a scale of powers.

    Parameters
    ----------
    figures
        Those with a peer.

    Returns
    -------
    matplotlib.figure.Figure
        9 in wide; the bars to the left of 1 are faster than the peer.
    """
    with house_style():
        picture = Picture(figsize=(9.0, 0.9 + 0.42 * len(figures)), layout="constrained")
        axes = picture.subplots()
        for place, figure in enumerate(figures):
            ratio = figure.over_peer or 0.0
            axes.plot(
                [1.0, ratio], [place, place], color=DEEP if ratio <= 1 else BRIGHT, linewidth=9
            )
            axes.annotate(
                f"{ratio:.2g}",
                (ratio, place),
                xytext=(-6 if ratio <= 1 else 6, 0),
                textcoords="offset points",
                ha="right" if ratio <= 1 else "left",
                va="center",
                fontsize=SMALL_PT,
            )
        axes.axvline(1.0, color=INK, linewidth=1.0)
        axes.set_xscale("log")
        axes.margins(x=0.12)
        axes.set_yticks(range(len(figures)), [_label(figure.what) for figure in figures])
        axes.invert_yaxis()
        axes.set_xlabel("time of shapersmith over time of the peer")
        axes.grid(visible=False, axis="y")
    return picture


def _label(what: str) -> str:
    """Return a name of two lines: what is measured, and its peer."""
    ours, _, peer = what.replace("`", "").partition(" / ")
    return f"{ours}\n/ {peer}" if peer else ours


def _processor() -> str:
    """Return the name of the processor, as Linux has it."""
    found = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    return found[1].strip() if found else platform.processor()
