"""The panels over time: impulses, command with velocity, and the payload's answer."""

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from design.analysis.ramp_figures import end_of_reference
from design.analysis.unshaped import unshaped_deflection_s
from design.claims import ZERO_LIMITS
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.settling import settling_time_s
from design.pictures.impulse_labels import label_impulses
from design.pictures.limit_marks import mark_limits
from design.pictures.style import (
    BRIGHT,
    DEEP,
    GREY,
    INK,
    PALE,
    SMALL_PT,
    STROKES,
    legend_above,
    name_panel,
)
from design.pictures.words import modes_in_words
from design.response.closed_form import history
from design.types import FloatArray

PERIODS_AFTER = (1.6, 4.0)
"""Least and most periods of the plant that are shown after the last switch [-]."""

SETTLED_SHARE = 0.98
"""Share of its step that the actuator has made by the end of the picture, if it can [-]."""

POINTS = 1200

TIP_PT = 6.5
"""Size of the tip of an impulse [pt]."""


def time_grid(impulses: Impulses, mode: Mode, actuator: Actuator) -> FloatArray:
    """Return the times to draw: even, and either side of every switch.

    From just before the first switch until the plant has swung and the actuator has settled after
    the last switch, or the last ramp.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive.

    Returns
    -------
    FloatArray
        Shape (n,), rising [s].
    """
    first, last = float(impulses.times_s[0]), end_of_reference(impulses, actuator)
    settling = max(
        settling_time_s(lag, SETTLED_SHARE) for lag in (actuator.accel_lag, actuator.decel_lag)
    )
    least, most = (periods * mode.period_s for periods in PERIODS_AFTER)
    end = last + min(max(settling, least), most)
    start = first - 0.04 * (end - first)
    even = np.linspace(start, end, POINTS)
    # An ideal actuator jumps: a sample on either side keeps its flanks upright.
    before = np.nextafter(impulses.times_s, -np.inf)
    return np.unique(np.concatenate((even, before, impulses.times_s)))


def draw_impulses(axes: Axes, impulses: Impulses, times_s: FloatArray) -> None:
    """Draw a stem for each impulse, its time past its tip.

    Parameters
    ----------
    axes
        An empty panel.
    impulses
        The shaper, n impulses.
    times_s
        Times to draw, of which the first and last bound the panel [s].
    """
    name_panel(axes, "impulses", "Impulses")
    axes.axhline(0, color=GREY, linewidth=0.8)
    for label, chosen, colour, fill in (
        ("accelerating", impulses.accelerates, DEEP, DEEP),
        ("decelerating", ~impulses.accelerates, BRIGHT, "white"),
    ):
        at, heights = impulses.times_s[chosen], impulses.amplitudes[chosen]
        if at.size == 0:
            continue
        axes.vlines(at, 0, heights, color=colour, linewidth=2.2)
        axes.plot(
            at,
            heights,
            "o",
            color=colour,
            markerfacecolor=fill,
            markersize=TIP_PT,
            markeredgewidth=1.6,
            label=label,
        )
    label_impulses(axes, impulses, times_s)
    axes.yaxis.set_major_locator(MaxNLocator(nbins=4, steps=[1, 2, 5, 10]))
    axes.set_ylabel("amplitude [-]")
    legend_above(axes)


def draw_command(
    axes: Axes, impulses: Impulses, mode: Mode, actuator: Actuator, times_s: FloatArray
) -> None:
    """Draw the commanded velocity and the actuator's.

    Both are shares of full speed. Behind limits, what they make of the command is drawn as well,
    marked by the limit that binds.

    Parameters
    ----------
    axes
        An empty panel.
    impulses
        The command.
    mode, actuator
        The plant's mode and its drive.
    times_s
        Times to draw, shape (n,) [s].
    """
    name_panel(axes, "command", "Command and actuator")
    moves = history(impulses, mode, actuator, times_s)
    axes.plot(
        times_s, moves.command, color=INK, linewidth=1.0, linestyle=(0, (4, 2)), label="command"
    )
    if isinstance(actuator, RateLimited):
        mark_limits(axes, impulses, actuator)
    axes.plot(times_s, moves.velocity, color=DEEP, label="velocity", gid="velocity")
    axes.margins(y=0.14)
    axes.set_ylabel("velocity\n[share of full speed]")
    legend_above(axes)


