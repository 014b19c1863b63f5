"""Live shaping from event to event: `init`, `event` and `step`.

Examples
--------
A crane is driven off and let go while its start is not over yet:

>>> from design.live.machine import LiveMachine
>>> from design.model.actuators.first_order import FirstOrder
>>> from design.model.plants.pendulum import Pendulum
>>> drive = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05, model="switched")
>>> machine = LiveMachine(plant=Pendulum(cable_length_m=0.8), actuator=drive)
>>> state = event(machine, init(machine), 0.0, Press(x=1.0))
>>> state = event(machine, state, 0.4, Press(x=0.0))
>>> state.certificate.verified, state.x.plan.levels
(True, (1.0, 0.0))
"""

from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from design.analysis.certificate import Certificate, Claim
from design.errors import InvalidInputError
from design.live.demands import limit_deflection
from design.live.emergency import emergency_stop
from design.live.emergency_request import EmergencyRequest
from design.live.hoist import Hoist, HoistRequest
from design.live.hoist_events import hoist_of, hoisted_axis, require_hoisted_kind
from design.live.hoist_planning import carry_hoisted, solve_hoisted
from design.live.machine import LiveKind, LiveMachine
from design.live.plan_claims import Witnessed, claims_of_plan, worst_claims
from design.live.planning import NOTHING, Task, last_switch_s, task_of, wait_and_solve
from design.live.state import AxisState, Plan, at_rest
from design.live.witness import METHOD, without_slope, witness_at_rest
from design.live.witnesses import Witnesses, carry_witnesses, routes_of
from design.model.plants.mode import Mode

AxisName = Literal["x", "y"]

SAME_TIME_S = 1e-9
"""Within it two events are at one time: rounding of the sum of two times [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Press:
    """Levels that are asked for.

    Attributes
    ----------
    x, y
        Shares of full speed, signed, from -1 to 1; None does not change the axis [-].
    """

    x: float | None = None
    y: float | None = None

    def __post_init__(self) -> None:
        for name in ("x", "y"):
            level = getattr(self, name)
            if level is not None and not -1.0 <= level <= 1.0:
                raise InvalidInputError(name, level, "between -1 and 1", code="out_of_range")


Request = Press | LiveKind | EmergencyRequest | HoistRequest
"""What can happen: buttons, another kind of shaper, an emergency stop of both axes, or a hoist."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LiveState:
    """What live shaping knows at a moment.

    Attributes
    ----------
    time_s
        The moment [s].
    event_s
        When the latest event was; None before the first [s].
    kind
        What plans leave.
    modes
        Of the plant as it is now; from the begin of a hoist on, as it is at its end.
    x, y
        The axes.
    witness_x, witness_y
        The second opinion on each.
    certificate
        Of the plans in force, recomputed by that opinion; None before the first event.
    fallback
        Why an axis keeps an older plan than the latest event asked for; None if none does.
    hoist
        The latest hoist, which may be over; None before the first.
    """

    time_s: float
    event_s: float | None
    kind: LiveKind
    modes: tuple[Mode, ...]
    x: AxisState
    y: AxisState
    witness_x: Witnesses
    witness_y: Witnesses
    certificate: Certificate | None = None
    fallback: str | None = None
    hoist: Hoist | None = None

    @property
    def hoisting(self) -> bool:
        """Whether the cable is hoisted or lowered now."""
        return self.hoist is not None and self.time_s < self.hoist.end_s

    @property
    def last_switch_s(self) -> float:
        """When the last switch of either axis is; now if there is none [s]."""
        return max(last_switch_s(self.x), last_switch_s(self.y), self.time_s)


def init(machine: LiveMachine) -> LiveState:
    """Return the state of a machine at rest at time 0."""
    routes = routes_of(machine, machine.modes)
    at = Witnesses(given=witness_at_rest(routes.given), ideal=witness_at_rest(routes.ideal))
    rest = at_rest(len(machine.modes), machine.kind)
    return LiveState(
        time_s=0.0,
        event_s=None,
        kind=machine.kind,
        modes=machine.modes,
        x=rest,
        y=rest,
        witness_x=at,
        witness_y=at,
    )


def _task(machine: LiveMachine, modes: tuple[Mode, ...]) -> Task:
    return task_of(machine.actuator, modes, machine.max_iterations)


def step(machine: LiveMachine, state: LiveState, until_s: float) -> LiveState:
    """Return the state at a later time, all due switches made.

    Parameters
    ----------
    machine
        The machine.
    state
        Its state.
    until_s
        Then [s].

    Returns
    -------
    LiveState
        With the rest of the plans.

    Raises
    ------
    InvalidInputError
        If that is before the state.
    """
    return _moved(machine, state, until_s, through=True)


