"""The panels of frequency: vector diagram at the nominal one, sensitivity around it."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, MultipleLocator

from design.actuators import Actuator
from design.analysis.certificate import LIMITS
from design.analysis.sensitivity import Sensitivity
from design.impulses import Impulses
from design.pictures.style import (
    BRIGHT,
    DEEP,
    GREY,
    INK,
    SMALL_PT,
    WASH,
    legend_above,
    name_panel,
    percent,
)
from design.plants import Mode
from design.types import ComplexArray

HEADROOM = 1.3
"""Height of the sensitivity panel over its curve's; the note is written above the curve [-]."""

BAND_TOP = 0.9
"""Height to which the band is shaded, below the note, as a share of the panel's [-]."""


def vibration_vectors(impulses: Impulses, mode: Mode, actuator: Actuator) -> ComplexArray:
    """Return what each impulse adds to the residual vibration.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive; superposed steps.

    Returns
    -------
    ComplexArray
        ``A_i G_i(s)/G_accel(s) exp(-s t_i) exp(-z w t_n)``, shape (n,) [-]. The real factor at the
        end measures them at the last impulse, so that the magnitude of their sum is the residual
        vibration of a damped mode too; times count from the first impulse, so that its vector is
        real.

    Examples
    --------
    >>> from design.actuators import Ideal
    >>> half_period = Impulses(times_s=np.array([0.0, np.pi]), amplitudes=np.array([0.5, 0.5]))
    >>> vectors = vibration_vectors(half_period, Mode(natural_frequency_rad_s=1.0), Ideal())
    >>> bool(abs(vectors.sum()) < 1e-15)
    True
    """
    pole = mode.pole_rad_s
    times = impulses.times_s - impulses.times_s[0]
    decel = actuator.accel_lag.denominator(pole) / actuator.decel_lag.denominator(pole)
    gains = np.where(impulses.accelerates, 1.0, decel)
    # One exponential of a difference: a strongly damped mode would overflow in exp(-s t_i).
    turns = np.exp(pole.real * (times[-1] - times) - 1j * pole.imag * times)
    vectors: ComplexArray = impulses.amplitudes * gains * turns
    return vectors


def draw_vectors(axes: Axes, impulses: Impulses, mode: Mode, actuator: Actuator) -> None:
    """Draw the vibration vectors head to tail: a shaper without vibration comes back to 0."""
    name_panel(axes, "vectors", "Vibration vectors, head to tail")
    vectors = vibration_vectors(impulses, mode, actuator)
    corners = np.concatenate(([0.0], np.cumsum(vectors)))
    axes.axhline(0, color=GREY, linewidth=0.7)
    axes.axvline(0, color=GREY, linewidth=0.7)
    # An invisible path under the arrows: they take no part in the limits of the axes.
    axes.plot(corners.real, corners.imag, linestyle="none", gid="corners")
    for number, accelerates in enumerate(impulses.accelerates.tolist(), start=1):
        tail, head = corners[number - 1], corners[number]
        colour = DEEP if accelerates else BRIGHT
        # Each lies over the next, whose tail would cover its tip.
        _draw_arrow(axes, tail, head, colour, zorder=3 - number / impulses.times_s.size)
        middle = (tail + head) / 2
        axes.text(
            middle.real,
            middle.imag,
            str(number),
            ha="center",
            va="center",
            fontsize=SMALL_PT,
            bbox={
                "boxstyle": "circle,pad=0.22",
                "facecolor": "white",
                "edgecolor": colour,
                "linewidth": 1.2,
            },
            zorder=4,
        )
    residual = abs(corners[-1])
    gap = corners[[0, -1]]
    if residual > LIMITS["residual"]:
        axes.plot(
            gap.real,
            gap.imag,
            "o-",
            color=INK,
            markerfacecolor="none",
            markersize=7,
            linewidth=1.4,
            zorder=5,
            gid="gap",
        )
    axes.plot(0, 0, "o", color=INK, markersize=5, zorder=5)
    note = (
        "closes: no residual vibration"
        if residual <= LIMITS["residual"]
        else f"open by the residual, {percent(residual)}"
    )
    _fit_square(axes, corners)
    axes.text(
        0.985,
        0.98,
        note,
        transform=axes.transAxes,
        ha="right",
        va="top",
        fontsize=SMALL_PT,
        bbox={"boxstyle": "square,pad=0.15", "facecolor": "white", "edgecolor": "none"},
    )
    axes.set_xlabel("real part [share of unshaped]")
    axes.set_ylabel("imaginary part [share of unshaped]")


def _draw_arrow(axes: Axes, tail: complex, head: complex, colour: str, zorder: float) -> None:
    axes.annotate(
        "",
        (head.real, head.imag),
        xytext=(tail.real, tail.imag),
        arrowprops={
            "arrowstyle": "-|>,head_length=0.55,head_width=0.24",
            "color": colour,
            "linewidth": 2.2,
            "shrinkA": 0,
            "shrinkB": 0,
            "joinstyle": "miter",
        },
        zorder=zorder,
    )


def _fit_square(axes: Axes, corners: ComplexArray) -> None:
    """Set equal scales and ticks, the polygon in the middle and room above it for the note."""
    width, height = axes.bbox.width, axes.bbox.height
    left, right = float(corners.real.min()), float(corners.real.max())
    low, high = float(corners.imag.min()), float(corners.imag.max())
    scale = 1.22 * max((right - left) / width, 1.12 * (high - low) / height)
    across, up = scale * width / 2, scale * height / 2
    middle = (low + high) / 2 + 0.1 * up
    axes.set_xlim((left + right) / 2 - across, (left + right) / 2 + across)
    axes.set_ylim(middle - up, middle + up)
    axes.set_aspect("equal", adjustable="box")
    ticks = MaxNLocator(nbins=6, steps=[1, 2, 5, 10]).tick_values(-across, across)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MultipleLocator(float(ticks[1] - ticks[0])))


def draw_sensitivity(axes: Axes, sensitivity: Sensitivity, nominal_residual: float) -> None:
    """Draw the residual over the frequency ratio, with the tolerance and its band."""
    name_panel(axes, "sensitivity", "Sensitivity")
    ratios, residuals = sensitivity.frequency_ratios, 100 * sensitivity.residuals
    axes.set_xlim(float(ratios[0]), float(ratios[-1]))
    axes.set_ylim(0, HEADROOM * max(float(residuals.max()), 1e-12))
    band = sensitivity.insensitivity
    if band is None:
        note = f"no insensitivity: nominal {percent(nominal_residual)} is above tolerance"
    else:
        edges = (band.lower_ratio, band.upper_ratio)
        note = f"insensitivity {edges[0]:.4f} to {edges[1]:.4f}, width {band.width:.4f}"
        axes.axvspan(*edges, ymax=BAND_TOP, color=WASH, linewidth=0, zorder=0.5, gid="band")
        for edge in edges:
            axes.axvline(edge, ymax=BAND_TOP, color=DEEP, linewidth=0.9, linestyle=(0, (1, 1.6)))
        axes.axhline(
            100 * band.tolerance,
            color=BRIGHT,
            linewidth=1.4,
            linestyle=(0, (5, 2)),
            label=f"tolerance {percent(band.tolerance)}",
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
