"""The largest deflection under a plan, by the matrix exponential: the certificates' own route."""

import math
from collections.abc import Sequence

import numpy as np

from design.analysis.certificate import Claim
from design.live.witness import Route, Witness, carry_witness
from design.model.plants.mode import Mode
from design.response.matrix_exponential import exponentials
from design.types import FloatArray

TURN = 0.02
"""Turn of the quickest mode from sample to sample: a vertex between them is exact to 1e-8 [rad]."""

MAX_SAMPLES = 20_000
"""Samples of a stretch."""


def deflection_claims(
    route: Route,
    modes: tuple[Mode, ...],
    witness: Witness,
    times_s: Sequence[float],
    levels: Sequence[float],
    until_s: float,
    limit: float,
) -> tuple[Claim, ...]:
    """Return the largest deflection of each mode, as claims of a limit.

    Parameters
    ----------
    route, modes
        The machine and its modes, f of them.
    witness
        The axis now.
    times_s, levels
        When the drive gets each switch, ascending and not before now, and its level [s], [-].
    until_s
        How long is looked, not before the last of them [s].
    limit
        Largest deflection, over that of an unshaped step [-].

    Returns
    -------
    tuple of Claim
        One a mode.
    """
    step_s = TURN / max(mode.natural_frequency_rad_s for mode in modes)
    roots = np.sqrt([1 - mode.damping_ratio**2 for mode in modes])
    largest = np.zeros(len(modes))
    for number, end_s in enumerate([*times_s, until_s]):
        span_s = end_s - witness.time_s
        if span_s > 0:
            many = min(math.ceil(span_s / step_s) + 1, MAX_SAMPLES)
            largest = np.maximum(largest, _largest(route, witness, span_s / many, many))
        switch = slice(number, number + 1)
        witness = carry_witness(route, witness, times_s[switch], levels[switch], end_s)
    shares = largest * roots / route.unshaped
    return tuple(
        Claim(quantity="deflection", value=float(share), limit=limit, mode=mode)
        for mode, share in enumerate(shares.tolist())
    )


def _largest(route: Route, witness: Witness, step_s: float, many: int) -> FloatArray:
    """Return the largest deflection of each mode over steps without a switch, shape (f,)."""
    flow = exponentials(route.dynamics.matrices[witness.force] * step_s)
    states = witness.states[..., None]
    seen = [states[:, -1, 0]]
    for _ in range(many):
        states = flow @ states
        seen.append(states[:, -1, 0])
    values = np.abs(np.array(seen))
    largest: FloatArray = values.max(axis=0)
    before, here, after = values[:-2], values[1:-1], values[2:]
    bend = before - 2 * here + after
    inside = (here >= before) & (here >= after) & (bend < 0)
    gained = (after - before) ** 2 / np.where(inside, -8 * bend, 1.0)
    vertices = np.where(inside, here + gained, 0.0).max(axis=0, initial=0.0)
    both: FloatArray = np.maximum(largest, vertices)
    return both
