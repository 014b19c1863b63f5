"""Steps moved between samples so that nothing remains, behind limits to acceleration.

A limited drive follows a step over many samples, so that a share of it says little: one of more
than the drive does in a sample is followed as the whole is. What matters is how far the drive gets
in that sample. A step at a time between two samples stands for the level at which a reference
stops that follows the old command up to there and the new one from there on.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from design.analysis.residual import residual_vectors
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.ramps import ramped
from design.moves.program_task import MAX_EVALUATIONS, ProgramTask
from design.moves.programs_by_shares import NO_STEP, SLOPE_SHARE
from design.moves.step_responses import circle, swinging, with_derivative
from design.response.closed_form import travel
from design.sampling.sample_grid import ON_SAMPLE
from design.types import BoolArray, FloatArray, IntArray

LATER_TIMES = (0, 1)
"""Samples after the last that steps may be moved to, in the order tried [-]."""

LEVEL_REACHES = ((1, 0), (1, 1), (2, 1), (3, 3))
"""Samples on each side of a step whose levels are solved for, and after the last [-]."""

NO_COMMAND = 1e3
"""What a command without steps is taken to miss [-]."""

MAX_COURSES = 4096
"""Courses remembered: of two commands that differ in one step, those before it are the same [-]."""

MAX_ITERATIONS = 24
"""Newton's steps at most [-]."""

SHIFT = 1e-5
"""Shift of a time for a derivative, a share of the sample [-]."""

SOLVED = 1e-13
"""Residual, and way in radians, that count as zero [-]."""

NEARLY_SOLVED = 1e-10
"""The same, where rounding lets nothing less be found: a tenth of what a proof allows [-]."""

GOOD_STEP = 0.2
"""What of it is missing at most after a step, for slopes to be kept up to date by it [-]."""

SHORTEST_STEP = 1e-3
"""Share of a Newton step below which the search ends [-]."""


def programs_by_times(task: ProgramTask, limits: RateLimited) -> Iterator[Impulses]:
    """Yield commands on samples, of the exact distance wherever one was found.

    First those without residual and slope, as short as can be and near the times of the command;
    then the least found.

    Parameters
    ----------
    task
        What the program must do.
    limits
        Its drive.

    Yields
    ------
    Impulses
        Steps on whole samples.
    """
    least: tuple[float, Impulses] | None = None
    used = 0
    for search in _searches(task, limits):
        if used >= task.evaluations and least is not None:
            break
        found, evaluated = search.solved(task.evaluations - used)
        used += evaluated
        if found is None:
            continue
        played, left = found
        if left <= NEARLY_SOLVED:
            yield played
        elif least is None or left < least[0]:
            least = left, played
    if least is not None:
        yield least[1]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Search:
    """Newton's method from one start: unknowns in bounds, and the command that they stand for."""

    task: ProgramTask
    limits: RateLimited
    start: FloatArray
    lowest: FloatArray
    highest: FloatArray
    command_of: Callable[[FloatArray], Impulses | None]

    def missing(self, at: FloatArray) -> FloatArray:
        """Return what the command of unknowns misses, shape (3,) or (5,)."""
        played = self.command_of(at)
        if played is None:
            return np.full(5 if self.task.slope else 3, NO_COMMAND)
        return _missing(played, self.task, self.limits)

    def way_missing(self, at: FloatArray) -> FloatArray:
        """Return the way that the command of unknowns misses, shape (1,) [rad]."""
        played = self.command_of(at)
        if played is None:
            return np.full(1, NO_COMMAND)
        return np.array([_way_missing(played, self.task, self.limits)])

    def solved(self, most: int) -> tuple[tuple[Impulses, float] | None, int]:
        """Return the command found, of the exact distance, and its residual or slope.

        Parameters
        ----------
        most
            Commands that may be judged [-].

        Returns
        -------
        tuple
            None where not even the distance was met; and how many commands were judged.
        """
        bounds = self.lowest, self.highest
        at, values, evaluated = newton_in_bounds(self.missing, self.start, *bounds, most)
        if np.abs(values).max() > NEARLY_SOLVED:
            at, way, _ = newton_in_bounds(self.way_missing, at, *bounds, MAX_EVALUATIONS)
            if np.abs(way).max() > NEARLY_SOLVED:
                return None, evaluated
            values = self.missing(at)
        played = self.command_of(at)
        return None if played is None else (played, float(np.abs(values).max())), evaluated


