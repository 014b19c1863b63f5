"""Shapers made for a question, and what they leave where it asks.

A shaper with a tolerance keeps it where its theory does; on samples, behind limits and at other
damping ratios it may leave more. It is then designed for a smaller one.
"""

import math
from dataclasses import dataclass, replace

from design.analysis.claims_found import claim_over_band
from design.analysis.warnings import DesignWarning
from design.errors import DesignError
from design.formulations.equations import GapProblem
from design.formulations.formulation import ClosedForm, Convolution
from design.model.actuators.registry import Actuator
from design.model.plants.modes import Modes
from design.model.plants.registry import Plant
from design.pipeline import Design, design
from design.recommendations.choices import Choice
from design.recommendations.requirements import Question
from design.recommendations.worst import drive_off_residual, work_of_worst, worst_residual
from design.sampling.left import cuts_ramps
from design.sampling.sampled_design import SAMPLE_TOLERANCE, sampled_design
from design.sampling.sampled_free import has_free_amplitudes, may_be_between_levels
from design.shapers.several_modes import impulses_of
from design.solvers.budget import Budget

TIGHTENED, TIGHTENED_ON_SAMPLES = 6, 2
"""How often a shaper that misses the tolerance is designed anew for a smaller one, at most.

On samples what is left does not follow the tolerance smoothly, and a search may take half a second.
"""

FOLLOWS = 0.5
"""What is left must fall by this share of what the tolerance does, or it is no use to go on [-]."""

NEARLY = 3.0
"""What a shaper may leave over the tolerance for that to be tried [-]."""

AIM, ENOUGH = 1 - 1e-3, 0.99
"""Where that is aimed at, and where it ends, over the tolerance: the rest is little time [-]."""

SLOWER = 1.01
"""Duration over the first one's for which it goes on: that of most kinds is one for all [-]."""

MAX_PERIODS = {"positive": 12.0, "negative": 4.0}
"""Shapers over a band that are searched, in periods as of `_periods`, by their amplitudes: longer
ones cost ten seconds and more each, as measured for bands to 0.9 and tolerances to 0.001."""

MAX_WORK_PER_SHAPER = 2_000_000
"""What one shaper may take of the budget, designed anew for smaller tolerances too [units]."""

DESIGN_WORK = 20_000.0
"""Work of a design and its judgement, without a search [units]."""

UNITY_SAMPLED_WORK, BAND_SAMPLED_WORK, CUT_SAMPLED_WORK = 400_000.0, 100_000.0, 2_000_000.0
"""Work of bringing unity magnitude to samples, over a band, and with ramps that are cut [units]."""

MAX_CONVOLVED_IMPULSES = 130
"""Impulses of a convolved shaper that is asked, at most: three modes with five each [-]."""

