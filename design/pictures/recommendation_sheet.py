"""A recommendation on one page: the best shapers over the band asked, and how long all take."""

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.fields import name_in_words
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.pictures.head import HEAD_IN, TITLE_IN, Fact, write_head
from design.pictures.sensitivity_panel import add_hertz
from design.pictures.sheet import Sheet
from design.pictures.style import (
    GREY,
    INK,
    LIMIT,
    PALE,
    SMALL_PT,
    STROKES,
    WASH,
    house_style,
    name_panel,
    percent,
)
from design.pictures.words import actuator_in_words, plant_in_words
from design.recommendations.judging import Candidate
from design.recommendations.recommendation import Recommendation
from design.recommendations.requirements import Question
from design.types import FloatArray

WIDTH_IN, MIN_HEIGHT_IN = 13.0, 6.6
"""Width of the page, and its least height [in]."""

BAR_IN, BOTTOM_IN = 0.235, 0.98
"""Height of a bar with its gap, and room below the panels [in]."""

BARS = (5.3, 0.3)
"""Width of the panel of bars with their names, and the margin on its right [in]."""

CURVES = (0.75, 0.5)
"""Margin on the left of the panel of curves, and the gap on its right [in]."""

LEGEND_DOWN_IN = 0.5
"""From the axis of durations down to its legend [in]."""

MEETS = "#b4bcc8"
"""Colour of shapers that meet all and are not among the best."""

CHARACTER_IN = 0.068
"""Width of a character of the small type, on average at most [in]."""

BEST = 4
"""Shapers whose curves are drawn [-]."""

MAX_BARS = 24
"""Bars, at most: the rest is counted [-]."""

BESIDE_BAND = (0.6, 0.1)
"""What is drawn on either side of the band: over its width, and at least [-]."""

LEAST_RATIO = 0.02
"""Where a curve begins at the lowest [-]."""

POINTS = 401

TOP = 4.0
"""Height of the panel over the tolerance: outside the band curves leave it [-]."""


def recommendation_sheet(
    plant: Plant, actuator: Actuator, found: Recommendation, version: str
) -> Figure:
    """Return the sheet of a recommendation.

    Parameters
    ----------
    plant, actuator
        What moves, and its drive.
    found
        All shapers, ranked.
    version
        Of the program.

    Returns
    -------
    Figure
        Left, over the frequency ratio [-] and the frequency [Hz]: the largest residual of the best
        four in any mode, and at the ends of the damping range [%], the band and the tolerance
        asked. Right: how long each shaper takes [s], those that miss a requirement as outlines.
    """
    shown, left_out = bars_of(found)
    height = max(MIN_HEIGHT_IN, HEAD_IN + TITLE_IN + BOTTOM_IN + BAR_IN * (len(shown) + 1))
    bottom, top = BOTTOM_IN / height, 1 - (HEAD_IN + TITLE_IN) / height
    with house_style():
        figure = Sheet(figsize=(WIDTH_IN, height))
        name = found.recommended.name
        write_head(figure, name, version, _facts(plant, actuator, found), found.why[0])
        wide = WIDTH_IN - sum(CURVES) - sum(BARS)
        left = figure.add_axes((CURVES[0] / WIDTH_IN, bottom, wide / WIDTH_IN, top - bottom))
        _draw_curves(left, found)
        add_hertz(left, found.question.nominal, (top - bottom) * height)
        width = BARS[0] - max(len(_names_of(found, one)) for one in shown) * CHARACTER_IN
        right = figure.add_axes((
            1 - (width + BARS[1]) / WIDTH_IN,
            bottom,
            width / WIDTH_IN,
            top - bottom,
        ))
        _draw_bars(right, found, shown, width)
        if right.get_legend_handles_labels()[0]:
            down = -LEGEND_DOWN_IN / ((top - bottom) * height)
            right.legend(loc="upper left", bbox_to_anchor=(0.0, down), ncols=2, borderaxespad=0.0)
        if left_out:
            right.text(
                1.0, 1.01, f"{left_out} more not drawn", transform=right.transAxes, ha="right",
                va="bottom", fontsize=SMALL_PT, color=GREY,
            )  # fmt: skip
        return figure


