"""A fit on one page: the times over the fitted field, and the residual of the fitted times."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from design.analysis.warnings import DesignWarning
from design.curve_fit.fit_range import FitRange, plants_at_ends
from design.curve_fit.polynomials import Fit
from design.curve_fit.variable import axis_of_fit
from design.fields import name_in_words, unit_of
from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.pictures.head import HEAD_IN, TITLE_IN, Fact, note_of, write_head
from design.pictures.sheet import Sheet
from design.pictures.style import (
    BRIGHT,
    DEEP,
    GREY,
    INK,
    LIMIT,
    PALE,
    SMALL_PT,
    house_style,
    legend_above,
    name_panel,
    percent,
)
from design.pictures.words import actuator_in_words, frequency_hz, residual_in_words
from design.types import FloatArray

SIZE_IN = (10.0, 7.6)
"""Width and height [in]."""

BEYOND = 0.03
"""What is drawn on either side of the range, over it [-]."""

LABEL_PT = 11.0
"""Least distance of the names of two curves [pt]."""

FLOOR = 1e-12
"""Residuals below it are drawn alike, zero included [-]."""

DECADES = 1.5
"""Room above the highest residual or bound, for the words [decades]."""


def fit_sheet(
    name: str,
    plant: Plant,
    actuator: Actuator,
    wanted: FitRange,
    found: Fit,
    warnings: Sequence[DesignWarning],
    version: str,
) -> Figure:
    """Return the sheet of a fit.

    Parameters
    ----------
    name
        The shaper's kind, as the registry names it.
    plant, actuator
        What moves, and its drive.
    wanted
        The field, its range, and the bound of the residual where one was asked for.
    found
        The polynomials, n times.
    warnings
        What to know of them.
    version
        Of the program.

    Returns
    -------
    Figure
        10 x 7.6 in. Over the field in its own unit: the fitted time of each impulse upon the exact
        one [s], and the residual of the fitted times [%], with the largest and the bound asked for.
    """
    axis = axis_of_fit(plant, actuator, wanted)
    values = np.array([getattr(axis.plant_at(x), wanted.over) for x in found.checks.x.tolist()])
    unit = unit_of(wanted.over).replace("1", "-")
    with house_style():
        figure = Sheet(figsize=SIZE_IN)
        facts = _facts(plant, actuator, wanted, found)
        write_head(figure, name, version, facts, note_of(warnings))
        rows = figure.add_gridspec(
            2, 1, left=0.09, right=0.94, bottom=0.075, top=1 - (HEAD_IN + TITLE_IN) / SIZE_IN[1],
            hspace=0.22, height_ratios=(1.5, 1),
        )  # fmt: skip
        top = figure.add_subplot(rows[0])
        bottom = figure.add_subplot(rows[1], sharex=top)
        margin = BEYOND * (wanted.stop - wanted.start)
        top.set_xlim(wanted.start - margin, wanted.stop + margin)
        _draw_times(top, values, found)
        _draw_residual(bottom, values, found, wanted.max_residual)
        for axes in (top, bottom):
            for end, beyond in ((wanted.start, -margin), (wanted.stop, margin)):
                axes.axvspan(
                    end, end + beyond, color=PALE, linewidth=0, gid="not-served",
                    label="outside the range" if beyond < 0 else None,
                )  # fmt: skip
        legend_above(bottom)
        top.tick_params(labelbottom=False)
        bottom.set_xlabel(f"{name_in_words(wanted.over)} [{unit}]")
        figure.align_ylabels([top, bottom])
        return figure


def _facts(plant: Plant, actuator: Actuator, wanted: FitRange, found: Fit) -> list[Fact]:
    unit = unit_of(wanted.over)
    ends = f"{wanted.start:.4g} to {wanted.stop:.4g}" + ("" if unit == "1" else f" {unit}")
    hertz = sorted(frequency_hz(end.mode) for end in plants_at_ends(plant, wanted))
    told = f"{hertz[0]:.4g} Hz" if hertz[0] == hertz[1] else f"{hertz[0]:.4g} to {hertz[1]:.4g} Hz"
    bound = "" if wanted.max_residual is None else f"\nat most {percent(wanted.max_residual)} asked"
    return [
        Fact(name_in_words(wanted.over), ends, told),
        Fact("actuator", *actuator_in_words(actuator)),
        Fact("polynomials", f"degree {found.degree}", f"of {found.coefficients.shape[0]} times"),
        Fact(
            "largest residual",
            residual_in_words(found.worst_residual),
            f"at {found.checked_points} points{bound}",
        ),
        Fact("largest error", f"{found.worst_timing_error_s:.3g} s", "of a fitted time"),
    ]


def _draw_times(axes: Axes, values: FloatArray, found: Fit) -> None:
    name_panel(axes, "times", "Times of the impulses")
    checks = found.checks
    for number, amplitude in enumerate(checks.amplitudes.tolist(), start=1):
        fitted, exact = checks.times_s[:, number - 1], checks.exact_times_s[:, number - 1]
        axes.plot(values, exact, color=PALE, linewidth=5.0, zorder=1.5, gid=f"exact-{number}")
        axes.plot(
            values, fitted, color=DEEP if amplitude > 0 else BRIGHT,
            linestyle="-" if amplitude > 0 else (0, (5, 2)), gid=f"time-{number}",
        )  # fmt: skip
    lowest = float(min(checks.times_s.min(), checks.exact_times_s.min()))
    highest = float(max(checks.times_s.max(), checks.exact_times_s.max()))
    room = 0.06 * (highest - lowest)
    axes.set_ylim(lowest - room, highest + room)
    axes.set_ylabel("time [s]")
    _name_curves(axes, values, checks.times_s)
    entries = {
        "step up": Line2D([], [], color=DEEP),
        "step down": Line2D([], [], color=BRIGHT, linestyle=(0, (5, 2))),
        "exact": Line2D([], [], color=PALE, linewidth=5.0),
    }
    if (checks.amplitudes > 0).all():
        del entries["step down"]
    legend_above(axes, handles=entries)


def _name_curves(axes: Axes, values: FloatArray, times_s: FloatArray) -> None:
    """Write the name of each curve at its right end, apart from its neighbours."""
    last = int(np.argmax(values))
    low, high = axes.get_ylim()
    dots = float(axes.get_figure(root=True).dpi)  # type: ignore[union-attr]
    least = LABEL_PT / (float(axes.bbox.height) * 72.0 / dots) * (high - low)
    ends = times_s[last]
    places = spread(ends, least)
    right = axes.get_xlim()[1]
    for number, (end, place) in enumerate(zip(ends.tolist(), places.tolist(), strict=True), 1):
        axes.annotate(
            f"$t_{{{number}}}$", (right, end), xytext=(1.018, place),
            textcoords=("axes fraction", "data"), va="center", fontsize=SMALL_PT + 1,
            arrowprops={"arrowstyle": "-", "color": GREY, "linewidth": 0.6, "shrinkA": 0},
            annotation_clip=False,
        )  # fmt: skip


def spread(values: FloatArray, least: float) -> FloatArray:
    """Return places near values that keep a distance from each other.

    Parameters
    ----------
    values
        Shape (n,).
    least
        The distance.

    Returns
    -------
    FloatArray
        In the order of the values, their mean kept where values are too near each other.

    Examples
    --------
    >>> spread(np.array([0.0, 1.0, 1.0]), 0.5).tolist()
    [0.0, 0.75, 1.25]
    """
    order = np.argsort(values, kind="stable")
    groups: list[tuple[float, list[float]]] = []
    for value in values[order].tolist():
        members = [value]
        # A group that reaches into the one before it joins it.
        while groups and _first(members, least) < groups[-1][0] + least:
            members = groups.pop()[1] + members
        first = _first(members, least)
        groups.append((first + least * (len(members) - 1), members))
    placed = [
        _first(members, least) + least * number
        for _, members in groups
        for number in range(len(members))
    ]
    places = np.empty(values.size)
    places[order] = placed
    return places


def _first(members: list[float], least: float) -> float:
    return sum(members) / len(members) - least * (len(members) - 1) / 2


def _draw_residual(axes: Axes, values: FloatArray, found: Fit, bound: float | None) -> None:
    name_panel(axes, "residual", "Residual of the fitted times")
    drawn = 100 * np.maximum(found.checks.residuals, FLOOR)
    axes.plot(values, drawn, color=DEEP, gid="residual")
    worst = max(found.worst_residual, FLOOR)
    axes.axhline(
        100 * worst, color=INK, linewidth=1.0, linestyle=(0, (1, 1.6)),
        label=f"largest, {percent(found.worst_residual)}", gid="worst",
    )  # fmt: skip
    if bound is not None:
        axes.axhline(
            100 * bound, color=LIMIT, linewidth=1.4, linestyle=(0, (5, 2)),
            label=f"bound asked, {percent(bound)}", gid="bound",
        )  # fmt: skip
    axes.set_yscale("log")
    highest = 100 * max(worst, bound or 0.0)
    lowest = float(np.median(drawn)) / 10**DECADES
    axes.set_ylim(min(lowest, highest / 10**DECADES), highest * 10 ** (DECADES / 3))
    axes.set_ylabel("residual vibration [%]")
