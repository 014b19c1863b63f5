"""What swings after a plan of an axis, and on its way, by the certificates' route."""

import math
from dataclasses import replace
from typing import NamedTuple

from design.analysis.certificate import Claim
from design.live.hoist import Hoist
from design.live.hoist_witness import carry_hoisted_witness
from design.live.machine import LiveKind, LiveMachine
from design.live.state import Plan
from design.live.witness import Route, Witness, claims_of
from design.live.witnessed_peak import deflection_claims
from design.model.plants.mode import Mode

AFTERMATH_PERIODS = 1.0
"""Periods of the slowest mode after a plan over which its deflection is looked at [-]."""


class Witnessed(NamedTuple):
    """An axis by the certificates' route."""

    route: Route
    witness: Witness


def claims_of_plan(
    machine: LiveMachine,
    modes: tuple[Mode, ...],
    seen: Witnessed,
    plan: Plan,
    kind: LiveKind,
    hoist: Hoist | None = None,
) -> tuple[Claim, ...]:
    """Return what is found of a plan of an axis.

    Parameters
    ----------
    machine, modes
        The machine, and its modes as they are now.
    seen
        The axis now, behind the drive that the kind asks for.
    plan
        The rest of its command.
    kind
        What the plan makes zero.
    hoist
        The latest hoist, if there was any: while it lasts, claims are of its end.

    Returns
    -------
    tuple of Claim
        Of an emergency stop, what swings when its time is over; with a limit to the deflection,
        the largest on the way too.
    """
    route, now = seen
    acts_s = [time_s + machine.actuator.dead_time_s for time_s in plan.times_s]
    end_s = max([now.time_s, *acts_s, plan.rests_s or now.time_s])
    if hoist is not None:
        end_s = max(end_s, hoist.end_s)
    done = carry_hoisted_witness(route, hoist, now, acts_s, plan.levels, end_s)
    if plan.rests_s is not None:
        claims = claims_of(route, done, slopes=False)
        return tuple(replace(claim, limit=max(claim.limit, plan.swing_left)) for claim in claims)
    claims = claims_of(route, done, slopes=kind.slope)
    if machine.deflection_limit is not None:
        slowest = min(mode.natural_frequency_rad_s for mode in modes)
        until_s = end_s + AFTERMATH_PERIODS * math.tau / slowest
        claims += deflection_claims(
            route, modes, now, acts_s, plan.levels, until_s, machine.deflection_limit
        )
    return claims


def worst_claims(one: tuple[Claim, ...], other: tuple[Claim, ...]) -> tuple[Claim, ...]:
    """Return the claims of two axes that are nearer to their limits.

    Parameters
    ----------
    one, other
        Of either axis.

    Returns
    -------
    tuple of Claim
        Of both; all of them where they claim different things.
    """
    if [claim.quantity for claim in one] != [claim.quantity for claim in other]:
        return one + other
    return tuple(
        max(pair, key=lambda claim: claim.value / claim.limit)
        for pair in zip(one, other, strict=True)
    )