def draw_payload(
    axes: Axes,
    impulses: Impulses,
    modes: Sequence[Mode],
    actuator: Actuator,
    residuals: Sequence[float],
    times_s: FloatArray,
) -> None:
    """Draw the payload's deflection with and without the shaper, in each mode.

    What rings on is drawn as well. The unit is the amplitude of the unshaped step in that mode.

    Parameters
    ----------
    axes
        An empty panel.
    impulses
        The shaper.
    modes, actuator
        The plant's modes and its drive.
    residuals
        Residual vibration of the shaper in each mode [-].
    times_s
        Times to draw, shape (n,) [s].
    """
    name_panel(axes, "payload", "Payload")
    start, last = impulses.times_s[:1], end_of_reference(impulses, actuator)
    step = Impulses(times_s=start, amplitudes=np.ones(1))
    several, highest = len(modes) > 1, 0.0
    names = modes_in_words(modes) if several else ["shaped"]
    each = zip(modes, residuals, names, cycle(STROKES), strict=False)
    for number, (mode, residual, name, (colour, dashes)) in enumerate(each):
        # What `history` returns is over speed and natural frequency.
        unit = 1 / (mode.natural_frequency_rad_s * unshaped_deflection_s(mode, actuator))
        unshaped = unit * history(step, mode, actuator, times_s).deflection
        shaped = unit * history(impulses, mode, actuator, times_s).deflection
        if residual > ZERO_LIMITS["residual"]:
            ringing_s = times_s[times_s >= last]
            decay = mode.damping_ratio * mode.natural_frequency_rad_s
            envelope = residual * np.exp(-decay * (ringing_s - last))
            axes.fill_between(
                ringing_s, -envelope, envelope, color=colour if several else BRIGHT,
                alpha=0.15 if several else 0.3, linewidth=0,
                label=None if several else "residual", gid="residual",
            )  # fmt: skip
        axes.plot(
            times_s, unshaped, color=colour if several else GREY,
            linewidth=0.7 if several else 1.2, linestyle=(0, (5, 2)),
            alpha=0.4 if several else 1.0, label=None if several else "unshaped step",
            gid="unshaped",
        )  # fmt: skip
        axes.plot(
            times_s, shaped, color=colour, linestyle=dashes,
            label=name, gid=f"shaped-{number}" if several else "shaped",
        )  # fmt: skip
        highest = max(highest, float(np.abs(unshaped).max()), float(np.abs(shaped).max()))
    if several:
        axes.plot([], [], color=GREY, linewidth=0.9, linestyle=(0, (5, 2)), label="unshaped")
    # Room at the top for the note, clear of every curve.
    axes.set_ylim(-1.12 * highest, 1.42 * highest)
    mark_end(axes, last, last_event(actuator), times_s)
    axes.set_ylabel("deflection\n[share of unshaped]")
    axes.set_xlabel("time [s]")
    legend_above(axes, columns=-(-(len(modes) + 1) // 2) if several else 3)


def mark_end(axes: Axes, end_s: float, event: str, times_s: FloatArray) -> None:
    """Write when a command ends, at the top of a panel over time.

    Parameters
    ----------
    axes
        The panel.
    end_s
        When [s].
    event
        What ends then.
    times_s
        Times that are drawn [s].
    """
    # After a long command the note would leave the panel on the right.
    after = end_s - times_s[0] < 0.7 * (times_s[-1] - times_s[0])
    axes.annotate(
        f"{event}, {end_s:.4g} s", (end_s, 1.0), xycoords=("data", "axes fraction"),
        xytext=(5 if after else -5, -3), textcoords="offset points",
        ha="left" if after else "right", va="top", fontsize=SMALL_PT,
    )  # fmt: skip


def last_event(actuator: Actuator) -> str:
    """Return what comes last in a command: a switch or a ramp."""
    return "last ramp ends" if isinstance(actuator, RateLimited) else "last switch"


def mark_switches(axes: Axes, impulses: Impulses, actuator: Actuator, delay_s: float = 0.0) -> None:
    """Draw a line through a panel at every switch, a darker one at the end.

    The end is the last switch, or behind limits the end of the last ramp.

    Parameters
    ----------
    axes
        A panel over time.
    impulses, actuator
        The command, and what follows it.
    delay_s
        Of the end after the command's [s].
    """
    end = end_of_reference(impulses, actuator) + delay_s
    for time in impulses.times_s[impulses.times_s < end].tolist():
        axes.axvline(time, color=PALE, linewidth=0.9, zorder=0.8)
    axes.axvline(end, color=INK, linewidth=0.9, linestyle=(0, (1, 1.6)), zorder=0.9)