def best_of(found: Recommendation) -> list[Candidate]:
    """Return the shapers whose curves are drawn: none of them twice."""
    return [one for one in found.candidates if one.same_as is None][:BEST]


def bars_of(found: Recommendation) -> tuple[list[Candidate], int]:
    """Return the shapers that have a bar, and how many have none.

    Fastest first. Where there are too many, those that meet all are kept.
    """
    meeting = [one for one in found.candidates if one.same_as is None]
    others = [one for one in found.others if one.same_as is None]
    shown = [*meeting, *others][:MAX_BARS]
    left_out = len(meeting) + len(others) - len(shown)
    return sorted(shown, key=lambda one: one.end_s), left_out


def worst_curve(
    impulses: Impulses, question: Question, ratios: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Return the largest residual over the frequency ratio.

    Parameters
    ----------
    impulses
        The shaper.
    question
        The modes, their drive, and the range of their damping.
    ratios
        First and last ratio of the nominal frequencies [-].

    Returns
    -------
    tuple of FloatArray
        Ratios, and the largest residual of any mode, at either end of the damping range and in its
        middle, shape (m,) each [-].
    """
    wanted = SensitivityRange(
        from_ratio=ratios[0],
        to_ratio=ratios[1],
        points=POINTS,
        tolerance=question.requirements.tolerance,
    )
    curves = [sensitivity(impulses, mode, question.actuator, wanted) for mode in _may_be(question)]
    return curves[0].frequency_ratios, np.max([curve.residuals for curve in curves], axis=0)


def _names_of(found: Recommendation, one: Candidate) -> str:
    """Return the name of a shaper, and of others whose impulses are the same."""
    every = (*found.candidates, *found.others)
    return ", ".join([one.name, *(other.name for other in every if other.same_as == one.name)])


def _may_be(question: Question) -> list[Mode]:
    """Return the modes at the ends of the damping range and in its middle."""
    damping = question.requirements.damping
    if damping is None:
        return list(question.nominal)
    (mode,) = question.nominal
    ratios = sorted({damping[0], mode.damping_ratio, damping[1]})
    return [replace(mode, damping_ratio=ratio) for ratio in ratios]


def _facts(plant: Plant, actuator: Actuator, found: Recommendation) -> list[Fact]:
    question, best = found.question, found.recommended
    asked = question.requirements
    also = f"residual at most {percent(asked.tolerance)}"
    if asked.damping is not None:
        also += f"\ndamping ratio {asked.damping[0]:.3g} to {asked.damping[1]:.3g}"
    if asked.drive_off_by is not None:
        also += f"\ndrive off by {percent(asked.drive_off_by)}"
    longest = max(mode.period_s for mode in question.nominal)
    return [
        Fact("plant", *plant_in_words(plant)),
        Fact("actuator", *actuator_in_words(actuator)),
        Fact("band asked", f"{question.band[0]:.4g} to {question.band[1]:.4g}", also),
        Fact("takes", f"{best.end_s:.4g} s", f"{best.end_s / longest:.3f} periods"),
        Fact("residual at most", percent(best.designed.largest), "over all that is asked"),
    ]


def _draw_curves(axes: Axes, found: Recommendation) -> None:
    question = found.question
    name_panel(axes, "curves", _title(question))
    low, high = question.band
    pad = max(BESIDE_BAND[0] * (high - low), BESIDE_BAND[1])
    ratios = (max(low - pad, min(LEAST_RATIO, low)), high + pad)
    tolerance = question.requirements.tolerance
    highest = tolerance
    for candidate, (colour, dashes) in zip(best_of(found), STROKES, strict=False):
        across, residuals = worst_curve(candidate.impulses, question, ratios)
        axes.plot(
            across, 100 * residuals, color=colour, linestyle=dashes,
            label=f"{candidate.name}, {candidate.end_s:.4g} s", gid=f"curve-{candidate.name}",
        )  # fmt: skip
        highest = max(highest, float(residuals.max()))
    axes.axvspan(low, high, color=WASH, linewidth=0, zorder=0.5, gid="band", label="band asked")
    axes.axhline(
        100 * tolerance, color=LIMIT, linewidth=1.4, linestyle=(0, (5, 2)),
        label=f"tolerance {percent(tolerance)}", gid="tolerance",
    )  # fmt: skip
    axes.set_xlim(*ratios)
    axes.set_ylim(0, 100 * max(min(TOP * tolerance, 1.6 * highest), 1.6 * tolerance))
    axes.set_xlabel("true over nominal frequency [-]")
    axes.set_ylabel("residual vibration [%]")
    # Within the band all curves are below the tolerance: there is room above it.
    place = ((low + high) / 2 - ratios[0]) / (ratios[1] - ratios[0])
    axes.legend(
        loc="upper center", bbox_to_anchor=(place, 0.99), handlelength=2.6, frameon=True,
        facecolor="white", edgecolor="none", framealpha=0.9, borderaxespad=0.0,
    )  # fmt: skip


def _title(question: Question) -> str:
    damping = question.requirements.damping
    if damping is not None:
        return f"Largest residual at damping {damping[0]:.3g} to {damping[1]:.3g}"
    return "Largest residual of any mode" if len(question.nominal) > 1 else "Residual"


def _draw_bars(axes: Axes, found: Recommendation, shown: list[Candidate], width: float) -> None:
    name_panel(axes, "durations", "How long each takes")
    strokes = {one.name: STROKES[place][0] for place, one in enumerate(best_of(found))}
    words = [_bar_in_words(one) for one in shown]
    room = [width - CHARACTER_IN * (len(word) + 1) for word in words]
    scale = min(
        (space / one.end_s for space, one in zip(room, shown, strict=True) if one.end_s > 0),
        default=1.0,
    )
    most = found.question.requirements.max_duration_s
    longest = width / scale if scale > 0 else max(one.end_s for one in shown)
    for place, (one, word) in enumerate(zip(shown, words, strict=True)):
        meets = not one.missed
        axes.barh(
            place, one.end_s, height=0.62, gid=f"bar-{one.name}",
            color=strokes.get(one.name, MEETS) if meets else "white",
            edgecolor=GREY if not meets else "none", linewidth=0.9,
        )  # fmt: skip
        axes.annotate(
            word, (one.end_s, place), xytext=(4, 0), textcoords="offset points", va="center",
            fontsize=SMALL_PT, color=INK if meets else GREY,
            bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"},
        )  # fmt: skip
        bound = one.designed.lower_bound_s
        if bound is not None:
            axes.plot(
                [bound, bound], [place - 0.42, place + 0.42], color=INK, linewidth=1.6,
                gid=f"bound-{one.name}", solid_capstyle="butt",
            )  # fmt: skip
    if any(one.designed.lower_bound_s is not None for one in shown):
        axes.plot([], [], color=INK, linewidth=1.6, label="none of its class is faster: proven")
    if most is not None and most <= longest:
        axes.axvline(
            most, color=LIMIT, linewidth=1.4, linestyle=(0, (5, 2)), zorder=0.9,
            label=f"longest asked, {most:.4g} s", gid="longest",
        )  # fmt: skip
    axes.set_yticks(range(len(shown)), [_names_of(found, one) for one in shown])
    axes.tick_params(axis="y", colors=INK, length=0)
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.set_xlim(0, longest)
    axes.grid(visible=False, axis="y")
    axes.spines["left"].set_edgecolor(PALE)
    axes.set_xlabel("from the first step until the last step or ramp ends [s]")


def _bar_in_words(one: Candidate) -> str:
    missed = ", ".join(name_in_words(name) for name in one.missed)
    return f"{one.end_s:.4g} s" + (f", misses {missed}" if missed else "")
