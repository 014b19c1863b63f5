"""Hoists as events of live shaping: what is served, and the course that one makes."""

import math
from dataclasses import replace

from design.errors import InvalidInputError
from design.live.hoist import Hoist, HoistRequest
from design.live.hoist_planning import begin_hoist
from design.live.hoist_witness import begin_witness
from design.live.machine import LiveKind, LiveMachine
from design.live.planning import Task
from design.live.state import AxisState
from design.live.witnesses import Witnesses
from design.model.plants.hoisting import MAX_HOISTING_TURN_RAD, MAX_LENGTH_RATIO
from design.model.plants.pendulum import Pendulum


def require_hoisted_kind(field: str, value: object, kind: LiveKind) -> None:
    """Check that plans of a kind know hoists.

    Parameters
    ----------
    field, value
        What was given.
    kind
        What plans leave.

    Raises
    ------
    InvalidInputError
        If it claims a zero slope, or an ideal drive.
    """
    if kind.slope or kind.ideal:
        raise InvalidInputError(
            field,
            value,
            "with numzv alone where the cable is hoisted in live mode: plans leave zero vibration "
            f"there, not what {kind.name} claims" + (" with zero slope" if kind.slope else ""),
            code="kind_not_hoisted_live",
        )


def hoist_of(
    machine: LiveMachine, before: Hoist | None, kind: LiveKind, at_s: float, request: HoistRequest
) -> Hoist:
    """Return the hoist that an event begins.

    Parameters
    ----------
    machine
        The machine.
    before
        The latest hoist, which may last yet: the new one ends it.
    kind
        What plans leave.
    at_s
        When it begins [s].
    request
        What is asked for.

    Returns
    -------
    Hoist
        From the length then.

    Raises
    ------
    InvalidInputError
        If the plant has no single cable, the kind is not served, or the course is beyond
        `design.model.plants.hoisting`.
    """
    if not isinstance(machine.plant, Pendulum):
        raise InvalidInputError(
            "cable_length_m",
            request.cable_length_m,
            "left out in live mode where more than a single load swings on one cable: a delay line "
            "serves it",
            code="hoist_not_live",
        )
    require_hoisted_kind("cable_length_m", request.cable_length_m, kind)
    if machine.deflection_limit is not None:
        raise InvalidInputError(
            "cable_length_m",
            request.cable_length_m,
            "left out with deflection_limit: a plan through a hoist keeps no limit on its way",
            code="hoist_with_deflection_limit",
        )
    first = machine.plant
    if before is not None:
        first = replace(before.last, cable_length_m=before.length_m(at_s))
    lengths = first.cable_length_m, request.cable_length_m
    if max(lengths) > MAX_LENGTH_RATIO * min(lengths):
        raise InvalidInputError(
            "cable_length_m",
            (min(lengths), max(lengths)),
            f"lengths within a factor of {MAX_LENGTH_RATIO:g}",
            code="course_too_wide",
        )
    roots = sum(math.sqrt(length_m / first.gravity_m_s2) for length_m in lengths)
    turn_rad = 2 * request.over_s / roots
    if turn_rad > MAX_HOISTING_TURN_RAD:
        raise InvalidInputError(
            "over_s",
            request.over_s,
            f"such that the load swings {MAX_HOISTING_TURN_RAD / math.tau:g} times at most "
            f"until then, which it does {turn_rad / math.tau:.4g} times",
            code="course_too_long",
        )
    return Hoist(
        begin_s=at_s,
        end_s=at_s + request.over_s,
        first=first,
        last=replace(first, cable_length_m=request.cable_length_m),
    )


def hoisted_axis(
    machine: LiveMachine,
    task: Task,
    before: Hoist | None,
    hoist: Hoist,
    axis: AxisState,
    witnesses: Witnesses,
) -> tuple[AxisState, Witnesses]:
    """Return an axis and its witnesses as a hoist begins.

    Parameters
    ----------
    machine, task
        The machine, and what planning knows of it on the length before.
    before, hoist
        The latest hoist before, and the one that begins.
    axis, witnesses
        As it begins.

    Returns
    -------
    tuple of AxisState and Witnesses
        In the coordinates of the hoist.
    """
    mode = task.modes[0]
    seen = Witnesses(
        given=begin_witness(witnesses.given, mode, before, hoist),
        ideal=begin_witness(witnesses.ideal, mode, before, hoist),
    )
    return begin_hoist(task, machine.actuator, before, hoist, axis), seen
