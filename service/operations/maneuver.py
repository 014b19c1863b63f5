"""A whole move from rest to rest."""

from typing import TYPE_CHECKING, NoReturn

from design.analysis.claims_found import zeros_of
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.plants.free_body import FreeBody
from design.model.plants.hoisting import Hoisting
from design.model.plants.registry import Plant
from design.moves.force_moves import ForceMove, force_move
from design.moves.hoisting_moves import hoisting_maneuver
from design.moves.maneuvers import Maneuver, maneuver
from design.moves.programs import Program, program
from design.moves.while_hoisting import require_while_hoisting
from design.shapers.options import ShaperOptions
from schemas.base import name_field
from schemas.maneuvers import ManeuverRequest, ManeuverResponse
from schemas.plants import FreeBodyIn
from schemas.samples import continuous_options
from service.operations.operation import Operation
from service.operations.subject import subject_of
from service.version import version

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NO_MOVE_ON_SAMPLES = (
    "a move's distance is met exactly by times between the samples; the field beside shaper gives "
    "its program on samples"
)


def whole_move(request: ManeuverRequest) -> ManeuverResponse:
    """Design a move from rest to rest, and its program where asked."""
    if isinstance(request.plant, FreeBodyIn):
        _, forced = _forced(request, request.plant)
        return ManeuverResponse.from_force(request.shaper.kind, forced, version())
    plant, actuator, move = move_of(request)
    played = program_of(request, plant, actuator, move)
    return ManeuverResponse.from_design(request.shaper.kind, move, played, version())


def move_picture(request: ManeuverRequest) -> "Figure":
    """Draw the move that `whole_move` designs.

    Parameters
    ----------
    request
        The plant, the actuator, the shaper and how far.

    Returns
    -------
    Figure
        Command, velocity and payload.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    InfeasibleDesignError
        If no such move was found.
    SolverFailedError
        If no move found was verified.
    """
    from design.pictures.force_sheet import force_sheet  # noqa: PLC0415 - matplotlib takes a second
    from design.pictures.move_sheet import move_sheet  # noqa: PLC0415

    if isinstance(request.plant, FreeBodyIn):
        return force_sheet(request.shaper.kind, *_forced(request, request.plant), version())
    plant, actuator, move = move_of(request)
    return move_sheet(request.shaper.kind, plant, actuator, move, version())


def move_of(request: ManeuverRequest) -> tuple[Plant, Actuator, Maneuver]:
    """Design the move of a request.

    Returns
    -------
    Plant
        What moves.
    Actuator
        What drives it.
    Maneuver
        The move.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    InfeasibleDesignError
        If no such move was found.
    SolverFailedError
        If no move found was verified.
    """
    plant, actuator = subject_of(request)
    with name_field("shaper"):
        options = continuous_options(request.shaper, NO_MOVE_ON_SAMPLES)
    initial = None
    if request.initial is not None:
        with name_field("initial"):
            initial = request.initial.to_design()
    for name, value in (("force_n", request.force_n), ("duration_s", request.duration_s)):
        if value is not None:
            raise InvalidInputError(
                name,
                value,
                "left out where the plant is not of kind free_body",
                code="force_on_held_plant",
            )
    speed_m_s = _given("speed_m_s", request.speed_m_s)
    if isinstance(plant, Hoisting):
        return plant, actuator, _hoisted(request, plant, actuator, speed_m_s, options)
    if request.retime is not None:
        raise InvalidInputError(
            "retime",
            request.retime,
            "left out where the plant is not of kind hoisting",
            code="retime_without_hoisting",
        )
    move = maneuver(
        plant,
        actuator,
        request.shaper.shaper_kind(),
        speed_m_s=speed_m_s,
        pulse_s=request.pulse_s,
        distance_m=request.distance_m,
        initial=initial,
        joint=request.joint,
        options=options,
    )
    return plant, actuator, move


def _hoisted(
    request: ManeuverRequest,
    plant: Hoisting,
    actuator: Actuator,
    speed_m_s: float,
    options: ShaperOptions | None,
) -> Maneuver:
    """Design the move of a request while the cable is hoisted."""
    for name, value in (
        ("initial", request.initial),
        ("joint", request.joint or None),
        ("sample_time_s", request.sample_time_s),
    ):
        given = "a swing" if name == "initial" else value
        require_while_hoisting(name, given, "left out", holds=value is None)
    return hoisting_maneuver(
        plant,
        actuator,
        request.shaper.shaper_kind(),
        speed_m_s=speed_m_s,
        pulse_s=request.pulse_s,
        distance_m=request.distance_m,
        retime=request.retime or "both",
        options=options,
    )


def _forced(request: ManeuverRequest, body: FreeBodyIn) -> tuple[FreeBody, ForceMove]:
    """Design the move of a free body."""
    _, actuator = subject_of(request)
    with name_field("plant"):
        plant = body.to_design()
    for name, value in (
        ("speed_m_s", request.speed_m_s),
        ("pulse_s", request.pulse_s),
        ("initial", None if request.initial is None else "a swing"),
        ("joint", request.joint or None),
        ("retime", request.retime),
        ("sample_time_s", request.sample_time_s),
    ):
        if value is not None:
            require_no_force(name, value)
    with name_field("shaper"):
        options = continuous_options(request.shaper, NO_MOVE_ON_SAMPLES)
    return plant, force_move(
        plant,
        actuator,
        request.shaper.shaper_kind(),
        force_n=_given("force_n", request.force_n),
        distance_m=_given("distance_m", request.distance_m),
        duration_s=request.duration_s,
        options=options,
    )


def require_no_force(name: str, value: object) -> NoReturn:
    """Raise that a field is not served for a free body.

    Parameters
    ----------
    name, value
        Field that the error names, and what it is.

    Raises
    ------
    InvalidInputError
        Always.
    """
    raise InvalidInputError(name, value, "left out for a free body", code="not_for_free_body")


def _given(name: str, value: float | None) -> float:
    if value is None:
        raise InvalidInputError(name, None, "given for this plant", code="field_not_given")
    return value


def program_of(
    request: ManeuverRequest, plant: Plant, actuator: Actuator, move: Maneuver
) -> Program | None:
    """Return a move on the samples of its request.

    Parameters
    ----------
    request
        The request.
    plant, actuator, move
        What moves, what drives it, and the move.

    Returns
    -------
    Program or None
        None where the request has no sample time.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule.
    """
    if request.sample_time_s is None:
        return None
    return program(
        move.command,
        plant.mode,
        actuator,
        move.direction * move.speed_m_s,
        request.sample_time_s,
        move.swing,
        zeros_of(move.certificate),
    )


OPERATION = Operation(
    request=ManeuverRequest, response=ManeuverResponse, run=whole_move, draw=move_picture
)
