"""The panel of vectors: what each impulse adds to the residual vibration, head to tail."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, MultipleLocator

from design.analysis.terms import terms_of_residual
from design.claims import ZERO_LIMITS
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.reference_ramps import reference
from design.pictures.style import BRIGHT, DEEP, GREY, INK, PALE, SMALL_PT, name_panel, percent
from design.types import ComplexArray

LABEL_SPACING = 0.08
"""Least distance of the vectors' numbers at their largest, over the polygon's extent [-]."""

ALONG = (0.5, 0.36, 0.64, 0.22, 0.78)
"""Where on its arrow a number may stand [-]."""

BESIDE = (0.75, 1.2, 1.8)
"""How far from its arrow it may stand, in least distances of two numbers [-]."""

CLEAR = 0.6
"""Least distance of such a number from any arrow, in the same [-]."""

FLAT = 0.02
"""Height of a chain over its width below which it is a line: the first vector is real [-]."""

FOLD_RAD = math.radians(8.0)
"""Angle from one vector back along the one before within which they lie on one another [rad]."""

STEEPEST = 0.4
"""Height of a chain over its width above which lanes would take too much room [-]."""

ACROSS = 1.28
"""Width of the panel over the chain's [-]."""

ROUNDS = 60
"""Rounds in which the lanes of the panel are found: each halves their error, or more [-]."""

SMALLEST = 0.55
"""Least size of arrows and numbers, over that of few [-]."""

OF_LARGEST = 11
"""Vectors up to which the numbers keep the largest size [-]."""

