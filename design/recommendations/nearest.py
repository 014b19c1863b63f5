"""What to say where no shaper meets all that is asked: which limits fail, what comes nearest."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from design.analysis.ramp_figures import moving_time_s
from design.errors import DesignError, InfeasibleDesignError
from design.model.actuators.rate_limited import RateLimited
from design.recommendations.candidates import Designed, Refused, design_choice, with_tolerance
from design.recommendations.choices import Choice
from design.recommendations.judging import Candidate, judge_choice, percent, ranges
from design.recommendations.requirements import Question
from design.solvers.budget import Budget

HALVINGS = 6
"""Of the way between two tolerances: a sixty-fourth of their quotient's logarithm is left."""

MAX_REASONS = 3
"""Refusals that are repeated where nothing at all could be designed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Limit:
    """One limit that may be given up.

    Attributes
    ----------
    fields
        Requirements that it is made of.
    size
        How far a candidate is from it, least is nearest.
    describe
        What the nearest is, in words.
    """

    fields: tuple[str, ...]
    size: Callable[[Candidate], float]
    describe: Callable[[Candidate], str]


def unmet(
    question: Question,
    ranked: Sequence[Candidate],
    refused: Sequence[Refused],
    budget: Budget,
) -> InfeasibleDesignError:
    """Return the error that no shaper meets the requirements.

    For each limit it reports what can be met if that one alone is dropped. Where a longest duration
    is asked, kinds that are designed for a band are designed anew for larger tolerances, to find
    the least that can be left in that time.

    Parameters
    ----------
    question
        What is asked.
    ranked
        Shapers that were designed, in the order of the answer; each misses a requirement.
    refused
        Shapers that could not be designed.
    budget
        Work that is left for easier ones.

    Returns
    -------
    InfeasibleDesignError
        With the nearest shapers; to be raised by the caller.
    """
    if not ranked:
        reasons = [f"{one.choice.name}: {one.reason}" for one in refused[:MAX_REASONS]]
        return InfeasibleDesignError(
            f"no shaper could be designed; {'; '.join(reasons)}", code="none_designed"
        )
    eased = [*ranked, *_eased_candidates(question, ranked, budget)]
    faults = [
        (limit.fields[0], limit.describe(nearest))
        for limit in _limits(question)
        for nearest in _nearest(limit, eased)
    ]
    told = [detail for _, detail in faults]
    if not faults:
        nearest = min(ranked, key=lambda one: (len(one.missed), one.end_s))
        missed = [verdict.reason for verdict in nearest.unmet]
        told = [
            f"dropping any single limit does not help; {nearest.name} comes closest: "
            f"{', '.join(missed)}"
        ]
        faults = [(verdict.requirement, verdict.reason) for verdict in nearest.unmet]
    if question.requirements.max_duration_s is not None:
        told += shortest_possible(question, ranked)
    told += [f"{one.choice.name} {one.reason}" for one in refused if not one.searched]
    limits = _describe_limits(question)
    return InfeasibleDesignError(
        f"none of {len(ranked)} designed shapers meets all of {limits}: {'; '.join(told)}",
        code="none_meets_all",
        faults=tuple(faults),
    )


def _describe_limits(question: Question) -> str:
    """Return every limit in words, the tolerance with where it is asked."""
    asked = question.requirements
    limits = [
        f"tolerance {asked.tolerance:g} {ranges(question)}",
        f"a command between {asked.lowest_command:g} and {asked.highest_command:g}",
    ]
    if asked.sign != "any":
        limits.append(f"sign {asked.sign}")
    for name in ("max_duration_s", "max_high_mode_gain", "drive_off_by"):
        if getattr(asked, name) is not None:
            limits.append(f"{name} {getattr(asked, name):g}")
    if asked.sample_time_s is not None:
        limits.append(f"samples of {asked.sample_time_s:g} s")
    if asked.firmware is not None:
        limits.append(f"a shaper of {asked.firmware.title}")
    return ", ".join(limits)


def _nearest(limit: _Limit, candidates: Sequence[Candidate]) -> Iterator[Candidate]:
    """Yield the candidate nearest to one limit of those that meet all others, if there is one."""
    others = [
        one
        for one in candidates
        if set(one.missed) <= set(limit.fields) and limit.size(one) < math.inf
    ]
    if others:
        yield min(others, key=lambda one: (limit.size(one), one.end_s))


def _largest_residual(one: Candidate) -> float:
    """Return the residual of a shaper as designed, as played, with its drive off [-]."""
    played = [told.value for told in one.verdicts if told.requirement == "firmware"]
    values = (math.inf if value is None else value for value in played)
    return max(one.designed.largest, *values) if played else one.designed.largest


def _limits(question: Question) -> Iterator[_Limit]:
    asked = question.requirements
    yield _Limit(
        fields=("tolerance", "drive_off_by", "firmware"),
        size=_largest_residual,
        describe=lambda one: (
            "within the other limits the smallest residual found is "
            f"{percent(_largest_residual(one))}, by {one.name}, {one.end_s:.4g} s"
        ),
    )
    if asked.drive_off_by is not None:
        yield _Limit(
            fields=("drive_off_by",),
            size=lambda one: one.end_s,
            describe=lambda one: f"with the drive as given, {one.name} serves, {one.end_s:.4g} s",
        )
    if asked.firmware is not None:
        title = asked.firmware.title
        yield _Limit(
            fields=("firmware",),
            size=lambda one: one.end_s,
            describe=lambda one: (
                f"without what {title} makes of it, {one.name} serves, {one.end_s:.4g} s"
            ),
        )
    if asked.max_duration_s is not None:
        yield _Limit(
            fields=("max_duration_s",),
            size=lambda one: one.end_s,
            describe=lambda one: (
                f"the shortest found that meets the other limits takes {one.end_s:.4g} s, "
                f"{one.name}"
            ),
        )
    if asked.sign != "any":
        yield _Limit(
            fields=("sign",),
            size=lambda one: one.end_s,
            describe=lambda one: (
                f"with another sign than {asked.sign}, {one.name} serves, {one.end_s:.4g} s"
            ),
        )
    yield _Limit(
        fields=("lowest_command", "highest_command"),
        size=lambda one: max(
            asked.lowest_command - one.lowest_command, one.highest_command - asked.highest_command
        ),
        describe=lambda one: (
            f"with a command from {one.lowest_command:.4g} to {one.highest_command:.4g}, "
            f"{one.name} serves, {one.end_s:.4g} s"
        ),
    )
    if asked.max_high_mode_gain is not None:
        yield _Limit(
            fields=("max_high_mode_gain",),
            size=lambda one: one.high_mode_gain,
            describe=lambda one: (
                f"the least high-mode gain found is {one.high_mode_gain:.3g}, of {one.name}, "
                f"{one.end_s:.4g} s"
            ),
        )


def shortest_possible(question: Question, ranked: Sequence[Candidate]) -> Iterator[str]:
    """Yield what is proven of the duration of all shapers of a class.

    The shortest bound comes first.

    Parameters
    ----------
    question
        What is asked.
    ranked
        Shapers that were designed, some of them with a lower bound of their class.

    Yields
    ------
    str
        A sentence with the bound [s].
    """
    asked = question.requirements
    bounds: dict[str, float] = {}
    for candidate in ranked:
        bound = candidate.designed.lower_bound_s
        if bound is not None:
            what = "positive shaper"
            if isinstance(question.actuator, RateLimited):  # that of any course within the limits
                what = "command between 0 and 1"
            if candidate.designed.choice.options.get("amplitudes") == "negative":
                limits = f"{asked.lowest_command:.4g} and {asked.highest_command:.4g}"
                what = f"command between {limits}"
            bounds[what] = max(bound, bounds.get(what, 0.0))
    if asked.sign == "unity":
        bounds.pop("positive shaper", None)
    for what, bound in sorted(bounds.items(), key=lambda item: item[1]):
        yield (
            f"no {what} that keeps {percent(asked.tolerance)} over the band takes less than "
            f"{bound:.4g} s (proven)"
        )


def _eased_candidates(
    question: Question, ranked: Sequence[Candidate], budget: Budget
) -> Iterator[Candidate]:
    """Yield shapers over the band that leave little more than the least in the longest time."""
    longest = question.requirements.max_duration_s
    if longest is None:
        return
    short = [
        one.designed.largest
        for one in ranked
        if one.end_s <= longest and set(one.missed) <= {"tolerance", "drive_off_by"}
    ]
    for candidate in ranked:
        choice = candidate.designed.choice
        if candidate.end_s <= longest or "half_width" not in choice.options:
            continue
        low, high = question.requirements.tolerance, min([*short, MAX_TOLERANCE])
        if high <= low:
            continue
        for _ in range(HALVINGS):
            if budget.spent:
                return
            middle = math.sqrt(low * high)
            found = _ease_to(choice, middle, question, budget)
            if found is None or moving_time_s(found.found.impulses, question.actuator) > longest:
                low = middle
                continue
            yield judge_choice(found, question)
            high = middle


MAX_TOLERANCE = 0.5
"""Largest residual over a band that a shaper is designed for: above it little is suppressed [-]."""


def _ease_to(
    choice: Choice, tolerance: float, question: Question, budget: Budget
) -> Designed | None:
    try:
        return design_choice(with_tolerance(choice, tolerance), question, budget)
    except DesignError:
        return None  # what is offered instead must not fail the answer