def _searches(task: ProgramTask, limits: RateLimited) -> Iterator[_Search]:
    """Yield searches: over the times of the steps, then over the levels of the samples there."""
    positions = task.command.times_s / task.sample_time_s
    end = int(np.ceil(positions[-1] - ON_SAMPLE))
    for later in LATER_TIMES:
        lowest, highest = np.zeros(positions.size), np.full(positions.size, float(end + later))
        if task.swing is not None:
            highest[0] = 0.0
        yield _Search(
            task=task,
            limits=limits,
            start=np.minimum(positions, highest),
            lowest=lowest,
            highest=highest,
            command_of=lambda at: played_at(at, task, limits),
        )
    for reach, later in LEVEL_REACHES:
        around = np.add.outer(np.arange(-reach, reach + 1), np.floor(positions).astype(int))
        numbers = np.unique(np.clip(around, 0, end + later - 1))
        begun = np.searchsorted(positions, numbers, side="right") - 1
        levels = np.clip(np.cumsum(task.command.amplitudes), 0.0, None)
        first = played_at(positions, task, limits)
        if first is None:
            return
        highest = np.full(numbers.size, float(levels.max()))
        of_first = np.concatenate(([0.0], np.cumsum(first.amplitudes)))
        whole = np.rint(first.times_s / task.sample_time_s)
        yield _Search(
            task=task,
            limits=limits,
            start=np.clip(of_first[np.searchsorted(whole, numbers, side="right")], 0.0, highest),
            lowest=np.zeros(numbers.size),
            highest=highest,
            command_of=_levels_played(task, numbers, end + later, levels[begun]),
        )


def _levels_played(
    task: ProgramTask, numbers: IntArray, end: int, whole: FloatArray
) -> Callable[[FloatArray], Impulses | None]:
    """Return how levels on samples are played; between runs of samples the command's own hold."""
    breaks = np.flatnonzero(np.diff(numbers) > 1)
    after = np.append(numbers[breaks] + 1, end)
    held = np.append(whole[breaks], 0.0)

    def played(levels: FloatArray) -> Impulses | None:
        samples = np.concatenate((numbers, after))
        order = np.argsort(samples, kind="stable")
        return _command(samples[order], np.concatenate((levels, held))[order], task)

    return played


def _command(numbers: IntArray, levels: FloatArray, task: ProgramTask) -> Impulses | None:
    """Return levels from samples on as a command; None where it is at rest throughout."""
    heights = np.diff(levels, prepend=0.0)
    used = np.abs(heights) > NO_STEP
    if not used.any() or (task.swing is not None and not used[0]):
        return None
    sent = levels[used]
    sent[-1] = 0.0
    return Impulses(
        times_s=task.sample_time_s * numbers[used], amplitudes=np.diff(sent, prepend=0.0)
    )


def _missing(played: Impulses, task: ProgramTask, limits: RateLimited) -> FloatArray:
    """Return the way missing [rad], then residual and slope of a command as it is played."""
    mode = task.mode
    reference = ramped(played, limits)
    lasting = float(reference.times_s[-1] + reference.ramps_s[-1] - reference.times_s[0])
    ratios = circle(mode, lasting, slope=task.slope)
    poles = mode.pole_rad_s * ratios
    accel, decel = (lag.denominator(poles) for lag in (limits.accel_lag, limits.decel_lag))
    vectors = residual_vectors(played, poles, limits)
    # A swing counts from time 0, where its command begins.
    since = lasting + float(reference.times_s[0])
    vectors = vectors + np.exp(poles * since) * accel * swinging(task.swing, mode, ratios)
    left = with_derivative(vectors * decel, ratios) / decel[0]
    left = left * np.array([1.0, SLOPE_SHARE])[: left.size]
    return np.concatenate(([_way_missing(played, task, limits)], left.real, left.imag))


def _way_missing(played: Impulses, task: ProgramTask, limits: RateLimited) -> float:
    return task.mode.natural_frequency_rad_s * (travel(played, limits) - task.travel_s)


def newton_in_bounds(
    missing: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    lowest: FloatArray,
    highest: FloatArray,
    most: int,
) -> tuple[FloatArray, FloatArray, int]:
    """Return where values are zero near a start, and the values.

    Newton's method for fewer equations than unknowns, by the least change; where they are zero
    nowhere near, the least found. Slopes are brought up to date after each good step (Broyden),
    and are differenced anew after any other.

    Parameters
    ----------
    missing
        The values by the unknowns, shapes (k,) and (n,).
    start, lowest, highest
        Where it begins, and the bounds of the unknowns, shape (n,).
    most
        Evaluations after which no further step begins [-].

    Returns
    -------
    tuple
        Unknowns and values, shapes (n,) and (k,), and the evaluations made.
    """
    at, free = start, lowest < highest
    values, evaluated = missing(at), 1
    slopes: FloatArray = np.zeros((values.size, at.size))
    fresh = known = False
    for _ in range(MAX_ITERATIONS):
        before = float(np.abs(values).max())
        if before <= SOLVED or evaluated >= most:
            break
        if not known:
            slopes, fresh, known = _slopes(missing, at, values, free), True, True
            evaluated += int(free.sum())
        step = _newton_step(slopes, at, values, lowest, highest)
        share, tried, now = 1.0, at, values
        while share > SHORTEST_STEP:
            tried = np.clip(at + share * step, lowest, highest)
            now = missing(tried)
            evaluated += 1
            # Of slopes that were only brought up to date nothing less than a good step is taken.
            if np.abs(now).max() < (before if fresh else GOOD_STEP * before):
                break
            share = share / 2 if fresh else 0.0
        if share <= SHORTEST_STEP:
            if fresh:
                break
            known = False
            continue
        moved = tried - at
        slopes = slopes + np.outer(now - values - slopes @ moved, moved) / (moved @ moved)
        at, values, fresh = tried, now, False
    return at, values, evaluated


