"""The panel of sensitivity: how the residual grows off the nominal frequency."""

from matplotlib.axes import Axes

from design.analysis.insensitivity import Insensitivity
from design.analysis.sensitivity import Sensitivity
from design.pictures.style import (
    BRIGHT,
    DEEP,
    INK,
    SMALL_PT,
    WASH,
    legend_above,
    name_panel,
    percent,
)

HEADROOM = 1.3
"""Height of the sensitivity panel over its curve's; the note is written above the curve [-]."""

BAND_TOP = 0.9
"""Height to which the band is shaded, below the note, as a share of the panel's [-]."""


def draw_sensitivity(axes: Axes, sensitivity: Sensitivity, nominal_residual: float) -> None:
    """Draw the residual over the frequency ratio.

    The tolerance and its band are drawn as well.

    Parameters
    ----------
    axes
        An empty panel.
    sensitivity
        The curve.
    nominal_residual
        Residual at the nominal frequency [-].
    """
    name_panel(axes, "sensitivity", "Sensitivity")
    ratios, residuals = sensitivity.frequency_ratios, 100 * sensitivity.residuals
    axes.set_xlim(float(ratios[0]), float(ratios[-1]))
    axes.set_ylim(0, HEADROOM * max(float(residuals.max()), 1e-12))
    band = sensitivity.insensitivity
    if band is None:
        note = f"no insensitivity: nominal {percent(nominal_residual)} is above tolerance"
    else:
        within = (band.searched_from_ratio, band.searched_to_ratio)
        note = _describe_band(band)
        axes.axvspan(*within, ymax=BAND_TOP, color=WASH, linewidth=0, zorder=0.5, gid="band")
        for edge in (band.lower_ratio, band.upper_ratio):
            if edge is not None:
                dotted = (0, (1, 1.6))
                axes.axvline(edge, ymax=BAND_TOP, color=DEEP, linewidth=0.9, linestyle=dotted)
    axes.axhline(
        100 * sensitivity.tolerance,
        color=BRIGHT,
        linewidth=1.4,
        linestyle=(0, (5, 2)),
        label=f"tolerance {percent(sensitivity.tolerance)}",
        gid="tolerance",
    )
    axes.plot(ratios, residuals, color=DEEP, gid="residual")
    if ratios[0] <= 1 <= ratios[-1]:
        axes.plot(
            1,
            100 * nominal_residual,
            "o",
            color=INK,
            markersize=5,
            clip_on=False,
            linestyle="none",
            label="nominal",
        )
    axes.text(
        0.5,
        0.985,
        note,
        transform=axes.transAxes,
        ha="center",
        va="top",
        fontsize=SMALL_PT,
    )
    axes.set_xlabel("true over nominal frequency [-]")
    axes.set_ylabel("residual vibration [%]")
    legend_above(axes)


def _describe_band(band: Insensitivity) -> str:
    """Return the band in words; an edge that was not found is called none."""
    lowest, highest = band.searched_from_ratio, band.searched_to_ratio
    if band.width is not None:
        return f"insensitivity {lowest:.4f} to {highest:.4f}, width {band.width:.4f}"
    if band.upper_ratio is not None:
        return f"insensitivity up to {highest:.4f}, no lower edge down to {lowest:.3g} times"
    if band.lower_ratio is not None:
        return f"insensitivity from {lowest:.4f}, no upper edge up to {highest:.3g} times"
    return f"insensitivity: no edge from {lowest:.3g} to {highest:.3g} times"
