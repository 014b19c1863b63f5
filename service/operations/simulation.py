"""The response of plant and actuator to a command over time."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from design.analysis.warnings import DesignWarning, sum_warnings
from design.checks import MIN_VALUE
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting
from design.model.plants.registry import Plant
from design.moves.playback import motion
from design.moves.shaped_commands import ShapedCommand, shaped_command
from design.pipeline import design
from design.sampling.sampled_design import claims_on_samples
from design.shapers.options import ShaperOptions
from design.shapers.refusals import require_small_swings
from design.types import FloatArray
from schemas.base import name_field
from schemas.shapers import ShaperIn
from schemas.simulations import ImpulsesCommand, SimulationRequest, SimulationResponse
from service.operations.found_shaper import on_samples
from service.operations.operation import Operation
from service.operations.subject import subject_of
from service.version import version

if TYPE_CHECKING:
    from matplotlib.figure import Figure

AFTERMATH_PERIODS = 3.0
"""How long a simulation goes on after the last step if no end is given [-]."""


def simulate(request: SimulationRequest) -> SimulationResponse:
    """Play a command and return the motion over time.

    The command is shaped if a shaper is given.

    Parameters
    ----------
    request
        The plant, the actuator and the command.

    Returns
    -------
    SimulationResponse
        The motion, and the impulses that were played.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    InfeasibleDesignError
        If the shaper was not found.
    SolverFailedError
        If none of the solutions found was verified.
    TimeLimitError
        If a solver ran past its time.
    """
    play = _play_of(request)
    moved = motion(play.plant, play.actuator, play.command, request.speed_m_s, play.times_s)
    return SimulationResponse.from_design(moved, play.command, play.warnings)


def simulation_picture(request: SimulationRequest) -> "Figure":
    """Draw the motion that `simulate` returns.

    Parameters
    ----------
    request
        The plant, the actuator and the command.

    Returns
    -------
    Figure
        Command, velocity and payload, and what remains.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    InfeasibleDesignError
        If the shaper was not found.
    SolverFailedError
        If none of the solutions found was verified.
    TimeLimitError
        If a solver ran past its time.
    """
    from design.pictures.simulation_sheet import (  # noqa: PLC0415 - matplotlib takes a second
        simulation_sheet,
        times_to_draw,
    )

    play, speed_m_s = _play_of(request), request.speed_m_s
    plant, actuator, command = play.plant, play.actuator, play.command
    moved = motion(plant, actuator, command, speed_m_s, times_to_draw(play.times_s, command))
    return simulation_sheet(plant, actuator, command, speed_m_s, moved, play.warnings, version())


class _Play(NamedTuple):
    """What is played, when, and what to know of it."""

    plant: Plant
    actuator: Actuator
    command: Impulses
    times_s: FloatArray
    warnings: tuple[DesignWarning, ...]


def _play_of(request: SimulationRequest) -> _Play:
    plant, actuator = subject_of(request)
    with name_field("command"):
        played = request.command.to_design(request.speed_m_s)
    warnings: list[DesignWarning] = []
    if isinstance(request.command, ImpulsesCommand):
        warnings += sum_warnings(played)
    if request.shaper is not None:
        with name_field("shaper"):
            options = request.shaper.options()
        shaped = _shape_command(played, plant, actuator, request.shaper, options)
        played, warnings = shaped.impulses, [*warnings, *shaped.warnings]
    end = request.until_s
    if end is None:
        last = float(played.times_s[-1]) + actuator.dead_time_s
        if isinstance(plant, Hoisting):
            last, mode = max(last, plant.end_s), plant.last.mode
        else:
            mode = plant.mode
        end = last + AFTERMATH_PERIODS * mode.period_s
    first = min(0.0, float(played.times_s[0]))
    times_s = np.linspace(first, max(end, first + MIN_VALUE), request.points)
    return _Play(plant, actuator, played, times_s, tuple(warnings))


def _shape_command(
    command: Impulses,
    plant: Plant,
    actuator: Actuator,
    shaper: ShaperIn,
    options: ShaperOptions | None,
) -> ShapedCommand:
    require_small_swings(shaper.shaper_kind(), "simulations")
    found, claims = design(plant, actuator, shaper.shaper_kind(), options), None
    if shaper.sample_time_s is not None:
        claims = claims_on_samples(found, shaper.sample_tolerance)
        found, _ = on_samples(found, plant, actuator, shaper, shaper.sample_time_s)
    return shaped_command(command, found, plant.modes, actuator, claims)


OPERATION = Operation(
    request=SimulationRequest,
    response=SimulationResponse,
    run=simulate,
    draw=simulation_picture,
)