LINE_PT, ARROW_PT = 2.2, 9.0
"""Line width of an arrow, and what its head is measured by [pt]."""


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

    The chain of a shaper without vibration comes back to 0. Vectors that lie along one line, as
    those of positive shapers of an undamped mode, would cover each other: each gets a lane.

    Parameters
    ----------
    axes
        An empty panel.
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive.
    """
    vectors = vibration_vectors(impulses, mode, actuator)
    corners = np.concatenate(([0.0], np.cumsum(vectors)))
    name_panel(axes, "vectors", "Vibration vectors, head to tail")
    # An invisible path under the arrows: they take no part in the limits of the axes.
    axes.plot(corners.real, corners.imag, linestyle="none", gid="corners")
    colours = [DEEP if grows else BRIGHT for grows in reference(impulses, actuator).accelerates]
    residual = abs(corners[-1])
    draw = _draw_lanes if lie_on_one_another(vectors) else _draw_polygon
    draw(axes, corners, colours, is_open=residual > ZERO_LIMITS["residual"])
    note = (
        "closes: no residual vibration"
        if residual <= ZERO_LIMITS["residual"]
        else f"open by the residual, {percent(residual)}"
    )
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


def lie_on_one_another(vectors: ComplexArray) -> bool:
    """Return whether vectors, head to tail, would cover each other.

    All lie along one line, or each goes back along the one before it.

    Parameters
    ----------
    vectors
        Shape (n,), the first of them real [-].

    Returns
    -------
    bool
        False of a chain that turns far while it does.
    """
    if vectors.size == 1 or not vectors.all():
        return False
    corners = np.cumsum(vectors)
    slope = float(np.ptp(corners.imag) / np.ptp(np.append(corners.real, 0.0)))
    folds = np.abs(np.angle(-vectors[1:] / vectors[:-1])) <= FOLD_RAD
    return slope <= FLAT or (slope <= STEEPEST and bool(folds.all()))


def _draw_polygon(
    axes: Axes, corners: ComplexArray, colours: Sequence[str], *, is_open: bool
) -> None:
    """Draw the chain as it lies in the plane."""
    axes.axhline(0, color=GREY, linewidth=0.7)
    axes.axvline(0, color=GREY, linewidth=0.7)
    shrunk = _shrunk(len(colours))
    apart = LABEL_SPACING * max(float(np.ptp(corners.real)), float(np.ptp(corners.imag)))
    places = _free_places(corners, apart * shrunk)
    for number, (colour, place) in enumerate(zip(colours, places, strict=True), start=1):
        # Each lies over the next, whose tail would cover its tip.
        over = 3 - number / len(colours)
        _draw_arrow(axes, corners[number - 1], corners[number], colour, over, shrunk)
        if place is not None:
            _write_number(axes, number, place, colour, SMALL_PT * shrunk)
    gap = corners[[0, -1]]
    if is_open:
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
    _fit_square(axes, corners)
    axes.set_ylabel("imaginary part [share of unshaped]")


def _draw_lanes(
    axes: Axes, corners: ComplexArray, colours: Sequence[str], *, is_open: bool
) -> None:
    """Draw a chain whose vectors lie on one another, each a lane below the one before it."""
    count = len(colours)
    shrunk = _shrunk(count)
    axes.axvline(0, color=GREY, linewidth=0.7)
    reach = float(np.ptp(corners.real))
    aspect = float(axes.bbox.width / axes.bbox.height) / (ACROSS * reach)
    # The lanes of the panel are those that the chain takes at a scale that is theirs.
    room, own = float(count), np.arange(count + 1)
    for _ in range(ROUNDS):
        room = 1.16 * float(np.ptp(own - aspect * room * corners.imag)) + 1.4
    # Upward is towards the lanes before; angles are true.
    lanes = aspect * room
    heights = -lanes * corners.imag
    for lane, colour in enumerate(colours, start=1):
        tail = complex(corners[lane - 1].real, lane + heights[lane - 1])
        head = complex(corners[lane].real, lane + heights[lane])
        _draw_arrow(axes, tail, head, colour, 3.0, shrunk)
        # Beside the tail, so that a short vector stays visible.
        back = -1 if head.real >= tail.real else 1
        _write_number(axes, lane, tail + back * 0.055 * reach, colour, SMALL_PT * shrunk)
        ends = [head.imag, head.imag + 1]
        axes.plot([head.real] * 2, ends, color=PALE, linewidth=1.0, zorder=1, gid="to-next")
    axes.plot(0, 1, "o", color=INK, markersize=5, zorder=5)
    gap = corners[[0, -1]] if is_open else corners[:1]
    axes.plot(
        gap.real, count + 1 - lanes * gap.imag, "o-", color=INK,
        markerfacecolor="none", markersize=7, linewidth=1.4, zorder=5,
        gid="gap" if is_open else "closed",
    )  # fmt: skip
    # Room at the top for the note.
    lowest = max(count + 1.0, float((heights[1:] + np.arange(1, count + 1)).max()))
    axes.set_ylim(lowest + 0.7, lowest + 0.7 - room)
    middle = (float(corners.real.min()) + float(corners.real.max())) / 2
    half = ACROSS / 2 * reach
    axes.set_xlim(middle - half, middle + half)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
    axes.set_yticks([])
    axes.grid(visible=False, axis="y")
    axes.set_ylabel("imaginary part,\neach vector below the one before")


def _write_number(axes: Axes, number: int, place: complex, colour: str, size_pt: float) -> None:
    axes.text(
        place.real,
        place.imag,
        str(number),
        ha="center",
        va="center",
        fontsize=size_pt,
        bbox={
            "boxstyle": "circle,pad=0.22",
            "facecolor": "white",
            "edgecolor": colour,
            "linewidth": 1.2,
        },
        zorder=4,
    )


def _shrunk(vectors: int) -> float:
    """Return the size of arrows and numbers where there are many, over that of few."""
    return max(SMALLEST, min(1.0, OF_LARGEST / vectors))


def _free_places(corners: ComplexArray, apart: float) -> list[complex | None]:
    """Return a place for each arrow's number: on it, beside it if it is short; None without one."""
    taken: list[complex] = [complex(corners[0]), complex(corners[-1])]  # Dots, drawn over numbers
    places: list[complex | None] = []
    for tail, head in pairwise(corners.tolist()):
        length = abs(head - tail)
        sideways = 1j * (head - tail) / length if length > 0 else 1j
        middle = tail + (head - tail) / 2
        on = [tail + share * (head - tail) for share in ALONG] if length > 2 * apart else []
        beside = [
            middle + sign * far * apart * sideways
            for far in BESIDE
            for sign in (1, -1)
            if _distance(middle + sign * far * apart * sideways, corners) > CLEAR * apart
        ]
        free = (place for place in (*on, *beside) if all(abs(place - one) > apart for one in taken))
        place = next(free, None)
        places.append(place)
        taken += [] if place is None else [place]
    return places


def _distance(place: complex, corners: ComplexArray) -> float:
    """Return the distance of a place from the nearest arrow."""
    tails, ways = corners[:-1], np.diff(corners)
    squares = np.maximum(np.abs(ways) ** 2, np.finfo(np.float64).tiny)
    shares = np.clip(((place - tails) * ways.conj()).real / squares, 0, 1)
    return float(np.abs(place - tails - shares * ways).min())


def _draw_arrow(
    axes: Axes, tail: complex, head: complex, colour: str, over: float, shrunk: float
) -> None:
    axes.annotate(
        "",
        (head.real, head.imag),
        xytext=(tail.real, tail.imag),
        arrowprops={
            "arrowstyle": "-|>,head_length=0.55,head_width=0.24",
            "color": colour,
            "linewidth": LINE_PT * shrunk,
            "mutation_scale": ARROW_PT * shrunk,
            "shrinkA": 0,
            "shrinkB": 0,
            "joinstyle": "miter",
        },
        zorder=over,
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
