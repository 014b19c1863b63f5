"""The panels over time: impulses, command with velocity, and the payload's answer."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from design.analysis.ramp_figures import end_of_reference
from design.analysis.unshaped import unshaped_deflection_s
from design.claims import ZERO_LIMITS
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.settling import settling_time_s
from design.pictures.style import BRIGHT, DEEP, GREY, INK, PALE, SMALL_PT, legend_above, name_panel
from design.response.closed_form import history
from design.types import FloatArray

PERIODS_AFTER = (1.6, 4.0)
"""Least and most periods of the plant that are shown after the last switch [-]."""

SETTLED_SHARE = 0.98
"""Share of its step that the actuator has made by the end of the picture, if it can [-]."""

POINTS = 1200

LABEL_WIDTH = (0.05, 0.0095)
"""Room that the label of a time takes, and each of its digits, in widths of the panel [-]."""


def time_grid(impulses: Impulses, mode: Mode, actuator: Actuator) -> FloatArray:
    """Return the times to draw: even, and either side of every switch.

    From just before the first switch until the plant has swung and the actuator has settled.

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
    first, last = float(impulses.times_s[0]), float(impulses.times_s[-1])
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
    """Draw a stem for each impulse, with its time beside its tip.

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
        axes.vlines(at, 0, heights, color=colour, linewidth=2.2)
        axes.plot(
            at,
            heights,
            "o",
            color=colour,
            markerfacecolor=fill,
            markersize=6.5,
            markeredgewidth=1.6,
            label=label,
        )
    levels = _label_times(axes, impulses, times_s)
    reach = 1.5 * 1.33 ** (levels - 1) * float(np.abs(impulses.amplitudes).max())
    axes.set_ylim(-reach, reach)
    axes.yaxis.set_major_locator(MaxNLocator(nbins=4, steps=[1, 2, 5, 10]))
    axes.set_ylabel("amplitude [-]")
    legend_above(axes)


def _label_times(axes: Axes, impulses: Impulses, times_s: FloatArray) -> int:
    """Write each time past its tip, out of its neighbours' way; return the levels this takes."""
    span = float(times_s[-1] - times_s[0])
    ends_by_side: dict[bool, list[float]] = {True: [], False: []}
    steps = zip(impulses.times_s.tolist(), impulses.amplitudes.tolist(), strict=True)
    for number, (time, amplitude) in enumerate(steps, start=1):
        digits, up = f"{time:.4g}", amplitude > 0
        reach = span * (LABEL_WIDTH[0] + LABEL_WIDTH[1] * len(digits)) / 2
        ends = ends_by_side[up]
        level = next((k for k, end in enumerate(ends) if time - reach >= end), len(ends))
        ends[level : level + 1] = [time + reach]
        axes.annotate(
            f"$t_{{{number}}}$  {digits}",
            (time, amplitude),
            xytext=(0, (7 + 11 * level) * (1 if up else -1)),
            textcoords="offset points",
            ha="center",
            va="bottom" if up else "top",
            fontsize=SMALL_PT,
            bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"},
        )
    return max(map(len, ends_by_side.values()))


def draw_command(
    axes: Axes, impulses: Impulses, mode: Mode, actuator: Actuator, times_s: FloatArray
) -> None:
    """Draw the commanded velocity and the actuator's.

    Both are shares of full speed.

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
    axes.plot(times_s, moves.velocity, color=DEEP, label="velocity", gid="velocity")
    axes.margins(y=0.14)
    axes.set_ylabel("velocity\n[share of full speed]")
    legend_above(axes)


def draw_payload(
    axes: Axes,
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    residual: float,
    times_s: FloatArray,
) -> None:
    """Draw the payload's deflection with and without the shaper.

    What rings on is drawn as well. The unit is the amplitude of the unshaped step.

    Parameters
    ----------
    axes
        An empty panel.
    impulses
        The shaper.
    mode, actuator
        The plant's mode and its drive.
    residual
        Residual vibration of the shaper [-].
    times_s
        Times to draw, shape (n,) [s].
    """
    name_panel(axes, "payload", "Payload")
    start, last = impulses.times_s[:1], float(impulses.times_s[-1])
    step = Impulses(times_s=start, amplitudes=np.ones(1))
    # What `history` returns is over speed and natural frequency.
    unit = 1 / (mode.natural_frequency_rad_s * unshaped_deflection_s(mode, actuator))
    unshaped = unit * history(step, mode, actuator, times_s).deflection
    shaped = unit * history(impulses, mode, actuator, times_s).deflection
    if residual > ZERO_LIMITS["residual"]:
        end = end_of_reference(impulses, actuator)
        ringing_s = times_s[times_s >= end]
        decay = mode.damping_ratio * mode.natural_frequency_rad_s
        envelope = residual * np.exp(-decay * (ringing_s - end))
        axes.fill_between(
            ringing_s, -envelope, envelope, color=BRIGHT, alpha=0.3, linewidth=0, label="residual"
        )
    axes.plot(
        times_s, unshaped, color=GREY, linewidth=1.2, linestyle=(0, (5, 2)), label="unshaped step"
    )
    axes.plot(times_s, shaped, color=DEEP, label="shaped", gid="shaped")
    highest = max(float(np.abs(unshaped).max()), float(np.abs(shaped).max()))
    # Room at the top for the note, clear of every curve.
    axes.set_ylim(-1.12 * highest, 1.42 * highest)
    # After a long shaper the note would leave the panel on the right.
    after = last - times_s[0] < 0.7 * (times_s[-1] - times_s[0])
    axes.annotate(
        f"last switch, {last:.4g} s",
        (last, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(5 if after else -5, -3),
        textcoords="offset points",
        ha="left" if after else "right",
        va="top",
        fontsize=SMALL_PT,
    )
    axes.set_ylabel("deflection\n[share of unshaped]")
    axes.set_xlabel("time [s]")
    legend_above(axes)


def mark_switches(axes: Axes, impulses: Impulses) -> None:
    """Draw a line through a panel at every switch, the last one darker.

    Parameters
    ----------
    axes
        A panel over time.
    impulses
        The command.
    """
    for time in impulses.times_s[:-1].tolist():
        axes.axvline(time, color=PALE, linewidth=0.9, zorder=0.8)
    axes.axvline(
        float(impulses.times_s[-1]), color=INK, linewidth=0.9, linestyle=(0, (1, 1.6)), zorder=0.9
    )
