"""Steps shared between samples so that nothing remains, behind drives without limits."""

from collections.abc import Iterator

import numpy as np

from design.model.impulses import Impulses
from design.moves.program_task import ProgramTask
from design.moves.sample_shares import SampleShares, sample_shares
from design.moves.step_responses import StepResponses, step_responses
from design.solvers.nearest_point import Polyhedron, nearest_point
from design.types import BoolArray, FloatArray

REACHES = ((1, 0), (2, 0), (3, 0), (4, 0), (2, 1), (4, 1), (4, 3), (12, 12))
"""Samples on each side of a step, and samples after the last, in the order tried [-]."""

NO_STEP = 1e-9
"""Share below which a sample has no step: far above rounding, far below what is measured [-]."""

SLOPE_SHARE = 0.05
"""What a slope counts beside a residual, where both cannot be zero: an error of 5 % [-]."""

NEARNESS = 1e-9
"""What a distance to the linear split counts beside the square of the residual [-]."""

INWARD = 1e-4
"""Share of the way from the least residual back to the linear split's, clear of rounding [-]."""

MAX_SUPPORTS = 12
"""How often samples without a step are left out before others are tried [-]."""


def programs_by_shares(task: ProgramTask) -> Iterator[Impulses]:
    """Yield commands on samples, all of the exact distance.

    First those without residual and slope, on more samples each time and each the nearest to the
    linear split; where none is exact, the least that the most samples can.

    Parameters
    ----------
    task
        Behind a drive without limits, for which all is linear in the shares.

    Yields
    ------
    Impulses
        Steps on whole samples, of the command's signs.
    """
    tried: list[SampleShares] = []
    for reach, later in REACHES:
        shares = sample_shares(
            task.command,
            task.sample_time_s,
            reach=reach,
            later=later,
            fix_first=task.swing is not None,
        )
        if tried and np.array_equal(shares.numbers, tried[-1].numbers):
            continue
        tried.append(shares)
        found = _solved(task, shares, exact=True)
        if found is not None:
            yield found
    for exact_residual in (True, False) if task.slope else (False,):
        for shares in reversed(tried):
            found = _solved(task, shares, exact=False, exact_residual=exact_residual)
            if found is not None:
                yield found
                break


def _solved(
    task: ProgramTask, shares: SampleShares, *, exact: bool, exact_residual: bool = False
) -> Impulses | None:
    """Return the best steps on these samples; None where there are none.

    Behind a switched drive a set takes over at the first step of its sign: samples before it,
    which end up without a step, are left out, and the rest solved again.
    """
    for _ in range(MAX_SUPPORTS):
        times = task.sample_time_s * shares.numbers
        responses = step_responses(
            times, shares.rising, task.mode, task.actuator, swing=task.swing, slope=task.slope
        )
        steps = _best(task, shares, responses, exact=exact, exact_residual=exact_residual)
        if steps is None:
            return None
        begun = _begun(np.abs(steps) > NO_STEP, shares.rising)
        if task.swing is not None and not begun[0]:
            return None
        if begun.all() or task.actuator.model == "superposed":
            break
        shares = shares.only(begun)
    else:
        return None
    return _on_levels(task, shares, steps)


def _begun(stepping: BoolArray, rising: BoolArray) -> BoolArray:
    """Return which samples are not before the first step of their run of one sign, shape (m,)."""
    runs = np.concatenate(([0], np.cumsum(rising[1:] != rising[:-1])))
    steps = np.cumsum(stepping)
    before_run = np.concatenate(([0], steps))[np.searchsorted(runs, runs)]
    begun: BoolArray = steps > before_run
    return begun


def _best(
    task: ProgramTask,
    shares: SampleShares,
    responses: StepResponses,
    *,
    exact: bool,
    exact_residual: bool,
) -> FloatArray | None:
    """Return heights of the steps, shape (m,)."""
    groups = (shares.groups == np.arange(shares.totals.size)[:, None]).astype(float)
    if not groups.any(axis=1).all():
        return None
    # A move ends at rest: the way counts from any sample alike.
    w = task.mode.natural_frequency_rad_s
    equations = np.concatenate((groups, w * responses.travel_s[None]))
    wanted = np.append(shares.totals, w * task.travel_s)
    rows = np.concatenate((responses.vectors.real, responses.vectors.imag))
    goals = -np.concatenate((responses.swings.real, responses.swings.imag))
    bounds, least = _bounds(task.command, shares)

    def nearest(held: FloatArray, values: FloatArray) -> FloatArray | None:
        return nearest_point(
            shares.split,
            Polyhedron(
                equations=np.concatenate((equations, held)),
                wanted=np.concatenate((wanted, values)),
                bounds=bounds,
                least=least,
            ),
        )

    if exact:
        return nearest(rows, goals)
    held = np.zeros(len(rows), dtype=np.bool_)
    held[:: len(responses.vectors)] = exact_residual
    base = nearest(rows[held], goals[held])
    if base is None:
        return None
    weights = np.where(np.arange(len(rows)) % len(responses.vectors) == 0, 1.0, SLOPE_SHARE)
    aimed, targets = (weights[:, None] * rows)[~held], (weights * goals)[~held]
    # min |A x - b|^2 + e |x - x0|^2 is a nearest point again, of L' x where L L' = A' A + e.
    lower = np.linalg.cholesky(aimed.T @ aimed + NEARNESS * np.eye(base.size))
    turned = nearest_point(
        np.linalg.solve(lower, aimed.T @ targets + NEARNESS * shares.split),
        Polyhedron(
            equations=np.linalg.solve(lower, np.concatenate((equations, rows[held])).T).T,
            wanted=np.concatenate((wanted, goals[held])),
            bounds=np.linalg.solve(lower, bounds.T).T,
            least=least,
        ),
    )
    if turned is None:
        return base
    # Those coordinates cost digits: the same residual once more, a hair within what can be.
    left = rows @ np.linalg.solve(lower.T, turned)
    sharp = nearest(rows, left + INWARD * (rows @ base - left))
    return base if sharp is None else sharp


def _bounds(command: Impulses, shares: SampleShares) -> tuple[FloatArray, FloatArray]:
    """Return rows and least values: signs of the steps, and levels where steps cross."""
    signs = np.diag(np.where(shares.rising, 1.0, -1.0))
    crossed: BoolArray = shares.crossed[shares.groups]
    levels = np.tril(np.ones((shares.numbers.size, shares.numbers.size)))[crossed]
    highest = float(np.cumsum(command.amplitudes).max())
    rows = np.concatenate((signs, levels, -levels))
    least = np.zeros(len(rows))
    least[len(signs) + len(levels) :] = -highest
    return rows, least


def _on_levels(task: ProgramTask, shares: SampleShares, steps: FloatArray) -> Impulses:
    """Return the steps as a command whose levels are those of the command between the groups."""
    used = np.abs(steps) > NO_STEP
    numbers, groups = shares.numbers[used], shares.groups[used]
    levels = np.cumsum(steps[used])
    ends = np.append(np.flatnonzero(np.diff(groups)), groups.size - 1)
    levels[ends] = np.cumsum(shares.totals)[groups[ends]]
    levels[-1] = 0.0
    return Impulses(times_s=task.sample_time_s * numbers, amplitudes=np.diff(levels, prepend=0.0))
