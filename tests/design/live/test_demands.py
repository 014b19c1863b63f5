"""Live events with a limit to the deflection, and emergency stops among them."""

from dataclasses import replace

import numpy as np
import pytest

from design.live.emergency_request import EmergencyRequest
from design.live.machine import LiveKind, LiveMachine
from design.live.session import LiveState, Press, event, init, step
from design.model.actuators.rate_limited import Unlimited
from tests.design.live.machines import CRANE, DRIVES, KIM
from tests.refusals import refused

LIMITED = LiveMachine(plant=CRANE, actuator=KIM, deflection_limit=0.5)


def found_of(state: LiveState) -> dict[str, float]:
    """Return the figures of a certificate."""
    assert state.certificate is not None
    return {claim.quantity: claim.value for claim in state.certificate.claims}


@pytest.mark.parametrize("drive", DRIVES)
def test_start_and_stop_keep_the_limit_by_the_certificate(drive: Unlimited) -> None:
    machine = LiveMachine(plant=CRANE, actuator=replace(drive), deflection_limit=0.5)
    state = event(machine, init(machine), 0.0, Press(x=1.0, y=-1.0))
    for at_s, press in ((2.0, Press(x=0.0)), (2.3, Press(y=0.0))):
        assert state.certificate is not None
        assert state.certificate.verified
        assert state.fallback is None
        state = event(machine, state, at_s, press)
    ended = step(machine, state, state.last_switch_s + 1.0)
    assert max(abs(one) for one in (*ended.x.vibration, *ended.y.vibration)) <= 1e-10


def test_a_limit_that_the_fastest_command_keeps_changes_nothing() -> None:
    wide, free = (LiveMachine(plant=CRANE, actuator=KIM, deflection_limit=d) for d in (1.5, None))
    plans = [event(one, init(one), 0.0, Press(x=1.0)).x.plan for one in (wide, free)]
    assert plans[0] == plans[1]


def test_a_swing_beyond_the_limit_is_told_and_not_verified() -> None:
    state = event(LIMITED, init(LIMITED), 0.0, Press(x=1.0))
    # Released where the payload hangs back most, and is driven the other way.
    for at_s, press in ((0.2, Press(x=0.0)), (0.3, Press(x=-1.0))):
        state = event(LIMITED, state, at_s, press)
    assert state.certificate is not None
    assert state.certificate.verified == (found_of(state)["deflection"] <= 0.5)
    assert found_of(state)["residual"] <= 1e-9
    if not state.certificate.verified:
        assert state.fallback is not None
        assert "above the limit of 0.5" in state.fallback


def test_both_axes_stop_within_a_period_and_a_release_does_not_prolong_it() -> None:
    machine = LiveMachine(plant=CRANE, actuator=replace(KIM, dead_time_s=0.03))
    state = event(machine, init(machine), 0.0, Press(x=1.0, y=-1.0))
    state = event(machine, state, 2.0, EmergencyRequest(swing_left=0.05))
    plans = state.x.plan, state.y.plan
    assert state.certificate is not None
    assert state.certificate.verified
    assert found_of(state)["residual"] == pytest.approx(0.05, abs=1e-9)
    period_s = 2 * np.pi / CRANE.mode.natural_frequency_rad_s
    assert max(max(plan.times_s) for plan in plans) <= 2.0 + period_s
    assert plans[1].times_s == pytest.approx(plans[0].times_s)
    released = event(machine, state, 2.1, Press(x=0.0, y=0.0))
    assert released.x.plan.times_s == tuple(t for t in plans[0].times_s if t >= 2.1)
    assert released.certificate is not None
    assert released.certificate.verified
    # What it left is taken away by the next press.
    again = event(machine, released, 5.0, Press(x=1.0))
    assert again.certificate is not None
    assert again.certificate.verified
    ended = step(machine, again, again.last_switch_s + 0.1)
    assert abs(ended.x.vibration[0]) <= 1e-10
    assert abs(ended.y.vibration[0]) > 0.04


def test_a_stop_that_is_asked_too_much_says_so() -> None:
    machine = LiveMachine(plant=CRANE, actuator=KIM)
    state = event(machine, init(machine), 0.0, Press(x=1.0))
    state = event(machine, state, 3.0, EmergencyRequest(within_periods=0.2))
    assert state.certificate is not None
    assert not state.certificate.verified
    assert state.fallback is not None
    assert state.fallback.startswith("x: within 0.2 periods no stop was found")
    assert found_of(state)["residual"] > 0.1


@pytest.mark.parametrize("kind", [LiveKind(name="numzvd"), LiveKind(name="umzv")])
def test_a_limit_serves_no_kind_that_asks_for_more(kind: LiveKind) -> None:
    with refused("kind_not_with_deflection_limit", "kind"):
        LiveMachine(plant=CRANE, actuator=KIM, kind=kind, deflection_limit=0.5)
    with refused("kind_not_with_deflection_limit", "kind"):
        event(LIMITED, init(LIMITED), 0.0, kind)


@pytest.mark.parametrize("limit", [0.0, -1.0, 0.01, float("nan")])
def test_a_limit_out_of_range_is_refused(limit: float) -> None:
    with refused("out_of_range", "deflection_limit"):
        LiveMachine(plant=CRANE, actuator=KIM, deflection_limit=limit)
