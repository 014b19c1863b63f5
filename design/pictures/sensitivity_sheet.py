"""The sensitivity of any impulses on one page: over frequency, and over damping where asked."""

from collections.abc import Sequence
from itertools import cycle

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from design.analysis.ramp_figures import moving_time_s
from design.analysis.sensitivity import Sensitivity
from design.analysis.warnings import DesignWarning
from design.analysis.worst_mode import worst_of
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.pictures.head import HEAD_IN, TITLE_IN, Fact, note_of, write_head
from design.pictures.sensitivity_panel import HEADROOM, add_hertz, draw_sensitivity
from design.pictures.sheet import Sheet
from design.pictures.style import (
    INK,
    LIMIT,
    STROKES,
    house_style,
    legend_above,
    name_panel,
    percent,
)
from design.pictures.words import (
    actuator_in_words,
    modes_in_words,
    plant_in_words,
    residual_in_words,
)

HEIGHT_IN, WIDTH_IN, WIDER_IN = 6.2, 10.2, 12.8
"""Height of the page, its width, and its width with a panel of damping [in]."""

BOTTOM_IN = 0.98
"""Room below the panels, for two axes of frequency [in]."""


def sensitivity_sheet(
    plant: Plant,
    actuator: Actuator,
    impulses: Impulses,
    curves: Sequence[Sensitivity],
    residuals: Sequence[float],
    warnings: Sequence[DesignWarning],
    version: str,
) -> Figure:
    """Return the sheet of a sensitivity.

    Parameters
    ----------
    plant, actuator
        What moves, and its drive.
    impulses
        The command.
    curves
        Its sensitivity in each mode of the plant.
    residuals
        Its residual in each mode [-].
    warnings
        What to know of it.
    version
        Of the program.

    Returns
    -------
    Figure
        The residual in each mode [%] over the frequency ratio [-] and the frequency [Hz], with the
        tolerance and the band within it. With a curve over the damping ratio, that beside it.
    """
    worst = worst_of(curves)
    columns = 1 if worst.damping is None else 2
    width = (WIDTH_IN, WIDER_IN)[columns - 1]
    bottom, top = BOTTOM_IN / HEIGHT_IN, 1 - (HEAD_IN + TITLE_IN) / HEIGHT_IN
    names = modes_in_words(plant.modes)
    with house_style():
        figure = Sheet(figsize=(width, HEIGHT_IN))
        facts = _facts(plant, actuator, impulses, worst, residuals)
        write_head(figure, "sensitivity", version, facts, note_of(warnings))
        panels = figure.add_gridspec(
            1, columns, left=0.75 / width, right=1 - 0.33 / width, bottom=bottom, top=top,
            wspace=0.2, width_ratios=(3, 2)[:columns],
        )  # fmt: skip
        axes = figure.add_subplot(panels[0])
        draw_sensitivity(axes, curves, residuals, names)
        add_hertz(axes, plant.modes, (top - bottom) * HEIGHT_IN)
        if worst.damping is not None:
            _draw_damping(figure.add_subplot(panels[1]), plant, curves, residuals, worst.tolerance)
        return figure


def _facts(
    plant: Plant,
    actuator: Actuator,
    impulses: Impulses,
    worst: Sensitivity,
    residuals: Sequence[float],
) -> list[Fact]:
    count = impulses.times_s.size
    band = worst.insensitivity
    width = "none" if band is None or band.width is None else f"{band.width:.4f}"
    edges = "nominal above tolerance"
    if band is not None:
        ends = (band.lower_ratio, band.upper_ratio)
        edges = " to ".join("no edge" if end is None else f"{end:.4f}" for end in ends)
    return [
        Fact("plant", *plant_in_words(plant)),
        Fact("actuator", *actuator_in_words(actuator)),
        Fact(
            "command",
            f"{count} impulse{'s' if count > 1 else ''}",
            f"{moving_time_s(impulses, actuator):.4g} s",
        ),
        Fact("residual", residual_in_words(max(residuals)), "at the nominal plant"),
        Fact(f"width at {percent(worst.tolerance)}", width, edges),
    ]


def _draw_damping(
    axes: Axes,
    plant: Plant,
    curves: Sequence[Sensitivity],
    residuals: Sequence[float],
    tolerance: float,
) -> None:
    """Draw the residual over the damping ratio, at the natural frequency as given."""
    name_panel(axes, "damping", "Over damping")
    highest = tolerance
    for number, (curve, (colour, dashes)) in enumerate(zip(curves, cycle(STROKES))):
        if curve.damping is None:
            continue
        ratios, over_damping = curve.damping
        axes.plot(
            ratios, 100 * over_damping, color=colour, linestyle=dashes,
            gid="damping" if len(curves) == 1 else f"damping-{number}",
        )  # fmt: skip
        axes.set_xlim(float(ratios[0]), float(ratios[-1]))
        highest = max(highest, float(over_damping.max()))
        nominal = plant.modes[number].damping_ratio
        if ratios[0] <= nominal <= ratios[-1]:
            axes.plot(
                nominal, 100 * residuals[number], "o", color=INK, markersize=5, clip_on=False,
                linestyle="none", label="nominal" if number == 0 else None, zorder=4,
            )  # fmt: skip
            highest = max(highest, residuals[number])
    axes.axhline(
        100 * tolerance, color=LIMIT, linewidth=1.4, linestyle=(0, (5, 2)),
        label=f"tolerance {percent(tolerance)}", zorder=1.9,
    )  # fmt: skip
    axes.set_ylim(0, 100 * HEADROOM * highest)
    axes.set_xlabel("damping ratio [-]")
    axes.set_ylabel("residual vibration [%]")
    legend_above(axes)