def _moved(machine: LiveMachine, state: LiveState, until_s: float, *, through: bool) -> LiveState:
    if not until_s >= state.time_s:
        raise InvalidInputError(
            "at_s",
            until_s,
            f"not before the latest event or step, at {state.time_s:.9g} s",
            code="event_in_the_past",
        )
    task, routes = _task(machine, state.modes), routes_of(machine, state.modes)

    def move(axis: AxisState, witnesses: Witnesses) -> tuple[AxisState, Witnesses]:
        after = carry_hoisted(task, machine.actuator, state.hoist, axis, until_s, through=through)
        made = len(axis.plan.times_s) - len(after.plan.times_s)
        plan = Plan(times_s=axis.plan.times_s[:made], levels=axis.plan.levels[:made])
        return after, carry_witnesses(machine, routes, witnesses, plan, until_s, state.hoist)

    x, witness_x = move(state.x, state.witness_x)
    y, witness_y = move(state.y, state.witness_y)
    return replace(state, time_s=until_s, x=x, y=y, witness_x=witness_x, witness_y=witness_y)


def event(machine: LiveMachine, state: LiveState, at_s: float, request: Request) -> LiveState:
    """Return the state after an event, its plans solved anew.

    Parameters
    ----------
    machine
        The machine.
    state
        Its state at that time or before.
    at_s
        When it happens [s].
    request
        What happens.

    Returns
    -------
    LiveState
        At that time, with new plans, their certificate, and why one is an older one.

    Raises
    ------
    InvalidInputError
        If the event is before the state, comes faster than the sample time, or finds a swing
        beyond the model.
    """
    _require_sampled(machine, state, at_s)
    now = _moved(machine, state, at_s, through=False)
    _require_small(machine, now)
    now = _without_old_slopes(machine, now)
    kind, x, y = now.kind, now.x.target, now.y.target
    if isinstance(request, LiveKind):
        machine.require_kind(request)
        if now.hoist is not None:
            require_hoisted_kind("kind", request.name, request)
        kind = request
    elif isinstance(request, HoistRequest):
        now = _hoisted(machine, now, request)
    elif isinstance(request, Press):
        x, y = x if request.x is None else request.x, y if request.y is None else request.y
    elif isinstance(request, EmergencyRequest):
        x, y = 0.0, 0.0
    if isinstance(request, EmergencyRequest) and not now.hoisting:
        planned_x = _stopped(machine, now, now.x, now.witness_x, request)
        planned_y = _stopped(machine, now, now.y, now.witness_y, request)
    else:
        # A plan of before a hoist is none for its course; nor is a stop's: it leaves a swing.
        anew = isinstance(request, HoistRequest | EmergencyRequest)
        planned_x = _planned(machine, now, now.x, now.witness_x, kind, x, anew=anew)
        planned_y = _planned(machine, now, now.y, now.witness_y, kind, y, anew=anew)
    reasons = [
        f"{name}: {one.reason}"
        for name, one in (("x", planned_x), ("y", planned_y))
        if one.reason is not None
    ]
    return replace(
        now,
        event_s=at_s,
        kind=kind,
        x=planned_x.axis,
        y=planned_y.axis,
        certificate=Certificate(
            claims=worst_claims(planned_x.claims, planned_y.claims), method=METHOD
        ),
        fallback="; ".join(reasons) or None,
    )


def _hoisted(machine: LiveMachine, state: LiveState, request: HoistRequest) -> LiveState:
    """Return the state as a hoist begins: from now on swings are seen at its end."""
    hoist = hoist_of(machine, state.hoist, state.kind, state.time_s, request)
    task, before = _task(machine, state.modes), state.hoist
    x, witness_x = hoisted_axis(machine, task, before, hoist, state.x, state.witness_x)
    y, witness_y = hoisted_axis(machine, task, before, hoist, state.y, state.witness_y)
    after = replace(state, x=x, y=y, witness_x=witness_x, witness_y=witness_y)
    return replace(after, hoist=hoist, modes=hoist.modes)


def _without_old_slopes(machine: LiveMachine, state: LiveState) -> LiveState:
    """Return the state with no slope of an axis that swings no more and has no plan.

    The slope says what an error of the frequency does to the next moment of rest. What earlier
    moves did is over: a phase that an error has turned since then cancels nothing.
    """
    routes = routes_of(machine, state.modes)

    def forget(axis: AxisState, witnesses: Witnesses) -> tuple[AxisState, Witnesses]:
        if axis.plan.times_s or np.abs(axis.rings[:, :2]).max() > NOTHING:
            return axis, witnesses
        rings = axis.rings.copy()
        rings[:, 2:] = 0.0
        given = without_slope(routes.given, witnesses.given)
        return replace(axis, rings=rings), replace(witnesses, given=given)

    x, witness_x = forget(state.x, state.witness_x)
    y, witness_y = forget(state.y, state.witness_y)
    return replace(state, x=x, y=y, witness_x=witness_x, witness_y=witness_y)


def _require_sampled(machine: LiveMachine, state: LiveState, at_s: float) -> None:
    if machine.sample_time_s is None or state.event_s is None:
        return
    since_s = at_s - state.event_s
    if SAME_TIME_S < since_s < machine.sample_time_s - SAME_TIME_S:
        raise InvalidInputError(
            "at_s",
            at_s,
            f"at least the sample time, {machine.sample_time_s:g} s, after the event at "
            f"{state.event_s:.9g} s",
            code="event_within_sample",
        )


