"""A move as a controller replays it on its samples: designed on them, judged as it is played."""

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.analysis.judge import Judgement, judge
from design.analysis.residual import residual_vibration
from design.analysis.warnings import DesignWarning
from design.checks import MIN_VALUE, require_between
from design.claims import ZERO_LIMITS, Quantity, zeros
from design.errors import InvalidInputError
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode
from design.moves.program_task import ProgramTask
from design.moves.programs_by_shares import programs_by_shares
from design.moves.programs_by_times import programs_by_times
from design.response.closed_form import AT_REST, travel
from design.sampling.sample_grid import ON_SAMPLE, split
from design.types import FloatArray

MAX_SAMPLES = 1_000_000
"""Longest program, a bound on the work of one request."""

SHORTER = (2 / 3, 1 / 2, 1 / 4)
"""Samples tried, over those asked for, where nothing exact is found on these [-]."""

WAY_OUT_EVALUATIONS = 150
"""Commands judged at most on each of these, behind limits [-]."""

RESIDUAL: tuple[Quantity, ...] = ("residual",)
"""What every program makes zero."""

DISTANCE_SHARE = 1e-9
"""Share of its length by which a move may miss its distance: rounding [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Program:
    """A command on a controller's samples.

    Attributes
    ----------
    times_s
        Samples from the first step of the command to the last of the program, shape (n,) [s].
    velocity_m_s
        Velocity over the sample that follows, shape (n,): replayed and held, it meets every
        position [m/s].
    position_m
        Position at each sample, linear between two, shape (n,) [m].
    distance_m
        Way behind the drive as it is played, signed; where both sets of the drive are alike, the
        last position [m].
    residual
        Residual vibration of the velocities as they are played, a share of one unshaped step [-].
    warnings
        One with that figure where it is not zero, and of a slope or a distance that is missed.
    """

    times_s: FloatArray
    velocity_m_s: FloatArray
    position_m: FloatArray
    distance_m: float
    residual: float
    warnings: tuple[DesignWarning, ...]


def program(
    command: Impulses,
    mode: Mode,
    actuator: Actuator,
    speed_m_s: float,
    sample_time_s: float,
    swing: FreeSwing | None = None,
    claims: Collection[Quantity] = RESIDUAL,
) -> Program:
    """Return a command as positions and velocities at a sample time.

    Each step is shared between samples so that nothing remains as it is played behind the drive,
    over the same distance: on the fewest samples that do it, near the command. Where no shares
    found do it, those with the least residual are taken, and a warning has the figure.

    Parameters
    ----------
    command
        Steps as shares of the speed, the first at time 0.
    mode, actuator
        The plant's mode and its drive.
    speed_m_s
        Full speed, signed [m/s].
    sample_time_s
        Time between samples, > 0, at most half a period of the plant [s].
    swing
        What the payload swings already at the first step.
    claims
        What is to be zero as played: ``residual``, and ``slope`` where the move claims it.

    Returns
    -------
    Program
        What is sent at each sample, with what remains of it.

    Raises
    ------
    InvalidInputError
        If the sample time is longer than the command or half a period of the plant, or so short
        that there are too many samples.
    """
    _require_samples(command, mode, sample_time_s)
    task = ProgramTask(
        command=command,
        mode=mode,
        actuator=actuator,
        swing=swing,
        sample_time_s=sample_time_s,
        slope="slope" in claims,
        travel_s=travel(command, actuator) if _is_to_rest(command) else math.nan,
    )
    played, judged = _played(task)
    numbers = np.rint(played.times_s / sample_time_s).astype(int)
    held = np.diff(numbers, prepend=0)
    levels = np.cumsum(played.amplitudes)
    levels[np.abs(levels) < AT_REST] = 0.0
    levels[-1] = _sum(command)
    # Each sample's level, and the way made at it were that its level from the start.
    moments = np.cumsum(played.amplitudes * numbers)
    counts = np.append(held, 1)
    level = np.repeat(np.append(0.0, levels), counts)
    moment = np.repeat(np.append(0.0, moments), counts)
    samples = np.arange(level.size)
    way_s = travel(played, actuator) if _is_to_rest(command) else math.nan
    return Program(
        times_s=sample_time_s * samples,
        velocity_m_s=speed_m_s * level,
        position_m=speed_m_s * sample_time_s * (level * samples - moment),
        distance_m=speed_m_s * way_s,
        residual=judged.residual,
        warnings=tuple(_warnings(task, played, judged)),
    )


def _require_samples(command: Impulses, mode: Mode, sample_time_s: float) -> None:
    longest_s = max(min(command.duration_s, mode.period_s / 2), MIN_VALUE)
    require_between("sample_time_s", sample_time_s, MIN_VALUE, longest_s)
    if math.ceil(command.times_s[-1] / sample_time_s - ON_SAMPLE) >= MAX_SAMPLES:
        raise InvalidInputError(
            "sample_time_s",
            sample_time_s,
            f"such that there are fewer than {MAX_SAMPLES} samples",
            code="too_many_samples",
        )


def _played(task: ProgramTask) -> tuple[Impulses, Judgement]:
    """Return the first program that is verified, or else the one with the least residual."""
    best: tuple[Impulses, Judgement] | None = None
    for played in _designed(task):
        judged = _judged(task, played)
        if judged.certificate.verified:
            return played, judged
        if best is None or _excess(judged) < _excess(best[1]):
            best = played, judged
    if best is None:
        played = split(task.command, task.sample_time_s)
        best = played, _judged(task, played)
    return best


def _designed(task: ProgramTask) -> Iterator[Impulses]:
    """Yield programs, those on the fewest samples first."""
    command = task.command
    on_samples = split(command, task.sample_time_s)
    if on_samples.times_s.size == command.times_s.size and np.allclose(
        on_samples.times_s, command.times_s, rtol=0, atol=ON_SAMPLE * task.sample_time_s
    ):
        yield on_samples
    # What is no move, or reverses on its way, is shared as it is.
    if not _is_to_rest(command) or np.cumsum(command.amplitudes).min() < -AT_REST:
        return
    if isinstance(task.actuator, RateLimited):
        yield from programs_by_times(task, task.actuator)
    else:
        yield from programs_by_shares(task)


def _judged(task: ProgramTask, played: Impulses) -> Judgement:
    names: list[Quantity] = ["residual", "slope"] if task.slope else ["residual"]
    return judge(
        played, (task.mode,), task.actuator, zeros(names), name="the program", swing=task.swing
    )


def _excess(judged: Judgement) -> tuple[float, ...]:
    """Return by how much claims are missed, the residual first."""
    return tuple(
        0.0 if claim.holds else claim.value / claim.limit for claim in judged.certificate.claims
    )


def _sum(command: Impulses) -> float:
    return 0.0 if _is_to_rest(command) else float(command.amplitudes.sum())


def _is_to_rest(command: Impulses) -> bool:
    heights = command.amplitudes
    return bool(abs(heights.sum()) <= AT_REST * np.abs(heights).sum())


def _warnings(task: ProgramTask, played: Impulses, judged: Judgement) -> Iterator[DesignWarning]:
    """Yield what a program misses, each with its figure."""
    by_name = {claim.quantity: claim for claim in judged.certificate.claims}
    on_samples = f"played on samples of {task.sample_time_s:g} s, each velocity held,"
    if not by_name["residual"].holds:
        between = residual_vibration(task.command, task.mode, task.actuator, task.swing)
        yield DesignWarning(
            code="program_residual",
            detail=f"{on_samples} the residual of the program is {100 * judged.residual:.4g} % of "
            "an unshaped step; that of its command, whose steps fall between the samples, is "
            f"{100 * between:.4g} %. {_way_out(task, between)}",
        )
    elif "slope" in by_name and not by_name["slope"].holds:
        yield DesignWarning(
            code="program_slope",
            detail=f"{on_samples} the residual of the program is zero, and its slope is not: with "
            f"an error of 1 % in the frequency it is some {by_name['slope'].value:.3g} % of an "
            f"unshaped step. {_way_out(task, 0.0)}",
        )
    if not _is_to_rest(task.command):
        return
    missed = travel(played, task.actuator) - task.travel_s
    if abs(missed) > DISTANCE_SHARE * abs(task.travel_s):
        yield DesignWarning(
            code="program_distance",
            detail=f"{on_samples} the program goes {100 * missed / task.travel_s:.3g} % "
            "farther than its move",
        )


def _way_out(task: ProgramTask, between: float) -> str:
    """Return the nearest change that would leave nothing, in words."""
    if between > ZERO_LIMITS["residual"]:
        return "A kind of shaper that is designed for this drive would come to less"
    for share in SHORTER:
        finer = replace(
            task, sample_time_s=share * task.sample_time_s, evaluations=WAY_OUT_EVALUATIONS
        )
        if task.command.times_s[-1] / finer.sample_time_s >= MAX_SAMPLES:
            break
        if _played(finer)[1].certificate.verified:
            return f"Samples of {finer.sample_time_s:.4g} s would leave nothing"
    return "Samples much shorter than those would come to less"
