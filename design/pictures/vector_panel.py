"""The panel of vectors: what each impulse adds to the residual vibration, head to tail."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, MultipleLocator

from design.analysis.terms import terms_of_residual
from design.claims import ZERO_LIMITS
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.reference_ramps import reference
from design.pictures.style import BRIGHT, DEEP, GREY, INK, SMALL_PT, name_panel, percent
from design.types import ComplexArray

LABEL_SPACING = 0.08
"""Least distance of the vectors' numbers, as a share of the polygon's extent [-]."""


def vibration_vectors(impulses: Impulses, mode: Mode, actuator: Actuator) -> ComplexArray:
    """Return what each change of the reference adds to the residual.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive.

    Returns
    -------
    ComplexArray
        ``A_i G_i(s)/G_accel(s) exp(-s t_i) exp(-z w t_e)``, shape (n,) [-]; with what a switched
        actuator's state passes on from set to set, or a ramp's share of a step. The real factor at
        the end measures them at the end of the reference, so that the magnitude of their sum is the
        residual vibration of a damped mode too; times count from the first impulse, so that its
        vector is real.

    Examples
    --------
    >>> from design.model.actuators.ideal import Ideal
    >>> half_period = Impulses(times_s=np.array([0.0, np.pi]), amplitudes=np.array([0.5, 0.5]))
    >>> vectors = vibration_vectors(half_period, Mode(natural_frequency_rad_s=1.0), Ideal())
    >>> bool(abs(vectors.sum()) < 1e-15)
    True
    """
    return terms_of_residual(impulses, mode.pole_rad_s, actuator)


def draw_vectors(axes: Axes, impulses: Impulses, mode: Mode, actuator: Actuator) -> None:
    """Draw the vibration vectors head to tail.

    The chain of a shaper without vibration comes back to 0.

    Parameters
    ----------
    axes
        An empty panel.
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive.
    """
    name_panel(axes, "vectors", "Vibration vectors, head to tail")
    vectors = vibration_vectors(impulses, mode, actuator)
    corners = np.concatenate(([0.0], np.cumsum(vectors)))
    axes.axhline(0, color=GREY, linewidth=0.7)
    axes.axvline(0, color=GREY, linewidth=0.7)
    # An invisible path under the arrows: they take no part in the limits of the axes.
    axes.plot(corners.real, corners.imag, linestyle="none", gid="corners")
    places: list[complex] = []
    apart = LABEL_SPACING * max(float(np.ptp(corners.real)), float(np.ptp(corners.imag)))
    changes = reference(impulses, actuator).accelerates
    for number, accelerates in enumerate(changes.tolist(), start=1):
        tail, head = corners[number - 1], corners[number]
        colour = DEEP if accelerates else BRIGHT
        # Each lies over the next, whose tail would cover its tip.
        _draw_arrow(axes, tail, head, colour, zorder=3 - number / vectors.size)
        place = _free_place(tail, head, places, apart)
        places.append(place)
        axes.text(
            place.real,
            place.imag,
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
    if residual > ZERO_LIMITS["residual"]:
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
        if residual <= ZERO_LIMITS["residual"]
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


def _free_place(tail: complex, head: complex, taken: list[complex], apart: float) -> complex:
    """Return the place for an arrow's number: its middle, or beside it if that is taken."""
    places = [tail + share * (head - tail) for share in (0.5, 0.36, 0.64, 0.22, 0.78)]
    free = (place for place in places if all(abs(place - other) > apart for other in taken))
    return next(free, places[0])


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
