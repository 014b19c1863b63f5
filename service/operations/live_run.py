"""A run whose commands are shaped live: its machine, and what each event led to."""

import dataclasses
from typing import NoReturn

from design.errors import InvalidInputError
from design.live.machine import (
    LiveKind,
    LiveMachine,
    live_drive,
    live_plant,
    require_kind_with_limit,
)
from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.rig.crane import MAX_SWING_RAD, Crane
from design.rig.live_events import Asked, LiveAnswer
from schemas.base import name_field
from schemas.certificates import CertificateOut
from schemas.run_events import HappeningIn
from schemas.runs import EventOut, LiveEventOut, LiveShaping, RunRequest
from schemas.shaper_request import ShaperRequest
from service.operations.run_crane import Swinging, subject_at_length


def live_machine(
    request: RunRequest,
    shaping: LiveShaping,
    crane: Crane,
    swinging: Swinging,
    plant: Plant,
    actuator: Actuator,
) -> LiveMachine:
    """Return the machine of a run that is shaped live.

    Parameters
    ----------
    request, shaping
        The run, and how it is shaped.
    crane, swinging
        What is driven.
    plant, actuator
        Of the request.

    Returns
    -------
    LiveMachine
        Of both axes.

    Raises
    ------
    InvalidInputError
        If drive, plant, kind or an event is not served live.
    """
    drive, subject = live_drive(actuator), live_plant(plant)
    if swinging.cable is not None:
        subject = subject_at_length(crane, swinging.cable, crane.cable_length_m)
    with name_field("shaping"):
        kind = live_kind(shaping.shaper)
    if request.played is not None:
        refuse_live("played", "a course")
    for number, event in enumerate(request.events or ()):
        if event.move is not None:
            refuse_live(f"events.{number}.move", "a distance")
    if request.deflection_limit is not None:
        with name_field("shaping.shaper"):
            require_kind_with_limit(kind)
    # A swing of an angle has the deflection L times it; an unshaped step's is v / w.
    length = crane.cable_length_m
    step_m = request.speed_m_s / crane.slowest_rad_s
    return LiveMachine(
        plant=subject,
        actuator=drive,
        kind=kind,
        largest_swing=MAX_SWING_RAD * length / step_m if crane.load is None else None,
        sample_time_s=shaping.sample_time_s,
        deflection_limit=request.deflection_limit,
    )


def asked_live(request: RunRequest) -> dict[int, Asked]:
    """Return stops and kinds of shapers among the events, by their numbers.

    Parameters
    ----------
    request
        The run.

    Returns
    -------
    dict
        Empty where there are none.

    Raises
    ------
    InvalidInputError
        If one is out of its range or not served live, or it or a limit to the deflection is not
        in live mode.
    """
    found = {}
    live = isinstance(request.shaping, LiveShaping)
    for number, event in enumerate(request.events or ()):
        with name_field(f"events.{number}"):
            stop = event.emergency()
            if not live and stop is not None:
                refuse_without_live("stop", event.stop)
            wanted = stop or next_kind(event, live=live)
            if wanted is not None:
                found[number] = Asked(at_s=event.at_s, request=wanted)
    if request.deflection_limit is not None and not live:
        refuse_without_live("deflection_limit", request.deflection_limit)
    return found


def next_kind(happening: HappeningIn, *, live: bool) -> LiveKind | None:
    """Return the kind that commands are solved by from an event on.

    Parameters
    ----------
    happening
        What happens.
    live
        Whether commands are solved anew at each event.

    Returns
    -------
    LiveKind or None
        None where the event is something else.

    Raises
    ------
    InvalidInputError
        If the kind or an option is not served live, or nothing is solved anew.
    """
    if happening.shaper is None or happening.move is not None:
        return None
    if not live:
        refuse_without_live("shaper", happening.shaper.kind)
    return live_kind(happening.shaper)


def refuse_without_live(field: str, value: object) -> NoReturn:
    """Raise InvalidInputError: a field serves live mode alone.

    Parameters
    ----------
    field, value
        Its path, and what it is.

    Raises
    ------
    InvalidInputError
        Always.
    """
    raise InvalidInputError(
        field,
        value,
        "left out without shaping of mode live, which solves the command from the state",
        code="only_shaped_live",
    )


def refuse_live(field: str, value: object) -> None:
    """Refuse what is not shaped live.

    Parameters
    ----------
    field, value
        What was given, and where.

    Raises
    ------
    InvalidInputError
        Always.
    """
    raise InvalidInputError(
        field,
        value,
        "left out in live mode, which shapes the presses of buttons; a delay line serves it",
        code="not_shaped_live",
    )


def live_kind(shaper: ShaperRequest) -> LiveKind:
    """Return what plans keep by a shaper of a request.

    Parameters
    ----------
    shaper
        Of the request.

    Returns
    -------
    LiveKind
        Its kind, and whether its slope is zero too.

    Raises
    ------
    InvalidInputError
        If the kind or an option is not served live.
    """
    with name_field("shaper"):
        options = shaper.options()
        slope = bool(getattr(options, "slope", False))
        kind = LiveKind(name=shaper.kind, slope=slope)
        for field in dataclasses.fields(options):
            value = getattr(options, field.name)
            if field.name != "slope" and value != field.default:
                _refuse_option(field.name, value)
        if shaper.sample_time_s is not None:
            _refuse_option("sample_time_s", shaper.sample_time_s)
    return kind


def _refuse_option(name: str, value: object) -> None:
    raise InvalidInputError(
        name,
        value,
        "left out in live mode, where switches are as early as the state allows",
        code="option_not_live",
    )


def event_outs(
    request: RunRequest, lasts_s: list[float], live: dict[int, LiveAnswer] | None
) -> list[EventOut]:
    """Return the answers of the events.

    Parameters
    ----------
    request
        The run.
    lasts_s
        When the last switch of each event is [s].
    live
        What each led to, in live mode.

    Returns
    -------
    list of EventOut
        In their order; in live mode with certificates.
    """
    times_s = [event.at_s for event in request.events or ()]
    outs = [
        EventOut(at_s=at_s, last_switch_s=last_s)
        for at_s, last_s in zip(times_s, lasts_s, strict=True)
    ]
    if live is None or not isinstance(request.shaping, LiveShaping):
        return outs
    return [
        LiveEventOut(
            **dict(out),
            certificate=CertificateOut.from_design(
                live[number].certificate, given=not live[number].ideal
            ),
            fallback=live[number].fallback,
        )
        for number, out in enumerate(outs)
    ]