WITHIN = 1 + 1e-9
"""Margin of a tolerance, as of the certificate: an EI shaper lies on it except for rounding."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Designed:
    """A shaper that was made for a question.

    Attributes
    ----------
    choice
        What was designed.
    found
        The design, on samples where asked.
    worst_residual
        Its largest residual in the ranges asked, by simulation [-].
    drive_off_residual
        The same, its drive off by the share that is asked as well; None where none is [-].
    lower_bound_s
        No shaper of its class that keeps the tolerance over the band is as short: proven; None
        where nothing is [s].
    """

    choice: Choice
    found: Design
    worst_residual: float
    drive_off_residual: float | None = None
    lower_bound_s: float | None = None

    @property
    def largest(self) -> float:
        """Largest residual of all that is held against the tolerance [-]."""
        off = self.drive_off_residual
        return self.worst_residual if off is None else off

    @property
    def warnings(self) -> tuple[DesignWarning, ...]:
        """Warnings of the design, except for its own tolerance on samples.

        A verdict says whether the tolerance that was asked for is kept.
        """
        return tuple(one for one in self.found.warnings if one.code != "tolerance_not_kept")


@dataclass(frozen=True, slots=True, kw_only=True)
class Refused:
    """A kind of shaper of which there is none here, or that was not searched for one."""

    choice: Choice
    reason: str
    searched: bool = True


def try_choice(choice: Choice, question: Question, budget: Budget) -> Designed | Refused:
    """Design one shaper and measure its residual, or say why there is none.

    What that takes is spent from the budget; none is searched where that is spent already.

    Parameters
    ----------
    choice
        Kind and parameters.
    question
        What is asked.
    budget
        Work that is left.

    Returns
    -------
    Designed or Refused
        The shaper with its residual, or the reason of the refusal in words.
    """
    kind, asked = choice.kind, question.requirements
    if question.actuator.kind not in kind.actuators:
        return Refused(
            choice=choice,
            reason=f"serves no actuator of kind {question.actuator.kind}, only "
            f"{', '.join(kind.actuators)}",
        )
    if "half_width" in choice.options and hasattr(kind.options, "amplitudes"):
        periods = _periods(choice.options["half_width"], asked.tolerance)
        if periods > MAX_PERIODS[choice.options.get("amplitudes", "positive")]:
            return Refused(
                choice=choice,
                reason="is not searched: over this band an undamped positive shaper within "
                f"{asked.tolerance:g} takes about {periods:.2g} periods, and the search "
                "for the fastest of that many impulses takes too long",
                searched=False,
            )
    try:
        impulses = _count_convolved(choice, question)
        if impulses > MAX_CONVOLVED_IMPULSES:
            return Refused(
                choice=choice,
                reason=f"is not designed: convolved for {len(question.nominal)} modes it has "
                f"{impulses} impulses, and to prove the residual of more than "
                f"{MAX_CONVOLVED_IMPULSES} over a band takes too long",
                searched=False,
            )
        if budget.spent:
            return Refused(
                choice=choice,
                reason="is not searched: shapers that take less were tried before it, and of "
                f"the recommendation {budget.in_words}",
                searched=False,
            )
        own = budget.part(MAX_WORK_PER_SHAPER)
        try:
            first = design_choice(choice, question, own)
            over = first.largest / asked.tolerance
            if "tolerance" in choice.options and WITHIN < over <= NEARLY:
                return _tighten(first, question, own) or first
        finally:
            budget.spend(own.done)
    except DesignError as error:
        return Refused(choice=choice, reason=str(error))
    return first


def _tighten(first: Designed, question: Question, budget: Budget) -> Designed | None:
    """Return the shaper for a tolerance so small that it keeps the one asked; None if none does.

    The first step takes the excess off the tolerance, further ones are by false position.
    """
    asked = question.requirements.tolerance
    sampled = question.requirements.sample_time_s is not None
    misses, keeps = first, None
    for _ in range(TIGHTENED_ON_SAMPLES if sampled else TIGHTENED):
        if keeps is None:
            excess = misses.largest - AIM * asked
            smaller = max(_own(misses) - excess, _own(misses) / 4)
        else:
            share = (AIM * asked - keeps.largest) / (misses.largest - keeps.largest)
            smaller = _own(keeps) + share * (_own(misses) - _own(keeps))
        if budget.spent:
            break
        try:
            again = design_choice(with_tolerance(first.choice, smaller), question, budget)
        except DesignError:
            break
        if again.largest <= WITHIN * asked:
            keeps = replace(again, lower_bound_s=first.lower_bound_s)
            slower = keeps.found.impulses.duration_s > SLOWER * first.found.impulses.duration_s
            if keeps.largest >= ENOUGH * asked or not slower:
                break
        elif misses.largest - again.largest < FOLLOWS * (_own(misses) - smaller):
            break
        else:
            misses = again
    return keeps


def _own(one: Designed) -> float:
    """Return the tolerance that a shaper was designed for."""
    return float(one.choice.options["tolerance"])


def with_tolerance(choice: Choice, tolerance: float) -> Choice:
    """Return the choice for another tolerance.

    Its lower bound is none of the question.

    Parameters
    ----------
    choice
        Kind and parameters, a tolerance among them.
    tolerance
        The other one [-].

    Returns
    -------
    Choice
        With ``bound_holds`` False.
    """
    return replace(
        choice,
        options={**choice.options, "tolerance": tolerance},
        asked={**choice.asked, "tolerance": tolerance},
        bound_holds=False,
    )


def effort(choice: Choice, question: Question) -> float:
    """Return about how much work the search for a shaper takes [-].

    Closed forms take least, then equations by the number of their unknowns, then what needs
    programs; of convolved ones, those of the fewest impulses.

    Parameters
    ----------
    choice
        Kind and parameters.
    question
        What is asked.

    Returns
    -------
    float
        In no unit: for ordering alone; 0 for what is refused at once.
    """
    modes, actuator = question.designed_for, question.actuator
    kind = choice.kind
    try:
        found = kind.formulate(kind.case(modes, actuator, kind.options(**choice.options)))
    except DesignError:
        return 0.0  # what is refused at once
    if isinstance(found, ClosedForm):
        return 0.0
    if isinstance(found, GapProblem):
        return float(found.bounds[0].size)
    if isinstance(found, Convolution):
        return float(impulses_of(found.parts))
    return PROGRAMS_EFFORT


PROGRAMS_EFFORT = 20.0
"""Effort of what needs programs: more than that of any equations here [-]."""


def _count_convolved(choice: Choice, question: Question) -> int:
    """Return how many impulses a convolved shaper has, 0 for another."""
    kind = choice.kind
    if "base" not in choice.options:
        return 0
    options = kind.options(**choice.options)
    found = kind.formulate(kind.case(question.designed_for, question.actuator, options))
    return impulses_of(found.parts) if isinstance(found, Convolution) else 0


def _periods(half_width: float, tolerance: float) -> float:
    """Return about how many periods an undamped positive shaper over a band takes [-].

    That of an equal-ripple window (C. L. Dolph, Proc. IRE 34 (1946)) whose main lobe ends where the
    band begins: from half widths of 0.3 on at most a third more than `si` takes, which by damping
    or negative impulses takes less.
    """
    return math.acosh(1 / tolerance) / (math.pi * (1 - half_width))


def design_choice(choice: Choice, question: Question, budget: Budget) -> Designed:
    """Design one shaper and measure its residual.

    Parameters
    ----------
    choice
        Kind and parameters.
    question
        What is asked.
    budget
        Work that is left; the design spends from it.

    Returns
    -------
    Designed
        The shaper, on samples where a sample time is asked.

    Raises
    ------
    DesignError
        As the design, or its way to the samples, does.
    """
    modes = question.designed_for
    plant: Plant = modes[0] if len(modes) == 1 else Modes(modes=modes)
    asked, actuator = question.requirements, question.actuator
    options = choice.kind.options(**choice.options)
    budget.spend(DESIGN_WORK)
    found = design(plant, actuator, choice.kind, options, budget)
    if asked.sample_time_s is not None:
        between_levels = may_be_between_levels(choice.kind, modes)
        if not has_free_amplitudes(found.impulses, between_levels=between_levels):
            budget.spend(_work_of_samples(found, actuator, asked.sample_time_s))
        found, _ = sampled_design(
            found,
            modes,
            actuator,
            asked.sample_time_s,
            tolerance=SAMPLE_TOLERANCE,
            between_levels=between_levels,
            budget=budget,
        )
    budget.spend(work_of_worst(found, question))
    worst = worst_residual(found.impulses, question)
    return Designed(
        choice=choice,
        found=found,
        worst_residual=worst,
        drive_off_residual=drive_off_residual(found.impulses, question, worst),
        lower_bound_s=found.solver.lower_bound_s if choice.bound_holds else None,
    )


def _work_of_samples(found: Design, actuator: Actuator, sample_time_s: float) -> float:
    """Return the work of bringing unity magnitude to samples [units]."""
    cut = cuts_ramps(found.impulses, actuator, sample_time_s)
    if cut:
        return CUT_SAMPLED_WORK
    over_band = claim_over_band(found.certificate) is not None
    return BAND_SAMPLED_WORK if over_band else UNITY_SAMPLED_WORK
