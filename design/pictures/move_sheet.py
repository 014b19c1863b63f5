"""One move from rest to rest on one page: velocity and payload, the unshaped move beside it."""

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from design.analysis.ramp_figures import end_of_reference, moving_time_s
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.commands import pulse
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting
from design.model.plants.registry import Plant
from design.moves.maneuvers import Maneuver
from design.pictures.head import HEAD_IN, TITLE_IN, Fact, certificate_fact, note_of, write_head
from design.pictures.limit_marks import mark_limits
from design.pictures.sheet import Sheet
from design.pictures.style import DEEP, GREY, INK, house_style, legend_above, name_panel
from design.pictures.time_panels import last_event, mark_end, mark_switches, time_grid
from design.pictures.words import actuator_in_words, plant_in_words, residual_in_words
from design.response.closed_form import History, history
from design.response.hoisting_simulation import hoisting_history
from design.solving.textbooks import unshaped_move
from design.types import FloatArray

SIZE_IN = (10.0, 6.9)
"""Width and height [in]."""

RIGHT = 0.975
"""Margin of the page, as a share of its width [-]."""


def move_sheet(name: str, plant: Plant, actuator: Actuator, move: Maneuver, version: str) -> Figure:
    """Return the sheet of one move.

    Parameters
    ----------
    name
        The shaper's kind, as the registry names it.
    plant, actuator
        What moves, of one mode or on a cable that is hoisted, and its drive.
    move
        The move.
    version
        Of the program.

    Returns
    -------
    Figure
        10 x 6.9 in. Over one time axis [s]: the command, what limits make of it with the limit that
        binds, and the velocity of the actuator [m/s]; the payload's deflection, of the move and of
        the unshaped one [m].
    """
    times_s = _times(move, plant, actuator)
    with house_style():
        figure = Sheet(figsize=SIZE_IN)
        write_head(figure, name, version, _facts(plant, actuator, move), note_of(move.warnings))
        rows = figure.add_gridspec(
            2, 1, left=0.09, right=RIGHT, bottom=0.08, top=1 - (HEAD_IN + TITLE_IN) / SIZE_IN[1],
            hspace=0.24,
        )  # fmt: skip
        top = figure.add_subplot(rows[0])
        bottom = figure.add_subplot(rows[1], sharex=top)
        _draw_velocity(top, plant, actuator, move, times_s)
        _draw_payload(bottom, plant, actuator, move, times_s)
        top.set_xlim(float(times_s[0]), float(times_s[-1]))
        top.tick_params(labelbottom=False)
        for axes in (top, bottom):
            mark_switches(axes, move.command, actuator)
        figure.align_ylabels([top, bottom])
        return figure


def _draw_velocity(
    axes: Axes, plant: Plant, actuator: Actuator, move: Maneuver, times_s: FloatArray
) -> None:
    name_panel(axes, "velocity", "Command and actuator")
    speed = move.direction * move.speed_m_s
    moves = _history(move.command, plant, actuator, times_s)
    axes.plot(
        times_s, speed * moves.command, color=INK, linewidth=1.0, linestyle=(0, (4, 2)),
        label="command",
    )  # fmt: skip
    if isinstance(actuator, RateLimited):
        mark_limits(axes, move.command, actuator, speed)
    axes.plot(times_s, speed * moves.velocity, color=DEEP, label="velocity", gid="velocity-line")
    axes.margins(y=0.14)
    axes.set_ylabel("velocity [m/s]")
    legend_above(axes)


def _draw_payload(
    axes: Axes, plant: Plant, actuator: Actuator, move: Maneuver, times_s: FloatArray
) -> None:
    name_panel(axes, "payload", "Payload")
    last = end_of_reference(move.command, actuator)
    shaped = _deflection_m(move.command, plant, actuator, move, times_s)
    unshaped = _deflection_m(_unshaped(actuator, move), plant, actuator, move, times_s)
    axes.plot(
        times_s, unshaped, color=GREY, linewidth=1.2, linestyle=(0, (5, 2)), label="unshaped move"
    )
    axes.plot(times_s, shaped, color=DEEP, label="this move", gid="shaped")
    highest = max(float(np.abs(unshaped).max()), float(np.abs(shaped).max()), 1e-300)
    axes.set_ylim(-1.12 * highest, 1.42 * highest)
    mark_end(axes, last, last_event(actuator), times_s)
    axes.set_ylabel("deflection [m]")
    axes.set_xlabel("time [s]")
    legend_above(axes)


def _unshaped(actuator: Actuator, move: Maneuver) -> Impulses:
    travel_s = abs(move.distance_m) / move.speed_m_s
    if isinstance(actuator, RateLimited):
        return unshaped_move(actuator, travel_s)
    return pulse(travel_s)


def _times(move: Maneuver, plant: Plant, actuator: Actuator) -> FloatArray:
    """Return the times to draw; while the cable is hoisted, until that is over too."""
    if not isinstance(plant, Hoisting):
        return time_grid(move.command, plant.mode, actuator)
    times_s = time_grid(move.command, plant.last.mode, actuator)
    end_s = max(float(times_s[-1]), plant.end_s)
    return np.union1d(times_s, np.linspace(float(times_s[0]), end_s, times_s.size))


def _history(command: Impulses, plant: Plant, actuator: Actuator, times_s: FloatArray) -> History:
    """Return what a command does; the deflection is over the speed [s]."""
    if isinstance(plant, Hoisting):
        return hoisting_history(command, plant, actuator, times_s)
    moves = history(command, plant.mode, actuator, times_s)
    return replace(moves, deflection=moves.deflection / plant.mode.natural_frequency_rad_s)


def _deflection_m(
    command: Impulses, plant: Plant, actuator: Actuator, move: Maneuver, times_s: FloatArray
) -> FloatArray:
    """Return the deflection under a command, with what swings already at the first step."""
    deflection_s = _history(command, plant, actuator, times_s).deflection
    if move.swing is not None:
        mode = plant.mode
        pole = mode.pole_rad_s
        # A vector V rings as -Im(V exp(s t)) / Im(s).
        free = np.exp(pole * (times_s - command.times_s[0])) * move.swing.vector(mode)
        deflection_s = deflection_s - free.imag / pole.imag
    deflection: FloatArray = move.direction * move.speed_m_s * deflection_s
    return deflection


def _facts(plant: Plant, actuator: Actuator, move: Maneuver) -> list[Fact]:
    """Return what was designed for what, and whether it holds."""
    end = moving_time_s(move.command, actuator)
    bound = "" if move.lower_bound_s is None else f"none before {move.lower_bound_s:.4g} s"
    claims = [claim.quantity for claim in move.certificate.claims]
    return [
        Fact("plant", *plant_in_words(plant)),
        Fact("actuator", *actuator_in_words(actuator)),
        Fact(last_event(actuator), f"{end:.4g} s", bound),
        Fact(
            "distance", f"{move.distance_m:.4g} m", f"residual {residual_in_words(move.residual)}"
        ),
        certificate_fact(claims, verified=move.certificate.verified, for_ideal=move.for_ideal),
    ]
