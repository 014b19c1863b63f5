"""The machine of a run as a program that shapes live commands."""

from dataclasses import replace
from typing import TYPE_CHECKING

from design.errors import InvalidInputError
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from schemas.base import name_field
from schemas.runs import LiveShaping, RunRequest
from service.operations.live_run import live_kind, refuse_live
from service.operations.subject import subject_of
from service.version import version

if TYPE_CHECKING:
    from design.tables.rows import Real


def live_file(request: RunRequest, format_name: str, real: "Real" = "LREAL") -> bytes:
    """Return the machine of a run as a block that shapes live commands.

    Parameters
    ----------
    request
        A run in live mode; of its events the cable lengths count, between which the block works.
    format_name
        Name of a format that holds blocks.
    real
        Type of numbers in Structured Text.

    Returns
    -------
    bytes
        The file.

    Raises
    ------
    InvalidInputError
        If the run is not in live mode, or no block serves its drive, plant or kind.
    """
    from design.export.live_blocks.block import live_block  # noqa: PLC0415 - answers need none
    from design.export.registry import EXPORTS  # noqa: PLC0415

    write = EXPORTS[format_name].live
    if write is None:
        raise InvalidInputError(
            "format", format_name, "one that holds blocks", code="format_without_blocks"
        )
    if not isinstance(request.shaping, LiveShaping):
        raise InvalidInputError(
            "shaping.mode",
            "none" if request.shaping is None else request.shaping.mode,
            f'"live" for a file of format {format_name}: it holds the block that shapes live',
            code="block_needs_live",
        )
    if request.load is not None:
        raise InvalidInputError(
            "load",
            "a load under the hook",
            "left out for a block, which knows one mode",
            code="load_without_block",
        )
    if request.played is not None:
        refuse_live("played", "a course")
    with name_field("shaping"):
        kind = live_kind(request.shaping.shaper)
    if request.deflection_limit is not None:
        raise InvalidInputError(
            "deflection_limit",
            request.deflection_limit,
            "left out for a block, which plans without it",
            code="limit_without_block",
        )
    plant, actuator = subject_of(request)
    lengths = []
    for number, event in enumerate(request.events or ()):
        with name_field(f"events.{number}"):
            event.require_one()
            if event.cable_length_m is not None:
                lengths.append(_length_of(event.cable_length_m, plant))
    block = live_block(
        plant,
        actuator,
        kind=kind.name,
        cycle_s=request.shaping.sample_time_s,
        lengths_m=lengths,
        speed_m_s=request.speed_m_s,
        request_json=request.canonical(),
        version=version(),
        real=real,
    )
    return write(block)


def _length_of(length_m: float, plant: Plant) -> float:
    """Return the length of an event, whose plant must have a cable."""
    if not isinstance(plant, Pendulum):
        raise InvalidInputError(
            "cable_length_m",
            length_m,
            "left out where the plant has no cable",
            code="hoist_needs_cable",
        )
    return replace(plant, cable_length_m=length_m).cable_length_m
