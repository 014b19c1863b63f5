"""A simulation on one page: command and velocity, the payload, and what remains."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from design.analysis.ramp_figures import end_of_reference
from design.analysis.warnings import DesignWarning
from design.claims import ZERO_LIMITS
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting
from design.model.plants.registry import Plant
from design.moves.playback import Motion
from design.pictures.head import HEAD_IN, TITLE_IN, Fact, note_of, write_head
from design.pictures.limit_marks import mark_limits
from design.pictures.sheet import Sheet
from design.pictures.style import BRIGHT, DEEP, INK, house_style, legend_above, name_panel
from design.pictures.time_panels import last_event, mark_end, mark_switches
from design.pictures.words import actuator_in_words, plant_in_words, residual_in_words
from design.types import FloatArray

SIZE_IN = (10.0, 6.9)
"""Width and height [in]."""

POINTS = 1200
"""Times that are drawn at least, besides those of the answer."""

BEFORE = 0.03
"""What is drawn before the first time of the answer, over all that it covers [-]."""

MAX_MARKED = 60
"""Steps up to which each is marked, and what limits make of them: of more the end alone [-]."""


def times_to_draw(times_s: FloatArray, command: Impulses) -> FloatArray:
    """Return the times of a picture: those of the answer, and more.

    Parameters
    ----------
    times_s
        Times of the answer, shape (n,), rising [s].
    command
        What is played.

    Returns
    -------
    FloatArray
        Rising, from a little before the answer's; either side of every step among them [s].
    """
    last = float(times_s[-1])
    first = float(times_s[0]) - BEFORE * (last - float(times_s[0]))
    before = np.nextafter(command.times_s, -np.inf)
    every = np.concatenate((times_s, np.linspace(first, last, POINTS), before, command.times_s))
    return np.unique(np.clip(every, first, last))


def simulation_sheet(
    plant: Plant,
    actuator: Actuator,
    command: Impulses,
    speed_m_s: float,
    motion: Motion,
    warnings: Sequence[DesignWarning],
    version: str,
) -> Figure:
    """Return the sheet of a simulation.

    Parameters
    ----------
    plant, actuator
        What moves, of one mode, and its drive.
    command
        The command that was played, shaped if it was.
    speed_m_s
        Full speed [m/s].
    motion
        What it does, at the times to draw.
    warnings
        What to know of it.
    version
        Of the program.

    Returns
    -------
    Figure
        10 x 6.9 in. Over one time axis [s]: command and velocity [m/s]; deflection [m], of a
        pendulum as an angle too [deg], and the amplitude of what remains after the end.
    """
    end_s = end_of_reference(command, actuator) + actuator.dead_time_s
    times_s = motion.times_s
    with house_style():
        figure = Sheet(figsize=SIZE_IN)
        facts = _facts(plant, actuator, command, motion, end_s)
        write_head(figure, "motion", version, facts, note_of(warnings))
        rows = figure.add_gridspec(
            2, 1, left=0.09, right=0.975 if motion.angle_rad is None else 0.925, bottom=0.08,
            top=1 - (HEAD_IN + TITLE_IN) / SIZE_IN[1], hspace=0.24,
        )  # fmt: skip
        top = figure.add_subplot(rows[0])
        bottom = figure.add_subplot(rows[1], sharex=top)
        _draw_velocity(top, actuator, command, speed_m_s, motion)
        _draw_payload(bottom, plant, motion, end_s)
        top.set_xlim(float(times_s[0]), float(times_s[-1]))
        top.tick_params(labelbottom=False)
        for axes in (top, bottom):
            if command.times_s.size <= MAX_MARKED:
                mark_switches(axes, command, actuator, actuator.dead_time_s)
            else:
                axes.axvline(end_s, color=INK, linewidth=0.9, linestyle=(0, (1, 1.6)))
        if end_s <= times_s[-1]:
            event = last_event(actuator) + (" and dead time" if actuator.dead_time_s else "")
            mark_end(bottom, end_s, event, times_s)
        figure.align_ylabels([top, bottom])
        return figure


def _facts(
    plant: Plant, actuator: Actuator, command: Impulses, motion: Motion, end_s: float
) -> list[Fact]:
    steps = command.times_s.size
    left, share = "not defined", "the actuator rings along"
    if motion.remaining is not None and motion.residual is not None:
        share = f"{residual_in_words(motion.residual)}\nof an unshaped step"
        left = f"{motion.remaining.deflection_m:.3g} m"
        if motion.remaining.angle_rad is not None:
            left += f", {np.degrees(motion.remaining.angle_rad):.3g}°"
    peak = f"{motion.peak.deflection_m:.3g} m"
    return [
        Fact("plant", *plant_in_words(plant)),
        Fact("actuator", *actuator_in_words(actuator)),
        Fact("command ends", f"{end_s:.4g} s", f"{steps} step{'s' if steps > 1 else ''}"),
        Fact("largest deflection", peak, f"speed {motion.peak_velocity_m_s:.3g} m/s"),
        Fact("remains", left, share),
    ]


def _draw_velocity(
    axes: Axes, actuator: Actuator, command: Impulses, speed_m_s: float, motion: Motion
) -> None:
    name_panel(axes, "velocity", "Command and actuator")
    axes.plot(
        motion.times_s, motion.command_m_s, color=INK, linewidth=1.0, linestyle=(0, (4, 2)),
        label="command", gid="command",
    )  # fmt: skip
    if isinstance(actuator, RateLimited) and command.times_s.size <= MAX_MARKED:
        delayed = replace(command, times_s=command.times_s + actuator.dead_time_s)
        mark_limits(axes, delayed, actuator, speed_m_s)
    axes.plot(motion.times_s, motion.velocity_m_s, color=DEEP, label="velocity", gid="velocity")
    axes.margins(y=0.14)
    axes.set_ylabel("velocity [m/s]")
    legend_above(axes)


def _draw_payload(axes: Axes, plant: Plant, motion: Motion, end_s: float) -> None:
    name_panel(axes, "payload", "Payload")
    times_s = motion.times_s
    if isinstance(plant, Hoisting):  # what remains is said of the last length
        mode, end_s = plant.last.mode, max(end_s, plant.end_s)
    else:
        mode = plant.mode
    highest = motion.peak.deflection_m
    if motion.remaining is not None and (motion.residual or 0.0) > ZERO_LIMITS["residual"]:
        ringing_s = np.concatenate(([end_s], times_s[times_s > end_s]))
        decay = mode.damping_ratio * mode.natural_frequency_rad_s
        envelope = motion.remaining.deflection_m * np.exp(-decay * (ringing_s - end_s))
        if end_s <= times_s[-1]:
            axes.fill_between(
                ringing_s, -envelope, envelope, color=BRIGHT, alpha=0.3, linewidth=0,
                label="remains", gid="remains",
            )  # fmt: skip
            highest = max(highest, float(envelope[0]))
    axes.plot(times_s, motion.deflection_m, color=DEEP, label="deflection", gid="deflection")
    reach = highest if highest > 0 else 1.0
    # Room at the top for the note, clear of every curve.
    axes.set_ylim(-1.12 * reach, 1.42 * reach)
    axes.set_ylabel("deflection [m]")
    axes.set_xlabel("time [s]")
    in_proportion = motion.angle_rad is not None and not isinstance(plant, Hoisting)
    if in_proportion and motion.peak.angle_rad:
        degrees_per_m = float(np.degrees(motion.peak.angle_rad) / motion.peak.deflection_m)

        def to_degrees(deflection_m: ArrayLike) -> FloatArray:
            return np.asarray(deflection_m, dtype=np.float64) * degrees_per_m

        def from_degrees(angle_deg: ArrayLike) -> FloatArray:
            return np.asarray(angle_deg, dtype=np.float64) / degrees_per_m

        angle = axes.secondary_yaxis("right", functions=(to_degrees, from_degrees))
        angle.set_label("angle")
        angle.set_ylabel("angle [°]")
    legend_above(axes)
