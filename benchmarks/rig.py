"""A minute of the crane, played and controlled, beside SciPy's DOP853 of the same plant."""

import math
import time
from collections.abc import Iterator, Sequence
from statistics import median

import numpy as np

from benchmarks.designs import ACTUATOR
from benchmarks.measure import Figure, alternating_medians, ratio
from design.model.actuators.second_order import SecondOrder
from design.rig.controlled import Reading, run_controlled
from design.rig.crane import AXES, Crane
from design.rig.machine import Machine
from design.rig.march import TOLERANCE
from design.types import FloatArray

MOTION_S, SAMPLE_S = 60.0, 1e-3
PEER_S = 1.0
"""What the peer is controlled for: it begins anew at each sample, and is slow at that [s]."""

MAX_CONTROLLED_S = 1.0
SPEED_M_S, CABLE_M, GRAVITY_M_S2 = 0.2, 0.8, 9.81
DRIVE = SecondOrder(accel=ACTUATOR.accel, decel=ACTUATOR.decel, model="switched")
CRANE = Crane(cable_length_m=CABLE_M, gravity_m_s2=GRAVITY_M_S2)

Levels = tuple[float, float]


def levels_at(time_s: float) -> Levels:
    """Return what is commanded: x forth and back in 8 s, y in 6 s, with pauses."""
    forth = ((time_s + 1e-9) % 8.0, (time_s + 1e-9) % 6.0)
    return tuple(  # type: ignore[return-value]
        1.0 if since < 2.0 else (-1.0 if 3.0 <= since < 5.0 else 0.0) for since in forth
    )


def steps() -> list[tuple[float, Levels]]:
    """Return the times at which a level changes, all whole seconds, and the levels from then on."""
    found: list[tuple[float, Levels]] = []
    for second in range(int(MOTION_S)):
        levels = levels_at(float(second))
        if not found or found[-1][1] != levels:
            found.append((float(second), levels))
    return found


def played() -> FloatArray:
    """Play it, seen at each sample; return where the hook is at the end [m]."""
    machine = Machine(CRANE, (DRIVE, DRIVE), SPEED_M_S)
    held: Sequence[float] = (0.0, 0.0)
    for at_s, levels in steps():
        for axis, level, before in zip(AXES, levels, held, strict=True):
            if level != before:
                machine.command(axis, level, at_s)
        held = levels
    times = SAMPLE_S * np.arange(round(MOTION_S / SAMPLE_S) + 1)
    hook: FloatArray = machine.advance(float(times[-1]), times).hook_m[-1]
    return hook


def controlled() -> FloatArray:
    """Command the same sample by sample, as a controller that reads its sensors does."""

    def controller(reading: Reading) -> Levels:
        return levels_at(reading.at_s)

    machine = Machine(CRANE, (DRIVE, DRIVE), SPEED_M_S)
    run = run_controlled(machine, controller, SAMPLE_S, MOTION_S)
    hook: FloatArray = run.track.hook_m[-1]
    return hook


class Peer:
    """The same crane by `solve_ivp`: two drives, and the hook as a unit vector with its rate."""

    def __init__(self) -> None:
        self.state = np.zeros(12)  # Of x and y velocity and rate, then the vector, then its rate
        self.state[6] = -1.0
        self.levels: Levels = (0.0, 0.0)
        self.sets = [DRIVE.decel, DRIVE.decel]

    def command(self, levels: Levels) -> None:
        """Hold levels from now on; a set of a drive stays in force until its level changes."""
        for axis, (level, before) in enumerate(zip(levels, self.levels, strict=True)):
            if level != before:
                self.sets[axis] = DRIVE.accel if abs(level) > abs(before) else DRIVE.decel
        self.levels = levels

    def rates(self, _: float, state: FloatArray) -> list[float]:
        """Return the rates of all [per s]."""
        vx, ax, vy, ay, nx, ny, nz, px, py, pz = state.tolist()[:10]
        bends = []
        for velocity, rate, level, used in zip(
            (vx, vy), (ax, ay), self.levels, self.sets, strict=True
        ):
            w = used.natural_frequency_rad_s
            bends.append(w * w * (SPEED_M_S * level - velocity) - 2 * used.damping_ratio * w * rate)
        tension = CABLE_M * (px * px + py * py + pz * pz) - GRAVITY_M_S2 * nz - ax * nx - ay * ny
        return [
            ax, bends[0], ay, bends[1], px, py, pz,
            (-ax - tension * nx) / CABLE_M,
            (-ay - tension * ny) / CABLE_M,
            (-GRAVITY_M_S2 - tension * nz) / CABLE_M,
            vx, vy,
        ]  # fmt: skip

    def go_on(self, start_s: float, times_s: FloatArray) -> None:
        """Go on to the last of some times, and see the state at each."""
        from scipy.integrate import solve_ivp

        found = solve_ivp(
            self.rates,
            (start_s, float(times_s[-1])),
            self.state,
            method="DOP853",
            t_eval=times_s,
            rtol=TOLERANCE,
            atol=TOLERANCE,
        )
        self.state = found.y[:, -1]


def played_by_peer() -> FloatArray:
    """Play the same by `solve_ivp`, from step to step."""
    peer, changes = Peer(), steps()
    ends = [*(at_s for at_s, _ in changes[1:]), MOTION_S]
    for (at_s, levels), end_s in zip(changes, ends, strict=True):
        peer.command(levels)
        peer.go_on(at_s, np.linspace(at_s, end_s, round((end_s - at_s) / SAMPLE_S) + 1))
    hook: FloatArray = CABLE_M * peer.state[4:7]
    return hook


def controlled_by_peer() -> FloatArray:
    """Command the same sample by sample, for a shorter time."""
    peer = Peer()
    for sample in range(round(PEER_S / SAMPLE_S)):
        at_s = sample * SAMPLE_S
        peer.command(levels_at(at_s))
        peer.go_on(at_s, np.array([at_s + SAMPLE_S]))
    return peer.state


def figures() -> Iterator[Figure]:
    """Measure."""
    apart_m = float(np.abs(played() - played_by_peer()).max())
    seconds = alternating_medians(
        {"ours": played, "peer": played_by_peer}, rounds=5, calls=1, clock=time.process_time
    )
    beside = ratio(seconds, "ours", "peer")
    took = {name: median(values) for name, values in seconds.items()}
    yield Figure(
        what="60 s of the crane played, 1 kHz / SciPy DOP853 from step to step",
        value=f"{beside:.3f} ({1e3 * took['ours']:.0f} / {1e3 * took['peer']:.0f} ms, hooks "
        f"{apart_m:.0e} m apart)",
        limit="",
        met=None,
        over_peer=beside,
    )
    seconds = alternating_medians(
        {"ours": controlled, "peer": controlled_by_peer}, rounds=3, calls=1, clock=time.process_time
    )
    beside = ratio(seconds, "ours", "peer") * PEER_S / MOTION_S
    took = {name: median(values) for name, values in seconds.items()}
    same = math.isclose(float(np.abs(controlled() - played()).max()), 0.0, abs_tol=1e-9)
    yield Figure(
        what="60 s of the crane controlled at 1 kHz / SciPy DOP853 from sample to sample",
        value=f"{beside:.4f} ({took['ours']:.2f} s; of {PEER_S:g} s the peer takes "
        f"{took['peer']:.2f} s)",
        limit=f"<= {MAX_CONTROLLED_S:g} s",
        met=same and took["ours"] <= MAX_CONTROLLED_S,
        over_peer=beside,
    )
