"""The times of impulses, each written past its tip, out of the way of all others."""

import numpy as np
from matplotlib.axes import Axes

from design.model.impulses import Impulses
from design.pictures.style import GREY, SMALL_PT
from design.types import FloatArray

REACHES = (1.5, 2.0, 2.7, 3.6)
"""Height of the panel over the largest amplitude: the least at which every time has room [-]."""

EMPTY = 0.15
"""Room below zero where no impulse is, over that above it [-]."""

DIGIT_PT, NUMBER_PT, SIGN_PT = 5.2, 3.9, 12.0
"""Width of a digit of a time, of one of its number, and of what is around them [pt]."""

LINE_PT = 11.0
"""Height of a label, its margin included [pt]."""

FIRST_PT = 6.0
"""Least distance of a label from its tip [pt]."""

Box = tuple[float, float, float, float]
"""Left, right, lower and upper end [pt]."""


def label_impulses(axes: Axes, impulses: Impulses, times_s: FloatArray) -> None:
    """Write the time of each impulse past its tip; set the panel's height.

    A time without room is left out, and how many are is said.

    Parameters
    ----------
    axes
        The panel of impulses.
    impulses
        The shaper, n impulses.
    times_s
        Times to draw, of which the first and last bound the panel [s].
    """
    pixels = axes.bbox
    inches = 72.0 / float(axes.get_figure(root=True).dpi)  # type: ignore[union-attr]
    width, height = float(pixels.width) * inches, float(pixels.height) * inches
    below = bool(impulses.amplitudes.min() < 0)
    across = width / float(times_s[-1] - times_s[0])
    largest = float(np.abs(impulses.amplitudes).max())
    for reach in REACHES:
        low = -reach if below else -EMPTY * reach
        up = height / (reach - low) / largest
        places = np.column_stack((
            (impulses.times_s - times_s[0]) * across,
            impulses.amplitudes * up - low * largest * up,
        ))
        offsets = _offsets(impulses, places, height)
        if all(offset is not None for offset in offsets):
            break
    axes.set_ylim(low * largest, reach * largest)
    for number, (time, amplitude, offset) in enumerate(
        zip(impulses.times_s.tolist(), impulses.amplitudes.tolist(), offsets, strict=True), start=1
    ):
        if offset is not None:
            axes.annotate(
                f"$t_{{{number}}}$  {time:.4g}", (time, amplitude), xytext=(0, offset),
                textcoords="offset points", ha="center", va="bottom" if amplitude > 0 else "top",
                fontsize=SMALL_PT,
                bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"},
            )  # fmt: skip
    left_out = sum(offset is None for offset in offsets)
    if left_out:
        axes.text(
            0.985, 0.97, f"{left_out} of {len(offsets)} times without room",
            transform=axes.transAxes, ha="right", va="top", fontsize=SMALL_PT, color=GREY,
        )  # fmt: skip


def _offsets(impulses: Impulses, places: FloatArray, height: float) -> list[float | None]:
    """Return how far past its tip each label stands [pt]; None where it has no room."""
    taken: list[Box] = [(x - 3.5, x + 3.5, y - 3.5, y + 3.5) for x, y in places.tolist()]
    found: list[float | None] = []
    steps = zip(places.tolist(), impulses.times_s.tolist(), impulses.amplitudes, strict=True)
    for number, ((x, y), time, amplitude) in enumerate(steps, start=1):
        half = (SIGN_PT + DIGIT_PT * len(f"{time:.4g}") + NUMBER_PT * len(str(number))) / 2
        sign = 1.0 if amplitude > 0 else -1.0
        offset: float | None = sign * FIRST_PT
        box: Box = (0.0, 0.0, 0.0, 0.0)
        while offset is not None:
            ends = sorted((y + offset, y + offset + sign * LINE_PT))
            box = (x - half, x + half, ends[0], ends[1])
            if ends[0] < 0 or ends[1] > height:
                offset = None
            elif any(_meet(box, other) for other in taken):
                offset += sign * LINE_PT / 2
            else:
                break
        found.append(offset)
        taken += [] if offset is None else [box]
    return found


def _meet(one: Box, other: Box) -> bool:
    across = one[0] < other[1] and other[0] < one[1]
    return across and one[2] < other[3] and other[2] < one[3]
