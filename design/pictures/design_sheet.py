"""One design on one page: impulses, vectors, motion and sensitivity."""

import io
from typing import Literal

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from design.analysis.ramp_figures import end_of_reference
from design.analysis.sensitivity import Sensitivity
from design.claims import ZERO_LIMITS
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pictures import time_panels
from design.pictures.sensitivity_panel import draw_sensitivity
from design.pictures.style import BRIGHT, GREY, INK, SMALL_PT, house_style, percent
from design.pictures.vector_panel import draw_vectors
from design.pipeline import Design

SIZE_IN = (11.0, 8.0)
"""Width and height [in]: a landscape page of A4 or letter without scaling."""

LEFT, RIGHT = 0.08, 0.982
"""Margins of the page, as shares of its width [-]."""


def design_sheet(
    name: str,
    modes: tuple[Mode, ...],
    actuator: Actuator,
    design: Design,
    sensitivity: Sensitivity,
) -> Figure:
    """Return the sheet of one design.

    Parameters
    ----------
    name
        The shaper's kind, as the registry names it.
    modes, actuator
        The plant's modes, of which the slowest is drawn, and its drive.
    design
        The design; its times in s, its residual a share.
    sensitivity
        Its curve, shape (m,) of ratios and of residuals [-].

    Returns
    -------
    Figure
        11 x 8 in. Left, over one time axis [s]: the impulses; command and velocity of the
        actuator [share of full speed]; deflection of the payload with and without the shaper
        [share of the unshaped amplitude]. Right: the vibration vectors head to tail, and the
        residual [%] over the frequency ratio with its insensitivity.
    """
    number = min(range(len(modes)), key=lambda one: modes[one].natural_frequency_rad_s)
    mode = modes[number]
    with house_style():
        figure = Figure(figsize=SIZE_IN)
        _write_header(figure, name, mode, len(modes), actuator, design)
        _draw_time_panels(figure, mode, actuator, design.impulses, design.residuals[number])
        right = figure.add_gridspec(
            2, 1, left=0.66, right=RIGHT, bottom=0.075, top=0.82, hspace=0.3,
            height_ratios=(1.22, 1),
        )  # fmt: skip
        draw_vectors(figure.add_subplot(right[0]), design.impulses, mode, actuator)
        draw_sensitivity(figure.add_subplot(right[1]), sensitivity, design.residual)
        return figure


def figure_bytes(figure: Figure, image_format: Literal["png", "svg"]) -> bytes:
    """Return a figure as a file's bytes, the same ones every time.

    Parameters
    ----------
    figure
        A figure of this package.
    image_format
        ``png``, 150 dots per inch, or ``svg``, with text as outlines.

    Returns
    -------
    bytes
        Without a date or version in them.
    """
    # Neither the time nor the version of the program belongs in the file.
    metadata = {"Date": None} if image_format == "svg" else {"Software": None}
    buffer = io.BytesIO()
    with house_style():
        figure.savefig(buffer, format=image_format, metadata=metadata)
    return buffer.getvalue()


def _draw_time_panels(
    figure: Figure, mode: Mode, actuator: Actuator, impulses: Impulses, residual: float
) -> None:
    times_s = time_panels.time_grid(impulses, mode, actuator)
    rows = figure.add_gridspec(3, 1, left=LEFT, right=0.595, bottom=0.075, top=0.82, hspace=0.24)
    top = figure.add_subplot(rows[0])
    middle = figure.add_subplot(rows[1], sharex=top)
    bottom = figure.add_subplot(rows[2], sharex=top)
    time_panels.draw_impulses(top, impulses, times_s)
    time_panels.draw_command(middle, impulses, mode, actuator, times_s)
    time_panels.draw_payload(bottom, impulses, mode, actuator, residual, times_s)
    top.set_xlim(float(times_s[0]), float(times_s[-1]))
    for axes in (top, middle, bottom):
        time_panels.mark_switches(axes, impulses, actuator)
        axes.tick_params(labelbottom=axes is bottom)
    figure.align_ylabels([top, middle, bottom])


def _write_header(
    figure: Figure, name: str, mode: Mode, modes: int, actuator: Actuator, design: Design
) -> None:
    """Write what was designed for what, and whether it holds, above a rule."""
    # A long name shrinks rather than run into the facts.
    figure.text(0.018, 0.933, name, fontsize=min(21.0, 160.0 / len(name)), weight="bold")
    duration = end_of_reference(design.impulses, actuator) - float(design.impulses.times_s[0])
    until = "duration" if duration == design.impulses.duration_s else "last ramp ends"
    certificate, proven, tone = _certificate_lines(design)
    facts = (
        (
            0.19,
            "plant",
            f"{mode.natural_frequency_rad_s:.4g} rad/s",
            f"damping ratio {mode.damping_ratio:.3g}"
            + (f"\nthe slowest of {modes} modes" if modes > 1 else ""),
        ),
        (0.345, "actuator", *actuator.in_words),
        (0.565, until, f"{duration:.4g} s", f"{duration / mode.period_s:.3f} periods"),
        (0.7, "residual", _residual_text(design), "of the unshaped step"),
        (0.855, "certificate", certificate, proven),
    )
    for left, label, value, detail in facts:
        figure.text(left, 0.972, label, color=GREY, fontsize=SMALL_PT)
        # What is proven for another drive than this one catches the eye, and so does what it costs.
        color = tone if label in {"certificate", "residual"} else INK
        figure.text(left, 0.946, value, fontsize=10, weight="bold", color=color)
        # Line by line: a block is placed by its tallest letter, and neighbours would not align.
        for row, line in enumerate(detail.splitlines()):
            figure.text(left, 0.922 - 0.0195 * row, line, fontsize=SMALL_PT + 0.5)
    figure.add_artist(Line2D([0.018, RIGHT], [0.886, 0.886], color=INK, linewidth=1.0))
    figure.text(0.018, 0.866, _note(design), fontsize=SMALL_PT, color=GREY)


def _residual_text(design: Design) -> str:
    limit = ZERO_LIMITS["residual"]
    return f"below {percent(limit)}" if design.residual <= limit else percent(design.residual)


def _note(design: Design) -> str:
    """Return the first warning, and how many more there are."""
    if not design.warnings:
        return ""
    others = len(design.warnings) - 1
    return f"note: {design.warnings[0].detail}" + (f"; {others} more" if others else "")


def _certificate_lines(design: Design) -> tuple[str, str, str]:
    """Return what is proven, of what, and the colour: amber where it is not for this drive."""
    claims = " and ".join(dict.fromkeys(claim.quantity for claim in design.certificate.claims))
    if not design.certificate.verified:
        return "✗ not verified", claims, BRIGHT
    if design.for_ideal:
        return "ideal drive only", "not proven for this one", BRIGHT
    return "✓ verified", claims, INK