def _slopes(
    missing: Callable[[FloatArray], FloatArray],
    times: FloatArray,
    values: FloatArray,
    free: BoolArray,
) -> FloatArray:
    """Return how the values change with each time, shape (values, times)."""
    slopes = np.zeros((values.size, times.size))
    for number in np.flatnonzero(free).tolist():
        # Away from whole numbers, where a step comes to another sample, and from the bounds.
        side = SHIFT if times[number] % 1 < 1 / 2 else -SHIFT
        shifted = times.copy()
        shifted[number] += side
        slopes[:, number] = (missing(shifted) - values) / side
    return slopes


def _newton_step(
    slopes: FloatArray,
    times: FloatArray,
    values: FloatArray,
    lowest: FloatArray,
    highest: FloatArray,
) -> FloatArray:
    """Return the least change of times that makes the values zero to first order, in bounds."""
    free = lowest < highest
    step = np.zeros(times.size)
    for _ in range(times.size):
        rest = -values - slopes[:, ~free] @ step[~free]
        step[free] = np.linalg.lstsq(slopes[:, free], rest)[0]
        over = free & ((times + step < lowest) | (times + step > highest))
        if not over.any():
            break
        step[over] = np.clip(times + step, lowest, highest)[over] - times[over]
        free &= ~over
    return step


def played_at(positions: FloatArray, task: ProgramTask, limits: RateLimited) -> Impulses | None:
    """Return the command that stands for steps between samples.

    Parameters
    ----------
    positions
        Times in samples, ascending, one for each step, shape (n,) [-].
    task, limits
        What the program must do, and its drive.

    Returns
    -------
    Impulses or None
        One step for each on a sample, two for each between samples, less where these meet; None
        where nothing is left.
    """
    levels = np.concatenate(([0.0], np.cumsum(task.command.amplitudes)))
    levels[-1] = 0.0
    highest = float(levels.max())
    sent: dict[int, float] = {}
    for number, position in enumerate(np.maximum.accumulate(positions).tolist()):
        old, new = levels[number], levels[number + 1]
        sample = int(np.floor(position + ON_SAMPLE))
        if abs(position - sample) <= ON_SAMPLE:
            sent[sample] = new
            continue
        share = 1 - (position - sample)
        before = tuple((at, sent[at]) for at in sorted(sent) if at < sample)
        under = [
            _stopping_level((*before, (sample, level)), sample + 1, task.sample_time_s, limits)
            for level in (old, new)
        ]
        level = min(max(under[0] + share * (under[1] - under[0]), 0.0), highest)
        # Two steps within one sample: the level is that of the last, less what the first kept.
        if sample in sent:
            level = min(max(level + sent[sample] - old, 0.0), highest)
        sent[sample] = level
        sent[sample + 1] = new
    numbers = np.array(sorted(sent))
    return _command(numbers, np.array([sent[number] for number in numbers.tolist()]), task)


@lru_cache(maxsize=MAX_COURSES)
def _stopping_level(
    sent: tuple[tuple[int, float], ...], sample: int, sample_time_s: float, limits: RateLimited
) -> float:
    """Return where a reference stops that brakes from a sample on [-]."""
    numbers, goals = zip(*sent, strict=True)
    if limits.jerk_limit_m_s3 is None:
        rise, fall = (sample_time_s / ramp_s for ramp_s in limits.unit_ramps_s)
        level = 0.0
        for goal, (number, after) in zip(goals, pairwise([*numbers, sample]), strict=True):
            lasting = after - number
            level = (
                min(goal, level + rise * lasting)
                if goal > level
                else max(goal, level - fall * lasting)
            )
        return level
    heights = np.diff(goals, prepend=0.0)
    if not heights.any():
        return 0.0
    course = ramped(Impulses(times_s=sample_time_s * np.array(numbers), amplitudes=heights), limits)
    end = sample * sample_time_s
    begun = course.times_s < end
    times, ramps = course.times_s[begun], course.ramps_s[begun]
    changes, bends = course.changes[begun], course.bends[begun]
    shares = np.minimum((end - times) / ramps, 1.0)
    level = float(changes @ (shares * (1 + bends * (shares - 1))))
    if not begun.any() or shares[-1] == 1:
        return level
    slope = float(changes[-1] / ramps[-1] * (1 + bends[-1] * (2 * shares[-1] - 1)))
    return level + slope * abs(slope) / (2 * limits.jerk_limit_m_s3 / limits.speed_m_s)
