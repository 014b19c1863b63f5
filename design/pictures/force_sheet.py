"""One move of a free body on one page: force, way and speed, and what vibrates."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from design.model.actuators.ideal import Ideal
from design.model.plants.free_body import FreeBody
from design.moves.force_moves import ForceMove
from design.pictures.head import HEAD_IN, TITLE_IN, Fact, certificate_fact, write_head
from design.pictures.sheet import Sheet
from design.pictures.style import BRIGHT, DEEP, GREY, INK, house_style, legend_above, name_panel
from design.pictures.time_panels import mark_end, mark_switches, time_grid
from design.pictures.words import modes_in_words, plant_in_words, residual_in_words
from design.response.closed_form import history
from design.types import FloatArray

SIZE_IN = (10.0, 6.9)
"""Width and height [in]."""


def force_sheet(name: str, plant: FreeBody, move: ForceMove, version: str) -> Figure:
    """Return the sheet of one move by force.

    Parameters
    ----------
    name
        The shaper's kind, as the registry names it.
    plant, move
        What moves, and its move.
    version
        Of the program.

    Returns
    -------
    Figure
        10 x 6.9 in. Over one time axis [s]: the force [N]; the way of the whole [m]; the vibration
        of each mode over that of one step of the force [-].
    """
    slowest = min(plant.excited, key=lambda mode: mode.natural_frequency_rad_s)
    times_s = time_grid(move.command, slowest, Ideal())
    claims = sorted({claim.quantity for claim in move.certificate.claims})
    bound = f"none below {move.lower_bound_s:.4g} s"
    burn = "" if move.least_burn_s is None else f"none below {move.least_burn_s:.4g} s"
    with house_style():
        figure = Sheet(figsize=SIZE_IN)
        facts = [
            Fact("plant", *plant_in_words(plant)),
            Fact("move", f"{move.duration_s:.4g} s", bound),
            Fact("force is on", f"{move.burn_s:.4g} s", burn),
            Fact(
                "distance",
                f"{move.distance_m:.4g} m",
                f"residual {residual_in_words(move.residual)}",
            ),
            certificate_fact(claims, verified=move.certificate.verified, for_ideal=False),
        ]
        write_head(figure, name, version, facts, "")
        rows = figure.add_gridspec(
            3, 1, left=0.09, right=0.975, bottom=0.08,
            top=1 - (HEAD_IN + TITLE_IN) / SIZE_IN[1], hspace=0.42,
        )  # fmt: skip
        top = figure.add_subplot(rows[0])
        middle, bottom = (figure.add_subplot(rows[row], sharex=top) for row in (1, 2))
        _draw_force(top, move, times_s)
        _draw_way(middle, plant, move, times_s)
        _draw_modes(bottom, plant, move, times_s)
        top.set_xlim(float(times_s[0]), float(times_s[-1]))
        for axes in (top, middle, bottom):
            mark_switches(axes, move.command, Ideal())
        for axes in (top, middle):
            axes.tick_params(labelbottom=False)
        figure.align_ylabels([top, middle, bottom])
        return figure


def _draw_force(axes: Axes, move: ForceMove, times_s: FloatArray) -> None:
    name_panel(axes, "force", "Force")
    levels = np.concatenate(([0.0], np.cumsum(move.command.amplitudes)))
    found = levels[np.searchsorted(move.command.times_s, times_s, side="right")]
    axes.plot(times_s, move.direction * move.force_n * found, color=INK, gid="force")
    axes.margins(y=0.14)
    axes.set_ylabel("force [N]")


def _draw_way(axes: Axes, plant: FreeBody, move: ForceMove, times_s: FloatArray) -> None:
    name_panel(axes, "way", "The whole")
    since = np.maximum(times_s[:, None] - move.command.times_s, 0.0)
    per_kg = move.direction * move.force_n / plant.mass_kg
    axes.plot(times_s, per_kg * (since**2 / 2) @ move.command.amplitudes, color=DEEP, gid="way")
    axes.set_ylabel("way [m]")


def _draw_modes(axes: Axes, plant: FreeBody, move: ForceMove, times_s: FloatArray) -> None:
    name_panel(axes, "modes", "Vibration")
    several = len(plant.excited) > 1
    names = modes_in_words(plant.excited) if several else ["the mode"]
    colours = (DEEP, BRIGHT, GREY, INK)
    highest = 0.0
    for number, (mode, name) in enumerate(zip(plant.excited, names, strict=True)):
        # A force step moves a mode as a step of velocity rings: its rate over w is the deflection.
        found = move.direction * history(move.command, mode, Ideal(), times_s).deflection
        highest = max(highest, float(np.abs(found).max()))
        colour = colours[number % len(colours)]
        axes.plot(times_s, found, color=colour, label=name, gid=f"mode-{number}")
    axes.set_ylim(-1.12 * highest, 1.42 * highest)
    mark_end(axes, move.duration_s, "last switch", times_s)
    axes.set_ylabel("rate\n[share of a step's]")
    axes.set_xlabel("time [s]")
    legend_above(axes)
