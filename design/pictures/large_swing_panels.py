"""The panels of a large swing: its angle over time, and its rate over its angle, on the rig."""

import math

import numpy as np
from matplotlib.axes import Axes

from design.checks import MAX_VALUE
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.large_swing import LargeSwing
from design.pictures.style import DEEP, GREY, INK, legend_above, name_panel
from design.pictures.time_panels import last_event, mark_end
from design.rig.crane import Crane
from design.rig.machine import Machine
from design.types import FloatArray

UNSHAPED = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))


def swing_angles(
    command: Impulses, swing: LargeSwing, actuator: Actuator, times_s: FloatArray
) -> FloatArray:
    """Return the angle of the cable over time, integrated by the rig.

    Parameters
    ----------
    command
        The steps, from time 0 on.
    swing, actuator
        The load at its full speed, and its drive.
    times_s
        Ascending, shape (n,) [s]; at rest before 0.

    Returns
    -------
    FloatArray
        Shape (n,) [rad]; positive where the load hangs back.
    """
    crane = Crane(
        cable_length_m=swing.crane.cable_length_m,
        damping_ratio=swing.crane.damping_ratio,
        gravity_m_s2=swing.crane.gravity_m_s2,
        max_speed_m_s=MAX_VALUE,
    )
    machine = Machine(crane, (actuator, actuator), swing.speed_m_s)
    machine.open_bounds()
    for at_s, level in zip(command.times_s, np.cumsum(command.amplitudes), strict=True):
        machine.command("x", float(level), float(at_s))
    moving = times_s >= 0.0
    angles = np.zeros(times_s.size)
    hook = machine.advance(float(times_s[-1]), times_s[moving]).hook_m
    angles[moving] = np.arctan2(-hook[:, 0], -hook[:, 2])
    return angles


def draw_swing(
    axes: Axes, command: Impulses, swing: LargeSwing, actuator: Actuator, times_s: FloatArray
) -> None:
    """Draw the angle of the cable with and without the shaper.

    Parameters
    ----------
    axes
        An empty panel.
    command, swing, actuator
        The shaper, the load at its full speed, and its drive.
    times_s
        Times to draw, shape (n,) [s].
    """
    name_panel(axes, "payload", f"Payload, nonlinear, {swing.speed_m_s:g} m/s")
    unshaped, shaped = (
        np.degrees(swing_angles(one, swing, actuator, times_s)) for one in (UNSHAPED, command)
    )
    axes.plot(
        times_s, unshaped, color=GREY, linewidth=1.2, linestyle=(0, (5, 2)),
        label="unshaped step", gid="unshaped",
    )  # fmt: skip
    axes.plot(times_s, shaped, color=DEEP, label="shaped", gid="shaped")
    highest = max(float(np.abs(unshaped).max()), float(np.abs(shaped).max()))
    axes.set_ylim(-1.12 * highest, 1.42 * highest)
    mark_end(axes, float(command.times_s[-1]), last_event(actuator), times_s)
    axes.set_ylabel("angle [degrees]")
    axes.set_xlabel("time [s]")
    legend_above(axes, columns=3)


def draw_phase_plane(
    axes: Axes, command: Impulses, swing: LargeSwing, actuator: Actuator, times_s: FloatArray
) -> None:
    """Draw the rate of the swing over its angle, each step marked.

    The vectors of a linear mode have no place here: those of a large swing do not add up.

    Parameters
    ----------
    axes
        An empty panel.
    command, swing, actuator, times_s
        As of `draw_swing`.
    """
    name_panel(axes, "vectors", "Phase plane")
    last = float(command.times_s[-1])
    even = np.linspace(0.0, float(times_s[-1]), 4 * times_s.size)
    angles = swing_angles(command, swing, actuator, even)
    rates = np.gradient(angles, even) / swing.crane.mode.natural_frequency_rad_s
    told = even <= last
    axes.axhline(0, color=GREY, linewidth=0.8)
    axes.axvline(0, color=GREY, linewidth=0.8)
    turned = [math.degrees(1.0) * one for one in (angles, rates)]
    axes.plot(turned[0], turned[1], color=GREY, linewidth=1.0, label="after the last step")
    axes.plot(turned[0][told], turned[1][told], color=DEEP, label="shaped", gid="phase")
    for number, at_s in enumerate(command.times_s.tolist(), start=1):
        at = int(np.argmin(np.abs(even - at_s)))
        axes.plot(turned[0][at], turned[1][at], "o", color=INK, markersize=4)
        axes.annotate(
            str(number), (turned[0][at], turned[1][at]), xytext=(4, 4), textcoords="offset points"
        )
    axes.set_xlabel("angle [degrees]")
    axes.set_ylabel("rate over w [degrees]")
    legend_above(axes, columns=2)
