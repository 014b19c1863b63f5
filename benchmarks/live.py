"""A command solved anew at each of a thousand events, beside SciPy's `fsolve` of a release."""

import time
from collections.abc import Iterator
from itertools import pairwise
from statistics import median

import numpy as np

from benchmarks.designs import ACTUATOR
from benchmarks.measure import Figure, alternating_medians, ratio
from design.live.machine import LiveMachine
from design.live.session import LiveState, Press, event, init
from design.model.actuators.second_order import SecondOrder
from design.model.plants.pendulum import Pendulum
from design.types import FloatArray

EVENTS = 1000
MEDIAN_S, WORST_S = 2e-3, 10e-3
DRIVE = SecondOrder(accel=ACTUATOR.accel, decel=ACTUATOR.decel, model="switched")
CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
MACHINE = LiveMachine(plant=CRANE, actuator=DRIVE)
PRESS_S = 0.83
"""Time of the release that both solve: the start is over by then [s]."""

STARTS_S = ((0.2, 0.4), (0.2, 0.8), (0.4, 0.6), (0.4, 1.0))
"""Where the peer begins: times after the release of the step up and the last step down [s]."""


def events() -> list[float]:
    """Press, let go, reverse and press again; return what each event took [s of the processor]."""
    rng = np.random.default_rng(3)
    state, took = init(MACHINE), []
    at_s, level = 0.0, 0.0
    for _ in range(EVENTS):
        at_s += float(rng.uniform(0.05, 2.5))
        level = float(rng.choice([one for one in (-1.0, 0.0, 1.0) if one != level]))
        began = time.process_time()
        state = event(MACHINE, state, at_s, Press(x=level))
        took.append(time.process_time() - began)
    return took


def pressed() -> LiveState:
    """Return the state of a crane whose start is under way."""
    return event(MACHINE, init(MACHINE), 0.0, Press(x=1.0))


def released(state: LiveState) -> float:
    """Let go; return the last switch after that [s]."""
    return event(MACHINE, state, PRESS_S, Press(x=0.0)).last_switch_s - PRESS_S


def matrix(accelerates: bool) -> FloatArray:
    """Return the rates of drive, load and level: velocity, its rate, swing, its rate, level."""
    used = DRIVE.accel if accelerates else DRIVE.decel
    w, pendulum = used.natural_frequency_rad_s, CRANE.mode.natural_frequency_rad_s
    return np.array([
        [0, 1, 0, 0, 0],
        [-w * w, -2 * used.damping_ratio * w, 0, 0, w * w],
        [0, 0, 0, 1, 0],
        [0, -1, -pendulum * pendulum, 0, 0],
        [0, 0, 0, 0, 0],
    ])  # fmt: skip


def released_by_peer(state: FloatArray) -> float:
    """Return the last switch after the release, the soonest of those that `fsolve` finds [s]."""
    from scipy.linalg import expm
    from scipy.optimize import fsolve

    up, down = matrix(True), matrix(False)

    def swing(times: FloatArray) -> list[float]:
        # Down, up at the first time, down at the second: what swings once the drive stands still.
        at = state.copy()
        at[4] = 0.0
        at = expm(down * times[0]) @ at
        at[4] = 1.0
        at = expm(up * (times[1] - times[0])) @ at
        at[4] = 0.0
        rest = expm(down * 3.0) @ at
        return [float(rest[2]), float(rest[3])]

    soonest = np.inf
    for start in STARTS_S:
        found, _, status, _ = fsolve(swing, start, full_output=True, xtol=1e-12)
        if status == 1 and 0 < found[0] < found[1]:
            soonest = min(soonest, float(found[1]))
    return soonest


def figures() -> Iterator[Figure]:
    """Measure."""
    from scipy.linalg import expm

    events()
    took = events()
    yield Figure(
        what=f"a live command solved anew, {EVENTS} presses, releases and reversals",
        value=f"median {1e3 * median(took):.2f} ms, most {1e3 * max(took):.1f} ms",
        limit=f"<= {1e3 * MEDIAN_S:g} and {1e3 * WORST_S:g} ms",
        met=median(took) <= MEDIAN_S and max(took) <= WORST_S,
    )
    crane = pressed()
    state = np.array([0.0, 0.0, 0.0, 0.0, 0.0])
    switches = [*zip(crane.x.plan.times_s, crane.x.plan.levels, strict=True), (PRESS_S, 0.0)]
    for (at_s, level), (end_s, _) in pairwise(switches):
        accelerates = level > state[4]
        state[4] = level
        state = expm(matrix(accelerates) * (end_s - at_s)) @ state
    apart_s = abs(released(crane) - released_by_peer(state))
    seconds = alternating_medians(
        {"ours": lambda: released(crane), "peer": lambda: released_by_peer(state)},
        calls=3,
        clock=time.process_time,
    )
    beside = ratio(seconds, "ours", "peer")
    yield Figure(
        what="a release solved and proven / SciPy `fsolve` of the same from four starts",
        value=f"{beside:.4f} ({1e3 * median(seconds['ours']):.2f} / "
        f"{1e3 * median(seconds['peer']):.1f} ms, last switches {apart_s:.0e} s apart)",
        limit="",
        met=None,
        over_peer=beside,
    )
