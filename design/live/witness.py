"""A second opinion on live plans: the whole history, carried by matrix exponential.

Beside each axis goes its witness: the state of drive and modes in the coordinates of
`design.response.simulation`, which shares no code with the kernel. It is carried through every
switch that was sent, from rest on, so that a certificate of a plan is one of the whole command; and
its derivative over the logarithm of the frequency with it, in one block matrix (Van Loan 1978).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from design.analysis.certificate import Claim
from design.claims import ZERO_LIMITS, Quantity
from design.model.actuators.rate_limited import Unlimited
from design.model.plants.mode import Mode
from design.response.matrix_exponential import exponentials
from design.response.simulation import Dynamics, dynamics_of
from design.types import ComplexArray, FloatArray

METHOD = (
    "state of drive and modes carried through the whole live command by matrix exponential, its "
    "derivative over the frequency with it"
)

RATIO_STEP = 1e-5
"""Of the frequencies' logarithm, for the derivative of the eigenvectors, which are smooth [-]."""

SAME_INSTANT_S = 1e-9
"""Within it two switches are one to a drive [s]."""

SAME_LEVEL = 1e-12
"""Share of two levels within which they are one, as of a command's impulses [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Witness:
    """State of one axis, as its drive has answered until a moment.

    Attributes
    ----------
    time_s
        The moment [s].
    level
        Of the command [-].
    force
        The set in force: 1 accelerates, 0 decelerates, as of `Dynamics`.
    states
        Of each mode, with copies of the lags, less the command: shape (f, n) [-].
    slopes
        Their derivatives over the logarithm of the frequency, shape (f, n) [-].
    """

    time_s: float
    level: float
    force: int
    states: FloatArray
    slopes: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Route:
    """The matrices of a drive on modes.

    Attributes
    ----------
    dynamics
        Of the drive on f modes.
    blocks
        Matrices of state and derivative, shape (2, f, 2 n, 2 n).
    lefts, left_slopes
        Left eigenvectors of the modes in either set, and their derivatives, shape (2, f, n).
    unshaped
        Amplitudes of a unit step, shape (f,) [-].
    """

    dynamics: Dynamics
    blocks: FloatArray
    lefts: ComplexArray
    left_slopes: ComplexArray
    unshaped: FloatArray


@lru_cache(maxsize=64)
def route_of(actuator: Unlimited, modes: tuple[Mode, ...]) -> Route:
    """Return the matrices of a drive on modes.

    Parameters
    ----------
    actuator
        The drive.
    modes
        The modes, f of them.

    Returns
    -------
    Route
        For `carry_witness` and `claims_of`.
    """
    frequencies = np.array([mode.natural_frequency_rad_s for mode in modes])
    dampings = np.array([mode.damping_ratio for mode in modes])
    poles = -dampings + 1j * np.sqrt(1 - dampings**2)

    def at(ratio: float) -> tuple[Dynamics, ComplexArray]:
        moved = dynamics_of(actuator, ratio * frequencies, dampings)
        lefts = [_lefts(moved, force, ratio * frequencies, poles) for force in (0, 1)]
        return moved, np.array(lefts)

    dynamics, lefts = at(1.0)
    beside = [at(float(np.exp(sign * RATIO_STEP)))[1] for sign in (-1, 1)]
    count = dynamics.matrices.shape[-1]
    blocks = np.zeros((2, len(modes), 2 * count, 2 * count))
    blocks[:, :, :count, :count] = blocks[:, :, count:, count:] = dynamics.matrices
    # The rows of the mode are proportional to its frequency, those of the lags know nothing of it.
    blocks[:, :, -2:, :count] = dynamics.matrices[:, :, -2:]
    step = -dynamics.jumps[1] * dynamics.kept[1]
    return Route(
        dynamics=dynamics,
        blocks=blocks,
        lefts=lefts,
        left_slopes=(beside[1] - beside[0]) / (2 * RATIO_STEP),
        unshaped=np.abs(lefts[1] @ step),
    )


def _lefts(
    dynamics: Dynamics, force: int, frequencies_rad_s: FloatArray, poles: ComplexArray
) -> ComplexArray:
    """Return left eigenvectors ``l A = s l`` of the modes in one set, ``l = [l_lags, -1, s/w]``."""
    matrices, kept = dynamics.matrices[force], dynamics.kept[force]
    lags = matrices.shape[-1] - 2
    found: ComplexArray = np.zeros(matrices.shape[:2], dtype=np.complex128)
    found[:, -2], found[:, -1] = -1.0, poles
    for left, matrix, pole in zip(found, matrices, poles * frequencies_rad_s, strict=True):
        shifted = pole * np.eye(lags) - matrix[:lags, :lags].T
        left[:lags] = np.linalg.solve(shifted, left[-2:] @ matrix[-2:, :lags]) * kept[:lags]
    return found


def witness_at_rest(route: Route) -> Witness:
    """Return the witness of an axis at rest at time 0."""
    size = route.dynamics.matrices.shape[1], route.dynamics.matrices.shape[-1]
    return Witness(time_s=0.0, level=0.0, force=1, states=np.zeros(size), slopes=np.zeros(size))


def _one_an_instant(
    times_s: Sequence[float], levels: Sequence[float]
) -> tuple[list[float], list[float]]:
    """Return switches as a drive sees them: of several at one instant the last alone."""
    after = np.diff(times_s, append=math.inf) if len(times_s) else np.empty(0)
    kept = np.flatnonzero(after > SAME_INSTANT_S).tolist()
    return [times_s[one] for one in kept], [levels[one] for one in kept]


def carry_witness(
    route: Route,
    witness: Witness,
    times_s: Sequence[float],
    levels: Sequence[float],
    until_s: float,
) -> Witness:
    """Return a witness after switches, at a later time.

    Parameters
    ----------
    route
        The machine.
    witness
        The witness now.
    times_s, levels
        When the drive gets each switch, ascending and not before now, and its level [s], [-].
    until_s
        Not before the last of them [s].

    Returns
    -------
    Witness
        Just after a switch at that time.
    """
    if not levels and not witness.states.any() and not witness.slopes.any():
        return replace(witness, time_s=until_s)
    times_s, levels = _one_an_instant(times_s, levels)
    ends = np.array([*times_s, until_s])
    gaps = np.diff(ends, prepend=witness.time_s)
    level, forces = witness.level, [witness.force]
    for to in levels:
        margin = SAME_LEVEL * (abs(level) + abs(to))
        if abs(to - level) <= margin:
            forces.append(forces[-1])
        else:
            forces.append(int(abs(to) - abs(level) > margin))
        level = to
    flows = exponentials(route.blocks[forces] * np.maximum(gaps, 0.0)[:, None, None, None])
    dynamics, count = route.dynamics, witness.states.shape[1]
    both = np.concatenate((witness.states, witness.slopes), axis=1)
    level = witness.level
    for number, flow in enumerate(flows):
        both = (flow @ both[..., None])[..., 0]
        if number < len(levels):
            to, force = levels[number], forces[number + 1]
            if to != level:
                kept = dynamics.kept[force]
                both = both * np.tile(kept, 2)
                both[:, :count] -= (to - level) * dynamics.jumps[force] * kept
                level = to
    return Witness(
        time_s=until_s,
        level=level,
        force=forces[-1],
        states=both[:, :count],
        slopes=both[:, count:],
    )


def without_slope(route: Route, witness: Witness) -> Witness:
    """Return a witness whose modal coordinates have no slope.

    Parameters
    ----------
    route, witness
        The machine, and its axis now.

    Returns
    -------
    Witness
        The same, with derivatives of the modes alone, such that those of the coordinates are zero.
    """
    derived = (route.left_slopes[witness.force] * witness.states).sum(axis=1)
    poles = route.lefts[witness.force][:, -1]
    slopes = np.zeros_like(witness.slopes)
    # With l = [..., -1, p]: -a + p b + derived = 0 of real a, b.
    slopes[:, -1] = -derived.imag / poles.imag
    slopes[:, -2] = slopes[:, -1] * poles.real + derived.real
    return replace(witness, slopes=slopes)


def claims_of(route: Route, witness: Witness, *, slopes: bool) -> tuple[Claim, ...]:
    """Return what an axis still swings, as claims that it is nothing.

    Parameters
    ----------
    route, witness
        The machine, and its axis just after the last switch.
    slopes
        Whether the slope counts too.

    Returns
    -------
    tuple of Claim
        Of each mode, over the vibration of an unshaped step.
    """
    left = route.lefts[witness.force]
    rings = (left * witness.states).sum(axis=1)
    derived = (route.left_slopes[witness.force] * witness.states).sum(axis=1)
    derived += (left * witness.slopes).sum(axis=1)
    found: list[tuple[Quantity, ComplexArray]] = [("residual", rings)]
    if slopes:
        found.append(("slope", derived))
    return tuple(
        Claim(
            quantity=quantity,
            value=float(abs(values[mode]) / route.unshaped[mode]),
            limit=ZERO_LIMITS[quantity],
            mode=mode,
        )
        for mode in range(len(rings))
        for quantity, values in found
    )
