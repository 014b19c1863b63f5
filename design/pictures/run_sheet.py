"""A run of the crane on one page: commands and velocities, the swing, and the way from above."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from design.model.plants.registry import Plant
from design.pictures.head import HEAD_IN, TITLE_IN, Fact, note_of, write_head
from design.pictures.sheet import Sheet
from design.pictures.style import BRIGHT, DEEP, GREY, INK, house_style, legend_above, name_panel
from design.pictures.words import actuator_in_words, plant_in_words, residual_in_words
from design.rig.crane import AXES, AxisName
from design.rig.runs import Run, Scenario

SIZE_IN = (10.0, 6.9)
"""Width and height [in]."""


@dataclass(frozen=True, slots=True)
class _Stroke:
    """How the curves of an axis are drawn."""

    axis: AxisName
    column: int
    colour: str


_STROKES = (_Stroke("x", 0, DEEP), _Stroke("y", 1, BRIGHT))


def run_sheet(plant: Plant, scenario: Scenario, run: Run, version: str) -> Figure:
    """Return the sheet of a run.

    Parameters
    ----------
    plant
        What swings.
    scenario
        What was done.
    run
        What happened.
    version
        Of the program.

    Returns
    -------
    Figure
        10 x 6.9 in. Over one time axis [s]: commands and velocities [m/s]; deflections [m] and, if
        it is hoisted, the length of the cable [m]. Where both axes are driven, the way of trolley
        and load from above [m].
    """
    driven = [one for one in _STROKES if one.axis in run.commands] or [_STROKES[0]]
    with house_style():
        figure = Sheet(figsize=SIZE_IN)
        write_head(figure, "run", version, _facts(plant, scenario, run), note_of(run.warnings))
        both = len(driven) == len(AXES)
        grid = figure.add_gridspec(
            2, 2 if both else 1, left=0.09, right=0.925, bottom=0.08, wspace=0.3, hspace=0.24,
            top=1 - (HEAD_IN + TITLE_IN) / SIZE_IN[1], width_ratios=[3, 2] if both else [1],
        )  # fmt: skip
        top = figure.add_subplot(grid[0, 0])
        bottom = figure.add_subplot(grid[1, 0], sharex=top)
        _draw_velocity(top, driven, run)
        _draw_swing(bottom, driven, scenario, run)
        top.set_xlim(0.0, float(run.track.times_s[-1]))
        top.tick_params(labelbottom=False)
        for axes in (top, bottom):
            if run.last_switch_s <= run.track.times_s[-1]:
                axes.axvline(run.last_switch_s, color=INK, linewidth=0.9, linestyle=(0, (1, 1.6)))
        if both:
            _draw_way(figure.add_subplot(grid[:, 1]), run)
        figure.align_ylabels([top, bottom])
        return figure


def _facts(plant: Plant, scenario: Scenario, run: Run) -> list[Fact]:
    swing = np.hypot(*run.track.load_m[:, :2].T).max()
    model = f"{scenario.crane.model} model"
    remains = ("not defined", "it has died away")
    if run.residual is not None:
        remains = residual_in_words(run.residual), "of an unshaped step"
    kind = "a delay line" if scenario.shaper is not None else "no shaping"
    if scenario.solved is not None:
        kind = "shaped live"
    if scenario.moves:
        kind = "whole moves" if scenario.shaper is None else "whole moves, delay line"
    return [
        Fact("plant", *plant_in_words(plant)),
        Fact("actuator", *actuator_in_words(scenario.drive)),
        Fact("last switch", f"{run.last_switch_s:.4g} s", f"{kind}\n{scenario.speed_m_s:.3g} m/s"),
        Fact("largest deflection", f"{swing:.3g} m", model),
        Fact("remains", *remains),
    ]


def _draw_velocity(axes: Axes, driven: list[_Stroke], run: Run) -> None:
    name_panel(axes, "velocity", "Command and actuator")
    times = run.track.times_s
    for one in driven:
        axes.plot(
            times, run.command_m_s[:, one.column], color=INK, linewidth=1.0,
            linestyle=(0, (4, 2)), drawstyle="steps-post",
            label="command" if one is driven[0] else None, gid=f"command_{one.axis}",
        )  # fmt: skip
        axes.plot(
            times, run.track.velocity_m_s[:, one.column], color=one.colour,
            label=one.axis, gid=f"velocity_{one.axis}",
        )  # fmt: skip
    axes.margins(y=0.14)
    axes.set_ylabel("velocity [m/s]")
    legend_above(axes)


def _draw_swing(axes: Axes, driven: list[_Stroke], scenario: Scenario, run: Run) -> None:
    name_panel(axes, "payload", "Payload")
    times = run.track.times_s
    for one in driven:
        axes.plot(
            times, run.track.load_m[:, one.column], color=one.colour,
            label=one.axis, gid=f"deflection_{one.axis}",
        )  # fmt: skip
    axes.margins(y=0.14)
    axes.set_ylabel("deflection [m]")
    axes.set_xlabel("time [s]")
    legend_above(axes)
    if scenario.hoists:
        length = axes.twinx()
        length.set_label("cable")
        length.grid(visible=False)
        length.plot(
            times, run.track.cable_length_m, color=GREY, linestyle=(0, (5, 2)), gid="cable_length"
        )
        length.set_ylabel("cable (dashed) [m]")


def _draw_way(axes: Axes, run: Run) -> None:
    name_panel(axes, "way", "From above")
    place = run.track.position_m
    load = place + run.track.load_m[:, :2]
    axes.plot(*load.T, color=BRIGHT, linewidth=1.0, label="payload", gid="payload_way")
    axes.plot(*place.T, color=DEEP, label="trolley", gid="trolley_way")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    legend_above(axes, columns=1)
