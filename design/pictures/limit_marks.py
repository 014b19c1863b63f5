"""The reference behind limits to acceleration, marked by the limit that binds it."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from design.analysis.binding_limits import Limit, binding_limits
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.ramps import ramped
from design.pictures.style import BRIGHT, DEEP, GREEN, GREY, INK, SMALL_PT

MARKS: dict[Limit, tuple[str, str | tuple[int, tuple[float, ...]], str]] = {
    "acceleration": (GREEN, "-", "acceleration"),
    "deceleration": (BRIGHT, (0, (1.2, 0.5)), "deceleration"),
    "jerk": (DEEP, (0, (2.4, 0.8)), "jerk"),
    "speed": (INK, (0, (0.5, 0.5)), "full speed"),
    "rest": (GREY, (0, (0.3, 1.2)), "rest"),
}
"""Colour, dashes and name of each limit: distinct in grey print too."""

KNOTS = 17
"""Points at which a ramp is drawn."""

WIDTH_PT = 6.0
"""The marks are wide, and the actuator's velocity is drawn upon them [pt]."""


def mark_limits(
    axes: Axes, command: Impulses, actuator: RateLimited, full_speed: float = 1.0
) -> None:
    """Draw the reference, coloured by the limit that binds it.

    Parameters
    ----------
    axes
        A panel of velocity over time.
    command, actuator
        The command, and its limits.
    full_speed
        Full speed in the unit of the panel, negative for a move in -x.
    """
    changes = ramped(command, actuator)
    reached = np.cumsum(changes.changes)
    shares = np.linspace(0, 1, KNOTS)
    knots = (changes.times_s[:, None] + np.multiply.outer(changes.ramps_s, shares)).ravel()
    # A piece of constant jerk is a parabola, a straight ramp one without a bend.
    grown = shares + np.multiply.outer(changes.bends, shares * (shares - 1))
    levels = ((reached - changes.changes)[:, None] + changes.changes[:, None] * grown).ravel()
    first = float(command.times_s[0])
    drawn: dict[Limit, Line2D] = {}
    for one in binding_limits(command, actuator):
        colour, dashes, _ = MARKS[one.limit]
        inner = knots[(knots > first + one.from_s) & (knots < first + one.to_s)]
        times = np.concatenate(([first + one.from_s], inner, [first + one.to_s]))
        lines = axes.plot(
            times,
            full_speed * np.interp(times, knots, levels),
            color=colour,
            linestyle=dashes,
            linewidth=WIDTH_PT,
            alpha=0.55,
            solid_capstyle="butt",
            dash_capstyle="butt",
            gid=f"limit-{one.limit}",
            zorder=1.5,
        )
        drawn.setdefault(one.limit, lines[0])
    # Beyond its end the panel is empty on the other side of it.
    at_speed = abs(reached[-1]) > abs(reached[-1] - 1)
    legend = axes.legend(
        list(drawn.values()), [MARKS[limit][2] for limit in drawn],
        loc="lower right" if at_speed == (full_speed > 0) else "upper right",
        title="bound by the limit of", title_fontsize=SMALL_PT, handlelength=1.9,
        borderaxespad=0.3,
    )  # fmt: skip
    axes.add_artist(legend)
