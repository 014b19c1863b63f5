"""The switches of a command moved to where its residual over a band is least, the end kept.

A step is a cone program of the residual's vectors, linear in the switches. What that neglects is
small against the residual's own turn, so that a few steps are as good as many more cells.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from design.solvers import clarabel
from design.solvers.budget import Budget
from design.solvers.clarabel import ConeProgram
from design.solvers.outcome import Status
from design.types import ComplexArray, FloatArray

MAX_POLISHED = 12
"""Steps at most."""

SHRINKS = 3.0
"""By how much the radius shrinks after a step that gains nothing [-]."""

MIN_RADIUS = 1e-4
"""Share of the first radius at which the steps end [-]."""

ARRIVED = 1e-12
"""Share of the end by which it may be missed [-]."""

KEPT_GAP = 0.8
"""Share of a gap that one step closes at most [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Seen:
    """The residual of a command at some ratios, and how it changes with the switches.

    Attributes
    ----------
    switches
        Ascending from 0, shape (n,) [rad].
    end, end_changes
        When the last ramp ends, and its derivatives, shape (n,) [rad], [-].
    vectors, changes
        The residual's vectors at the end, shape (k,), and their derivatives while the end is kept,
        shape (k, n) [-], [1/rad].
    drifts
        Their derivatives in the end alone, shape (k,) [1/rad].
    """

    switches: FloatArray
    end: float
    end_changes: FloatArray
    vectors: ComplexArray
    changes: ComplexArray
    drifts: ComplexArray

    @property
    def largest(self) -> float:
        """The largest residual [-]."""
        return float(np.abs(self.vectors).max())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Polished:
    """The command of least residual over a band, of its structure and end.

    Attributes
    ----------
    seen
        The command.
    weights
        What the bound of each ratio costs, shape (k,).
    """

    seen: Seen
    weights: FloatArray


def polish(
    see: Callable[[FloatArray], Seen],
    switches: FloatArray,
    radius: float,
    budget: Budget,
    *,
    end: float | None = None,
    gained: float = 1e-4,
) -> Polished | None:
    """Move switches to where the residual is least, the end kept.

    Parameters
    ----------
    see
        What a command of given switches has for a residual.
    switches
        Where to begin, ascending from 0, shape (n,) [rad].
    radius
        How far a switch moves in the first step, at most [rad].
    budget
        The work is counted in it.
    end
        The end to bring the command to; that which it has if None [rad].
    gained
        Share of the residual that the last step gains, at most [-].

    Returns
    -------
    Polished or None
        None where Clarabel fails at once.
    """
    now, last_radius = see(switches), MIN_RADIUS * radius
    end = now.end if end is None else end
    found = None
    for _ in range(MAX_POLISHED):
        step = _step(now, end, radius, budget)
        if step is None:
            break
        moves, weights = step
        gaps, closing = np.diff(now.switches), np.diff(moves, prepend=0.0)
        shrinking = closing < 0
        share = KEPT_GAP * float(np.min(-gaps[shrinking] / closing[shrinking], initial=2.0))
        following = see(now.switches + np.append(0.0, min(1.0, share) * moves))
        off = abs(now.end - end)
        if following.largest < now.largest or abs(following.end - end) < off / 2:
            less = now.largest - following.largest
            now = following
            found = Polished(seen=now, weights=weights)
            if off < ARRIVED * end and less < gained * now.largest:
                break
        else:
            radius /= SHRINKS
            found = found or Polished(seen=now, weights=weights)
        if radius < last_radius:
            break
    return found


def _step(
    now: Seen, end: float, radius: float, budget: Budget
) -> tuple[FloatArray, FloatArray] | None:
    """Return the step of the switches after the first that brings the end, and the weights."""
    changes, ends = now.changes[:, 1:], now.end_changes[1:]
    # The last switch always moves the end: it makes up for what the others do to it.
    makes_up = -ends[:-1] / ends[-1]
    late = (end - now.end) / ends[-1]
    program = ConeProgram(
        offset=now.vectors + changes[:, -1] * late + now.drifts * (end - now.end),
        rows=radius * (changes[:, :-1] + np.multiply.outer(changes[:, -1], makes_up)),
        lowest=-1.0,
        highest=1.0,
        unit_sum=False,
    )
    outcome = clarabel.solve(program)
    budget.spend(clarabel.work_of(program, outcome))
    if outcome.status is not Status.SOLVE_SUCCEEDED:
        return None
    moves = radius * outcome.unknowns
    return np.append(moves, makes_up @ moves + late), outcome.weights
