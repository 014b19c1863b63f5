"""The witness of an axis while its cable is hoisted: its equations, step by step through time.

The state is that of the lags, the deflection y of the load over the speed, and the velocity d of
the load less the command: ``y' = d - e`` with the lags' error e, and ``d' = -g y / L - 2 z sqrt(g /
L) (y' - L' y / L)``. It is carried by collocation at Radau's nodes, forward; the kernel of the
swing, by which plans are made, is not used.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from design.live.hoist import Hoist
from design.live.witness import SAME_LEVEL, Route, Witness, carry_witness
from design.model.plants.mode import Mode
from design.response.hoisting_simulation import INTEGRALS, NODES, STAGES
from design.types import FloatArray

FIRST = 0.4
"""First step after a switch, over the time constant of the fastest mode [-]."""

GROWTH = 1.35
"""Of one step to the next [-]."""

TURN_RAD = 0.7
"""Largest turn of the swing, or decay of a lag's slowest mode, in a step [rad]."""

MAX_WOUND = 0.15
"""Largest share of the cable that is wound in a step [-]."""


def begin_witness(witness: Witness, mode: Mode, before: Hoist | None, hoist: Hoist) -> Witness:
    """Return a witness in the coordinates of a hoist that begins now.

    Parameters
    ----------
    witness
        As the hoist begins.
    mode
        Of the length before.
    before, hoist
        The latest hoist before, which may last yet; the hoist.

    Returns
    -------
    Witness
        Without slopes.
    """
    states = witness.states.copy()
    rate = 0.0
    if before is not None and witness.time_s < before.end_s:
        rate = before.rate_m_s
    else:
        w, z = mode.natural_frequency_rad_s, mode.damping_ratio
        shifted, moving = states[0, -2:].tolist()
        states[0, -2:] = -moving / w, shifted + 2 * z * moving
    states[0, -1] += (hoist.rate_m_s - rate) * states[0, -2] / hoist.first.cable_length_m
    return replace(witness, states=states, slopes=np.zeros_like(states))


def carry_hoisted_witness(
    route: Route,
    hoist: Hoist | None,
    witness: Witness,
    times_s: Sequence[float],
    levels: Sequence[float],
    until_s: float,
) -> Witness:
    """Return a witness at a later time, through what is left of a hoist.

    Parameters
    ----------
    route
        The machine on the last length.
    hoist
        The latest hoist, if there was any.
    witness, times_s, levels, until_s
        As of `design.live.witness.carry_witness`.

    Returns
    -------
    Witness
        In the coordinates of the last length once the hoist is over.
    """
    if hoist is None or witness.time_s >= hoist.end_s:
        return carry_witness(route, witness, times_s, levels, until_s)
    made = sum(time_s < hoist.end_s for time_s in times_s)
    then_s = min(until_s, hoist.end_s)
    for time_s, level in zip(times_s[:made], levels[:made], strict=True):
        witness = _switched(route, _waited(route, hoist, witness, time_s), level)
    witness = _waited(route, hoist, witness, then_s)
    if until_s < hoist.end_s:
        return witness
    mode = hoist.last.mode
    w, z = mode.natural_frequency_rad_s, mode.damping_ratio
    states = witness.states.copy()
    y, d = states[0, -2:].tolist()
    d -= hoist.rate_m_s * y / hoist.last.cable_length_m
    states[0, -2:] = d + 2 * z * w * y, -w * y
    ended = replace(witness, states=states, slopes=np.zeros_like(states))
    return carry_witness(route, ended, times_s[made:], levels[made:], until_s)


def _switched(route: Route, witness: Witness, level: float) -> Witness:
    change = level - witness.level
    if abs(change) <= SAME_LEVEL * (abs(level) + abs(witness.level)):
        return witness
    force = int(abs(level) > abs(witness.level))
    kept, jumps = route.dynamics.kept[force], route.dynamics.jumps[force].copy()
    jumps[-2:] = 0.0, 1.0
    states = witness.states * kept - change * jumps * kept
    return replace(witness, level=level, force=force, states=states)


def _waited(route: Route, hoist: Hoist, witness: Witness, until_s: float) -> Witness:
    if not until_s > witness.time_s:
        return witness
    state = witness.states[0]
    if state.any():
        lags = route.dynamics.matrices[witness.force, 0, :-2, :-2]
        ends = _steps(lags, hoist, witness.time_s, until_s)
        for flow in _flows(lags, route.dynamics.coupled, hoist, ends):
            state = flow @ state
    return replace(witness, time_s=until_s, states=state[None])


def _steps(lags: FloatArray, hoist: Hoist, begin_s: float, until_s: float) -> FloatArray:
    shortest_m = min(hoist.length_m(begin_s), hoist.length_m(until_s))
    turns = float(np.sqrt(hoist.last.gravity_m_s2 / shortest_m)) / TURN_RAD
    winds = abs(hoist.rate_m_s) / shortest_m / MAX_WOUND
    poles = np.abs(np.linalg.eigvals(lags)) if lags.size else np.zeros(0)
    poles = poles[poles > 0]
    slow = float(poles.min()) / TURN_RAD if poles.size else 0.0
    longest = 1 / max(turns, winds, slow)
    step = min(longest, FIRST / float(poles.max())) if poles.size else longest
    ends = [begin_s]
    while ends[-1] < until_s:
        ends.append(ends[-1] + step)
        step = min(GROWTH * step, longest)
    ends[-1] = until_s
    return np.array(ends)


def _flows(lags: FloatArray, coupled: list[int], hoist: Hoist, ends_s: FloatArray) -> FloatArray:
    """Return the matrices of steps, shape (steps, n, n)."""
    order = len(lags)
    y, d, size = order, order + 1, order + 2
    steps = np.diff(ends_s)
    nodes = ends_s[:-1, None] + steps[:, None] * NODES
    lengths = hoist.first.cable_length_m + hoist.rate_m_s * (nodes - hoist.begin_s)
    matrices = np.zeros((*nodes.shape, size, size))
    matrices[..., :order, :order] = lags
    matrices[..., y, d] = 1.0
    matrices[..., y, coupled] = -1.0
    gravity = hoist.last.gravity_m_s2
    drag = 2 * hoist.last.damping_ratio * np.sqrt(gravity / lengths)
    matrices[..., d, :] = -drag[..., None] * matrices[..., y, :]
    matrices[..., d, y] += (drag * hoist.rate_m_s - gravity) / lengths
    pulls = np.einsum("n,ij,njkl->nikjl", steps, INTEGRALS, matrices)
    coupling = np.eye(STAGES * size) - pulls.reshape(-1, STAGES * size, STAGES * size)
    units = np.tile(np.eye(size), (STAGES, 1))
    units = np.broadcast_to(units, (len(steps), *units.shape))
    flows: FloatArray = np.linalg.solve(coupling, units)[:, -size:]
    return flows
