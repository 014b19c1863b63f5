"""The panel of sensitivity: how the residual grows off the nominal frequency."""

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from design.analysis.insensitivity import Insensitivity
from design.analysis.sensitivity import Sensitivity
from design.analysis.worst_mode import worst_of
from design.model.plants.mode import Mode
from design.pictures.style import (
    DEEP,
    INK,
    LIMIT,
    SMALL_PT,
    STROKES,
    WASH,
    legend_above,
    name_panel,
    percent,
)
from design.pictures.words import frequency_hz
from design.types import FloatArray

HEADROOM = 1.3
"""Height of the panel over its curves'; the note is written above them [-]."""

ROW = 0.085
"""Height of a row of the modes' legend, below the note, as a share of the panel's [-]."""

BAND_TOP = 0.9
"""Height to which the band is shaded, below the note, as a share of the panel's [-]."""

HERTZ_DOWN_IN = 0.47
"""From the axis of ratios down to that of hertz [in]."""

MODES_IN_ROW = 3
"""Modes in a row of the legend [-]."""


def draw_sensitivity(
    axes: Axes,
    curves: Sequence[Sensitivity],
    residuals: Sequence[float],
    names: Sequence[str] | None = None,
) -> None:
    """Draw the residual over the frequency ratio, in each mode.

    The tolerance is drawn as well, and the band common to all modes.

    Parameters
    ----------
    axes
        An empty panel.
    curves
        One a mode, over the same ratios.
    residuals
        Residual of each at the nominal frequency [-].
    names
        Of the modes, for the legend; their numbers if not given.
    """
    name_panel(axes, "sensitivity", "Sensitivity")
    worst = worst_of(curves)
    ratios, tolerance = worst.frequency_ratios, worst.tolerance
    rows = -(-len(curves) // MODES_IN_ROW) if len(curves) > 1 else 0
    top = BAND_TOP - ROW * rows
    highest = 100 * max(float(worst.residuals.max()), tolerance, *residuals)
    axes.set_xlim(float(ratios[0]), float(ratios[-1]))
    axes.set_ylim(0, max(highest, 1e-12) * HEADROOM * BAND_TOP / top)
    note = _describe(worst.insensitivity, max(residuals))
    if worst.insensitivity is not None:
        _shade_band(axes, worst.insensitivity, top)
    axes.axhline(
        100 * tolerance, color=LIMIT, linewidth=1.4, linestyle=(0, (5, 2)),
        label=f"tolerance {percent(tolerance)}", gid="tolerance",
    )  # fmt: skip
    lines: list[Line2D] = []
    for number, (curve, (colour, dashes)) in enumerate(zip(curves, cycle(STROKES))):
        lines += axes.plot(
            ratios,
            100 * curve.residuals,
            color=colour,
            linestyle=dashes,
            gid="residual" if len(curves) == 1 else f"residual-{number}",
        )
    if ratios[0] <= 1 <= ratios[-1]:
        axes.plot(
            [1.0] * len(residuals), [100 * one for one in residuals], "o", color=INK, markersize=5,
            clip_on=False, linestyle="none", label="nominal", gid="nominal",
        )  # fmt: skip
    axes.text(0.5, 0.985, note, transform=axes.transAxes, ha="center", va="top", fontsize=SMALL_PT)
    axes.set_xlabel("true over nominal frequency [-]")
    axes.set_ylabel("residual vibration [%]")
    legend_above(axes)
    if rows:
        above = axes.get_legend()
        axes.legend(
            lines, names or [f"mode {number}" for number in range(len(lines))],
            loc="upper center", bbox_to_anchor=(0.5, 0.925), ncols=MODES_IN_ROW, borderaxespad=0.0,
            borderpad=0.2, handlelength=2.4, columnspacing=1.2,
        )  # fmt: skip
        if above is not None:
            axes.add_artist(above)


def _shade_band(axes: Axes, band: Insensitivity, top: float) -> None:
    within = (band.searched_from_ratio, band.searched_to_ratio)
    axes.axvspan(*within, ymax=top, color=WASH, linewidth=0, zorder=0.5, gid="band")
    for edge in (band.lower_ratio, band.upper_ratio):
        if edge is not None:
            axes.axvline(edge, ymax=top, color=DEEP, linewidth=0.9, linestyle=(0, (1, 1.6)))


def _describe(band: Insensitivity | None, nominal_residual: float) -> str:
    """Return the band in words; an edge that was not found is called none."""
    if band is None:
        return f"no insensitivity: nominal {percent(nominal_residual)} is above tolerance"
    lowest, highest = band.searched_from_ratio, band.searched_to_ratio
    if band.width is not None:
        return f"insensitivity {lowest:.4f} to {highest:.4f}, width {band.width:.4f}"
    if band.upper_ratio is not None:
        return f"insensitivity up to {highest:.4f}, no lower edge down to {lowest:.3g} times"
    if band.lower_ratio is not None:
        return f"insensitivity from {lowest:.4f}, no upper edge up to {highest:.3g} times"
    return f"insensitivity: no edge from {lowest:.3g} to {highest:.3g} times"


def add_hertz(axes: Axes, modes: Sequence[Mode], height_in: float) -> None:
    """Add a second axis of frequency; of several modes, that of the slowest.

    Parameters
    ----------
    axes
        A panel over the frequency ratio.
    modes
        Of the plant.
    height_in
        Of the panel [in].
    """
    slowest = min(modes, key=lambda mode: mode.natural_frequency_rad_s)
    nominal_hz = frequency_hz(slowest)

    def to_hertz(ratios: ArrayLike) -> FloatArray:
        return np.asarray(ratios, dtype=np.float64) * nominal_hz

    def from_hertz(true_hz: ArrayLike) -> FloatArray:
        return np.asarray(true_hz, dtype=np.float64) / nominal_hz

    hertz = axes.secondary_xaxis(-HERTZ_DOWN_IN / height_in, functions=(to_hertz, from_hertz))
    hertz.set_label("hertz")
    of = f" of mode {modes.index(slowest)}" if len(modes) > 1 else ""
    hertz.set_xlabel(f"true frequency{of} [Hz]")
