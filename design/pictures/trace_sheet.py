"""The search for one design on one page: what was tried, and what became of it."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from design.pictures.sheet import Sheet
from design.pictures.style import BRIGHT, DEEP, GREY, INK, PALE, SMALL_PT, house_style, name_panel
from design.trace import TraceStep

WIDTH_IN = 11.0
HEAD_IN = 1.6
ROW_IN = 0.24
MIN_HEIGHT_IN = 5.0
"""Size of the page, and of a row of it [in]."""

MAX_ROWS = 40
"""Steps that are drawn: of more, the first half of these and the last [-]."""

MAX_NOTE_CHARACTERS = 80
"""Characters of an outcome that are written [-]."""

COLOURS = {
    "verified": DEEP,
    "solve_succeeded": DEEP,
    "sharpened": DEEP,
    "proved": DEEP,
    "rejected": BRIGHT,
    "failed": BRIGHT,
    "infeasible": BRIGHT,
    "lost": BRIGHT,
}
"""Colour of an outcome; any other is grey."""

MIN_MISS = 1e-17
"""Misses are drawn from here on: zero has no logarithm [-]."""


def trace_sheet(name: str, trace: Sequence[TraceStep]) -> Figure:
    """Return the sheet of one search.

    Parameters
    ----------
    name
        The shaper's kind, as the registry names it.
    trace
        Steps of the search, in order.

    Returns
    -------
    Figure
        11 in wide, as high as its rows. Left: a row a step, with the duration of the command that
        it ended with [s] and its outcome. Right: by how much the equations were off, iteration by
        iteration, of the solves that report it.
    """
    rows = list(enumerate(trace, start=1))
    left_out = max(len(rows) - MAX_ROWS, 0)
    if left_out:
        rows = [*rows[: MAX_ROWS // 2], *rows[-(MAX_ROWS // 2) :]]
    height = max(HEAD_IN + ROW_IN * len(rows), MIN_HEIGHT_IN)
    with house_style():
        figure = Sheet(figsize=(WIDTH_IN, height))
        figure.text(0.018, 1 - 0.45 / height, f"{name}: the search", fontsize=16.0, weight="bold")
        note = f"{len(trace)} steps" + (f", {left_out} in the middle not drawn" if left_out else "")
        figure.text(0.018, 1 - 0.72 / height, note, fontsize=SMALL_PT, color=GREY)
        bottom, top = 0.55 / height, 1 - 1.15 / height
        steps, misses = figure.subplots(
            1,
            2,
            width_ratios=(2.1, 1),
            gridspec_kw={
                "left": 0.24, "right": 0.982, "bottom": bottom, "top": top, "wspace": 0.2,
            },
        )  # fmt: skip
        _draw_steps(steps, rows)
        _draw_misses(misses, rows)
        return figure


def _draw_steps(axes: Axes, rows: list[tuple[int, TraceStep]]) -> None:
    name_panel(axes, "steps", "Steps, and the duration each ended with")
    places = list(range(len(rows)))
    for place, (_, step) in zip(places, rows, strict=True):
        colour = COLOURS.get(step.outcome, PALE)
        axes.barh(place, step.duration_s or 0.0, height=0.62, color=colour)
        words = step.outcome.replace("_", " ") + (f": {step.detail}" if step.detail else "")
        axes.annotate(
            words if len(words) <= MAX_NOTE_CHARACTERS else f"{words[:MAX_NOTE_CHARACTERS]}…",
            (0.0, place),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=SMALL_PT - 1,
            color="white" if colour is DEEP and step.duration_s else INK,
        )
    axes.set_yticks(places, [f"{_label(step)}  {number}" for number, step in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlim(left=0.0)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("duration [s]")


def _label(step: TraceStep) -> str:
    return f"{step.stage}  {step.method}  {step.start}".replace("_", " ")


def _draw_misses(axes: Axes, rows: list[tuple[int, TraceStep]]) -> None:
    name_panel(axes, "misses", "Equations off by")
    told = [(number, step) for number, step in rows if step.misses]
    for number, step in told:
        found = [max(miss, MIN_MISS) for miss in step.misses]
        done = step.outcome == "solve_succeeded"
        axes.plot(found, marker="o", markersize=3, color=DEEP if done else BRIGHT, linewidth=1.0)
        axes.annotate(
            str(number), (len(found) - 1, found[-1]), xytext=(4, 2), textcoords="offset points",
            fontsize=SMALL_PT, color=INK,
        )  # fmt: skip
    if not told:
        axes.text(0.5, 0.5, "no solver reported any", transform=axes.transAxes, ha="center",
                  fontsize=SMALL_PT, color=GREY)  # fmt: skip
        axes.set_xticks([])
        axes.set_yticks([])
        return
    axes.set_yscale("log")
    axes.set_ylim(MIN_MISS / 3, max(axes.get_ylim()[1], 1.0))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("iteration")
