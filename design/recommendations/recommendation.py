"""The fastest shaper that meets what is asked, its runners-up, and why."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from design.analysis.high_modes import HIGH_MODES
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.recommendations.candidates import Refused, effort, try_choice
from design.recommendations.choices import choices, serves
from design.recommendations.judging import Candidate, judge_choice, percent, ranges
from design.recommendations.nearest import shortest_possible, unmet
from design.recommendations.requirements import Question, Requirements, question_of
from design.shapers.registry import SHAPERS
from design.solvers.budget import Budget

NO_GAIN = 1 + 1e-6
"""High-mode gain of a shaper that is no worse there than none [-]."""

SAME = 1e-6
"""Shapers whose times over their duration, and amplitudes, differ by less are the same [-]."""

MAX_WORK_PER_RECOMMENDATION = 3_000_000
"""What all searches of one recommendation may take: judging takes a second besides [units]."""

DIGITS = 6
"""Digits to which durations are compared: beyond, two ways to the same shaper differ [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recommendation:
    """An answer.

    Attributes
    ----------
    question
        What was asked.
    candidates
        Shapers that meet all of it, the recommended one first, then by duration; of two that take
        the same, by width of the insensitivity, then by high-mode gain.
    others
        Those that do not, in the same order.
    refused
        Kinds of which there is none here.
    why
        Why the first is recommended, in sentences.
    """

    question: Question
    candidates: tuple[Candidate, ...]
    others: tuple[Candidate, ...]
    refused: tuple[Refused, ...]
    why: tuple[str, ...]

    @property
    def recommended(self) -> Candidate:
        """The fastest that meets all that is asked."""
        return self.candidates[0]


def recommend(plant: Plant, actuator: Actuator, requirements: Requirements) -> Recommendation:
    """Return the fastest shaper that meets the requirements.

    All other shapers follow, with the reasons.

    Every kind of the registry is designed for the middle of what the plant may be and judged by the
    largest residual over all of it, with the actuator given. Kinds for one mode are asked for a
    plant of one, those for several for a plant of several.

    Parameters
    ----------
    plant, actuator
        What moves, and what drives it.
    requirements
        What is asked.

    Returns
    -------
    Recommendation
        Ranked, the recommended first.

    Raises
    ------
    InvalidInputError
        If a requirement breaks its rule or does not go with the plant.
    InfeasibleDesignError
        If none meets all; says which limits fail, and the nearest that can be met.

    Examples
    --------
    >>> from design.model.actuators.ideal import Ideal
    >>> from design.model.plants.pendulum import Pendulum
    >>> crane = Pendulum(cable_length_m=0.8)
    >>> known_well = Requirements(half_width=0.02, sign="positive")
    >>> [one.name for one in recommend(crane, Ideal(), known_well).candidates[:3]]
    ['si', 'zv', 'mzv']
    """  # noqa: DOC501 - `unmet` returns an InfeasibleDesignError
    question = question_of(plant, actuator, requirements)
    found: list[Candidate] = []
    refused: list[Refused] = []
    asked = [
        choice
        for kind in SHAPERS.values()
        if serves(kind, question)
        for choice in choices(kind, question)
    ]
    budget = Budget(most=MAX_WORK_PER_RECOMMENDATION)
    for choice in sorted(asked, key=lambda one: effort(one, question)):
        made = try_choice(choice, question, budget)
        if isinstance(made, Refused):
            refused.append(made)
        else:
            found.append(judge_choice(made, question))
    refused.sort(key=lambda one: asked.index(one.choice))
    ranked = _name_repetitions(sorted(found, key=_rank))
    meeting = tuple(candidate for candidate in ranked if not candidate.missed)
    if not meeting:
        raise unmet(question, ranked, refused, budget)
    return Recommendation(
        question=question,
        candidates=meeting,
        others=tuple(candidate for candidate in ranked if candidate.missed),
        refused=tuple(refused),
        why=tuple(_reasons(question, meeting, ranked)),
    )


def _name_repetitions(ranked: Sequence[Candidate]) -> list[Candidate]:
    """Return the candidates, each that repeats an earlier one with its name."""
    told: list[Candidate] = []
    for candidate in ranked:
        same = next((one.name for one in told if _same(one.impulses, candidate.impulses)), None)
        told.append(replace(candidate, same_as=same))
    return told


def _same(one: Impulses, other: Impulses) -> bool:
    return one.times_s.size == other.times_s.size and bool(
        np.allclose(one.times_s, other.times_s, rtol=0, atol=SAME * one.duration_s)
        and np.allclose(one.amplitudes, other.amplitudes, rtol=0, atol=SAME)
    )


def _rank(candidate: Candidate) -> tuple[float, float, float]:
    return (
        _round(candidate.end_s),
        -_round(candidate.width),
        _round(candidate.high_mode_gain),
    )


def _round(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _reasons(
    question: Question, meeting: Sequence[Candidate], ranked: Sequence[Candidate]
) -> Iterator[str]:
    best = meeting[0]
    many = f"the fastest of {len(meeting)} shapers" if len(meeting) > 1 else "the only shaper"
    yield (
        f"{best.name} is {many} designed here that {'meet' if len(meeting) > 1 else 'meets'} all "
        f"that is asked: it takes {best.end_s:.4g} s, and its residual is at most "
        f"{percent(best.designed.worst_residual)} {ranges(question)}"
    )
    for verdict in best.verdicts:
        if verdict.requirement in {"drive_off_by", "firmware"}:
            yield f"{best.name} {verdict.reason}"
    if len(meeting) > 1:
        yield _over_the_next(best, meeting[1])
    calm = [one for one in meeting if one.high_mode_gain <= NO_GAIN]
    if best.high_mode_gain > NO_GAIN and calm:
        yield (
            f"in a mode at {HIGH_MODES[0]:g} to {HIGH_MODES[1]:g} times the frequency the "
            f"residual of {best.name} is up to {best.high_mode_gain:.3g} times that of an "
            f"unshaped step; where such modes matter, that of {calm[0].name}, "
            f"{calm[0].end_s:.4g} s, is at most that of the step"
        )
    faster = [one for one in ranked if one.missed and one.end_s < best.end_s]
    if faster:
        nearest = min(faster, key=lambda one: (len(one.missed), one.designed.worst_residual))
        missed = [verdict.reason for verdict in nearest.unmet]
        yield (
            f"none of the {len(faster)} faster ones serves; {nearest.name}, "
            f"{nearest.end_s:.4g} s, comes closest, but {' and '.join(missed)}"
        )
    yield from shortest_possible(question, ranked)


def _over_the_next(best: Candidate, second: Candidate) -> str:
    """Say by what the first is ahead of the second."""
    if second.same_as == best.name:
        return f"{second.name} is the same shaper here"
    first, next_one = _rank(best), _rank(second)
    if first[0] < next_one[0]:
        takes = f"the next, {second.name}, takes {second.end_s:.4g} s"
        if best.end_s == 0:  # a single step serves, and no share of its time is more
            return takes
        return f"{takes}, {percent(second.end_s / best.end_s - 1)} more"
    if first[1] < next_one[1]:
        return f"{second.name} takes as long, but is insensitive over a narrower band"
    if first[2] < next_one[2]:
        return f"{second.name} takes as long, but excites high modes more"
    return f"{second.name} is as good in every respect"
