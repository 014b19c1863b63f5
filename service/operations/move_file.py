"""One move as a program."""

from typing import TYPE_CHECKING

from design.errors import InvalidInputError
from design.model.plants.hoisting import Hoisting
from design.moves.while_hoisting import require_while_hoisting
from schemas.maneuvers import ManeuverRequest
from schemas.plants import FreeBodyIn
from service.operations.maneuver import move_of, program_of, require_no_force
from service.version import version

if TYPE_CHECKING:
    from design.tables.rows import Real


def move_file(request: ManeuverRequest, format_name: str, real: "Real" = "LREAL") -> bytes:
    """Design a move and return it as a program.

    Parameters
    ----------
    request
        The plant, the actuator, the shaper and how far.
    format_name
        Name of a format that plays moves.
    real
        Type of numbers in Structured Text.

    Returns
    -------
    bytes
        The file.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the format plays no moves.
    InfeasibleDesignError
        If no such move was found.
    SolverFailedError
        If no move found was verified.
    """
    from design.export.move import move_blocks  # noqa: PLC0415 - answers need none
    from design.export.registry import EXPORTS  # noqa: PLC0415

    write = EXPORTS[format_name].move
    if write is None:
        raise InvalidInputError(
            "format", format_name, "one that plays moves", code="format_without_moves"
        )
    if isinstance(request.plant, FreeBodyIn):
        require_no_force("format", format_name)
    plant, actuator, move = move_of(request)
    require_while_hoisting(
        "format",
        format_name,
        "one of an answer, such as json,",
        holds=not isinstance(plant, Hoisting),
    )
    blocks = move_blocks(
        move,
        plant,
        actuator,
        kind=request.shaper.kind,
        request_json=request.canonical(),
        version=version(),
        real=real,
        program=program_of(request, plant, actuator, move),
    )
    return write(blocks)