def _require_small(machine: LiveMachine, state: LiveState) -> None:
    if machine.largest_swing is None:
        return
    unshaped = routes_of(machine, state.modes).given.unshaped
    most = machine.largest_swing
    if state.hoist is not None:  # One angle, in unshaped steps: as the root of the length
        most *= machine.modes[0].natural_frequency_rad_s / state.modes[0].natural_frequency_rad_s
    for name, axis in (("x", state.x), ("y", state.y)):
        largest = float((np.abs(np.array(axis.vibration)) / unshaped).max())
        if largest > most:
            raise InvalidInputError(
                "at_s",
                f"{largest:.4g} in {name} at {state.time_s:.6g} s",
                "a time at which the load swings by at most "
                f"{most:.4g} unshaped steps: beyond that the model does not hold",
                code="swing_beyond_model",
            )


class _Planned(NamedTuple):
    """An axis with its plan, why that is an older one, and what is found of it."""

    axis: AxisState
    reason: str | None
    claims: tuple[Claim, ...]


def _planned(
    machine: LiveMachine,
    state: LiveState,
    axis: AxisState,
    witnesses: Witnesses,
    kind: LiveKind,
    target: float,
    *,
    anew: bool,
) -> _Planned:
    task = _task(machine, state.modes)

    def claims(one: AxisState, of: LiveKind) -> tuple[Claim, ...]:
        return _claims(machine, state, witnesses, one.plan, of)

    if target == axis.target and not anew:
        found = claims(axis, kind)
        if kind != axis.kind and not all(claim.holds for claim in found):
            return _Planned(axis, axis.plan.fallback, claims(axis, axis.kind))
        return _Planned(replace(axis, kind=kind), axis.plan.fallback, found)
    flying, ahead = _ahead(machine, state, axis)
    solved = solve_hoisted(task, machine.actuator, state.hoist, kind, ahead, target)
    if machine.deflection_limit is not None:
        free = None if solved is None else solved.plan
        plan = limit_deflection(machine, state.modes, ahead, target, free)
        if plan is not None:
            limited = flying.then(plan, state.time_s)
            found = _claims(machine, state, witnesses, limited, kind)
            if all(claim.holds for claim in found if claim.quantity == "residual"):
                limited_axis = replace(axis, target=target, plan=limited, kind=kind)
                return _Planned(limited_axis, plan.fallback, found)
    if solved is not None:
        solved = replace(axis, target=target, plan=flying.then(solved.plan, state.time_s))
    # While the cable is hoisted a plan that waits is among those that are solved.
    for waits in (False,) if state.hoisting or anew else (False, True):
        one = wait_and_solve(task, kind, axis, target) if waits else solved
        found = () if one is None else claims(one, kind)
        if one is not None and all(claim.holds for claim in found):
            return _Planned(replace(one, kind=kind), None, found)
    reason = f"no command to {target:g} at rest was found; the older plan to {axis.target:g}"
    reason += (
        " goes on, and something swings in the end" if anew else ", which is verified, goes on"
    )
    kept = replace(axis, plan=replace(axis.plan, fallback=reason))
    return _Planned(kept, reason, claims(kept, kept.kind))


def _ahead(machine: LiveMachine, state: LiveState, axis: AxisState) -> tuple[Plan, AxisState]:
    """Return what was sent within the dead time, and the axis once it is answered."""
    sent = sum(time_s < state.time_s for time_s in axis.plan.times_s)
    flying = Plan(times_s=axis.plan.times_s[:sent], levels=axis.plan.levels[:sent])
    task, before = _task(machine, state.modes), replace(axis, plan=flying)
    then_s = state.time_s + machine.actuator.dead_time_s
    return flying, carry_hoisted(task, machine.actuator, state.hoist, before, then_s)


def _stopped(
    machine: LiveMachine,
    state: LiveState,
    axis: AxisState,
    witnesses: Witnesses,
    request: EmergencyRequest,
) -> _Planned:
    """Return an axis with its emergency stop, and what swings when its time is over."""
    flying, ahead = _ahead(machine, state, axis)
    found = emergency_stop(machine.actuator, state.modes, ahead, request)
    plan = replace(
        flying.then(found.plan, state.time_s),
        swing_left=request.swing_left,
        rests_s=found.end_s,
    )
    stopped = replace(axis, target=0.0, plan=plan, kind=state.kind)
    claims = _claims(machine, state, witnesses, plan, state.kind)
    return _Planned(stopped, plan.fallback, claims)


def _claims(
    machine: LiveMachine, state: LiveState, witnesses: Witnesses, plan: Plan, kind: LiveKind
) -> tuple[Claim, ...]:
    """Return what is found of a plan of an axis."""
    routes = routes_of(machine, state.modes)
    seen = Witnessed(routes.given, witnesses.given)
    if kind.ideal and plan.rests_s is None:
        seen = Witnessed(routes.ideal, witnesses.ideal)
    return claims_of_plan(machine, state.modes, seen, plan, kind, state.hoist)
