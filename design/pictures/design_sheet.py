"""One design on one page: impulses, vectors, motion and sensitivity."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from design.analysis.ramp_figures import moving_time_s
from design.analysis.sensitivity import Sensitivity
from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.pictures import time_panels
from design.pictures.head import HEAD_IN, TITLE_IN, Fact, certificate_fact, note_of, write_head
from design.pictures.large_swing_panels import draw_phase_plane, draw_swing
from design.pictures.sensitivity_panel import draw_sensitivity
from design.pictures.sheet import Sheet
from design.pictures.style import AMBER, INK, house_style, percent
from design.pictures.vector_panel import draw_vectors
from design.pictures.words import actuator_in_words, plant_in_words, residual_in_words
from design.pipeline import Design

SIZE_IN = (11.0, 8.3)
"""Width and height [in]: a landscape page of A4 or letter without scaling."""

LEFT, MIDDLE, RIGHT = 0.08, 0.595, 0.982
"""Margins of the page and the right end of the panels over time, shares of its width [-]."""

BOTTOM_IN = 0.6
"""Room below the panels [in]."""


def design_sheet(
    name: str,
    plant: Plant,
    actuator: Actuator,
    design: Design,
    curves: Sequence[Sensitivity],
    version: str,
) -> Figure:
    """Return the sheet of one design.

    Parameters
    ----------
    name
        The shaper's kind, as the registry names it.
    plant, actuator
        What moves, and its drive.
    design
        The design; its times in s, its residuals shares.
    curves
        The sensitivity in each mode of the plant.
    version
        Of the program.

    Returns
    -------
    Figure
        11 x 8.3 in. Left, over one time axis [s]: the impulses; command and velocity of the
        actuator [share of full speed]; deflection of the payload with and without the shaper, in
        each mode [share of the unshaped amplitude]. Right: the vibration vectors of the slowest
        mode head to tail, of a large swing its rate over its angle; the residual [%] over the
        frequency ratio with its insensitivity.
    """
    modes = plant.modes
    slowest = min(range(len(modes)), key=lambda one: modes[one].natural_frequency_rad_s)
    with house_style():
        figure = Sheet(figsize=SIZE_IN)
        write_head(figure, name, version, _facts(plant, actuator, design), note_of(design.warnings))
        _draw_time_panels(figure, plant, actuator, design)
        low, high = _panels_of_height()
        right = figure.add_gridspec(
            2, 1, left=0.66, right=RIGHT, bottom=low, top=high, hspace=0.3,
            height_ratios=(1.22, 1),
        )  # fmt: skip
        vectors = figure.add_subplot(right[0])
        if design.large_swing is None:
            draw_vectors(vectors, design.impulses, modes[slowest], actuator)
        else:
            swing, times_s = (
                design.large_swing.swing,
                time_panels.time_grid(design.impulses, modes[slowest], actuator),
            )
            draw_phase_plane(vectors, design.impulses, swing, actuator, times_s)
        if len(modes) > 1:
            vectors.set_title(f"Vibration vectors of mode {slowest}")
        draw_sensitivity(figure.add_subplot(right[1]), curves, design.residuals)
        return figure


def _panels_of_height() -> tuple[float, float]:
    """Return where the panels begin and end, shares of the page's height [-]."""
    return BOTTOM_IN / SIZE_IN[1], 1 - (HEAD_IN + TITLE_IN) / SIZE_IN[1]


def _draw_time_panels(figure: Figure, plant: Plant, actuator: Actuator, design: Design) -> None:
    modes, impulses = plant.modes, design.impulses
    slowest = min(modes, key=lambda mode: mode.natural_frequency_rad_s)
    times_s = time_panels.time_grid(impulses, slowest, actuator)
    low, high = _panels_of_height()
    rows = figure.add_gridspec(3, 1, left=LEFT, right=MIDDLE, bottom=low, top=high, hspace=0.24)
    top = figure.add_subplot(rows[0])
    middle = figure.add_subplot(rows[1], sharex=top)
    bottom = figure.add_subplot(rows[2], sharex=top)
    time_panels.draw_impulses(top, impulses, times_s)
    time_panels.draw_command(middle, impulses, slowest, actuator, times_s)
    if design.large_swing is None:
        time_panels.draw_payload(bottom, impulses, modes, actuator, design.residuals, times_s)
    else:
        draw_swing(bottom, impulses, design.large_swing.swing, actuator, times_s)
    top.set_xlim(float(times_s[0]), float(times_s[-1]))
    for axes in (top, middle, bottom):
        time_panels.mark_switches(axes, impulses, actuator)
        axes.tick_params(labelbottom=axes is bottom)
    figure.align_ylabels([top, middle, bottom])


def _facts(plant: Plant, actuator: Actuator, design: Design) -> list[Fact]:
    """Return what was designed for what, and whether it holds."""
    duration = moving_time_s(design.impulses, actuator)
    until = "duration" if duration == design.impulses.duration_s else "last ramp ends"
    longest = max(mode.period_s for mode in plant.modes)
    of = " of the slowest" if len(plant.modes) > 1 else ""
    claims = [claim.quantity for claim in design.certificate.claims]
    proof = certificate_fact(
        claims, verified=design.certificate.verified, for_ideal=design.for_ideal
    )
    # What is proven for another drive than this one catches the eye, and so does what it costs.
    tone = AMBER if design.for_ideal else INK
    return [
        Fact("plant", *plant_in_words(plant)),
        Fact("actuator", *actuator_in_words(actuator)),
        Fact(until, f"{duration:.4g} s", f"{duration / longest:.3f} periods{of}"),
        Fact("residual", residual_in_words(design.residual), _residual_of(design), tone),
        proof,
    ]


def _residual_of(design: Design) -> str:
    """Return what the residual is a share of, and the largest in a range where there is one."""
    if design.large_swing is not None:
        return f"of the unshaped step at {design.large_swing.swing.speed_m_s:g} m/s,\nnonlinear"
    if design.worst_in_range is None:
        return "of the unshaped step"
    return f"in the middle of the range,\nat most {percent(design.worst_in_range)} within it"
