"""Every shaper that may serve: kinds of the registry, with parameters that suit the question.

Kinds are known by the names of their parameters alone, so that a new one is asked without a line
here.
"""

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, get_args

from design.analysis.band import largest_in_band
from design.errors import DesignError
from design.pipeline import Design, design
from design.plants import Modes, Plant
from design.recommendations.requirements import Question
from design.sampled import SAMPLE_TOLERANCE, sampled_design
from design.shapers.kind import ShaperKind
from design.shapers.several_modes import BASES

TIGHTENED = 4
"""How often a shaper that misses the tolerance by little is designed anew for a smaller one."""

NEARLY = 1.5
"""What a shaper may leave over the tolerance for that to be tried [-]."""

AIM = 1 - 1e-3
"""Where it is aimed at, over the tolerance: what is left of the way to it is little [-]."""

LONGEST_PERIODS = {"positive": 6.0, "negative": 3.5}
"""Shapers over a band that are searched, in periods as of `_periods`, by their amplitudes: longer
ones cost seconds to tens of seconds each, as measured for bands to 0.9 and tolerances to 0.001."""

WITHIN = 1 + 1e-9
"""Margin of a tolerance, as of the certificate: an EI shaper lies on its own but for rounding."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A kind of shaper with its parameters.

    Attributes
    ----------
    kind, options
        Entry of the registry, and its parameters by name, those left out that are not touched.
    asked
        Those of them that differ from the kind's own.
    bound_holds
        Whether a lower bound of its duration is one of the question too: it is designed for the
        band and the tolerance asked, and no stricter.
    """

    kind: ShaperKind
    options: dict[str, Any]
    asked: dict[str, Any]
    bound_holds: bool = False

    @property
    def name(self) -> str:
        """The kind, with what tells it from others of the same kind."""
        told = [f"{name} {self.options[name]}" for name in TELLING if name in self.options]
        return f"{self.kind.name} ({', '.join(told)})" if told else self.kind.name


TELLING = ("base", "amplitudes", "max_velocity_ratio")
"""Parameters of which several values are tried."""


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
        The most that it leaves anywhere in the ranges asked, by simulation [-].
    lower_bound_s
        No shaper of its class that keeps the tolerance over the band is as short: proven; None
        where nothing is [s].
    """

    choice: Choice
    found: Design
    worst_residual: float
    lower_bound_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Refused:
    """A kind of shaper of which there is none here."""

    choice: Choice
    reason: str


def serves(kind: ShaperKind, question: Question) -> bool:
    """Whether a kind is for as many modes as the plant has.

    Those for several serve one too, but are there what they are made of: `zv`, `umzv`, their bases.
    """
    return (len(question.nominal) > 1) == (kind.formulate_jointly is not None)


def choices(kind: ShaperKind, question: Question) -> Iterator[Choice]:
    """Yield the ways in which one kind may serve, its own parameters first."""
    names = {option.name: option for option in dataclasses.fields(kind.options)}
    asked = question.requirements
    common: dict[str, Any] = {}
    if "tolerance" in names and "base" not in names:
        common["tolerance"] = asked.tolerance
    if "half_width" in names:
        # A band narrower than the kind's narrowest is served by that.
        narrowest = names["half_width"].metadata.get("ge", 0.0)
        common["half_width"] = max(question.half_width, narrowest)
    exact = common.get("half_width") == question.half_width and "tolerance" in common
    commands = {"lowest_command": asked.lowest_command, "highest_command": asked.highest_command}
    variants: list[dict[str, Any]] = [{}]
    if "amplitudes" in names:
        variants = [{}, {"amplitudes": "negative", **commands}]
    if "max_velocity_ratio" in names and asked.highest_command > 1:
        variants = [{}, {"max_velocity_ratio": asked.highest_command}]
    if "base" in names:
        variants = [_of_base(base, asked.tolerance) for base in get_args(names["base"].type)]
    for variant in variants:
        changed = {**common, **variant}
        told = {name: value for name, value in changed.items() if value != names[name].default}
        yield Choice(kind=kind, options=changed, asked=told, bound_holds=exact)


def _of_base(base: str, tolerance: float) -> dict[str, Any]:
    takes = {option.name for option in dataclasses.fields(BASES[base].options)}
    return {"base": base, "tolerance": tolerance} if "tolerance" in takes else {"base": base}


def designed(choice: Choice, question: Question) -> Designed | Refused:
    """Design one shaper and tell what it leaves, or why there is none.

    A kind with a tolerance that holds it where its theory does, but misses it by little elsewhere
    in the ranges or on samples, is designed anew for a smaller one.
    """
    kind, asked = choice.kind, question.requirements
    if question.actuator.kind not in kind.actuators:
        return Refused(
            choice=choice,
            reason=f"serves no actuator of kind {question.actuator.kind}, only "
            f"{', '.join(kind.actuators)}",
        )
    if "half_width" in choice.options:
        periods = _periods(choice.options["half_width"], asked.tolerance)
        if periods > LONGEST_PERIODS[choice.options.get("amplitudes", "positive")]:
            return Refused(
                choice=choice,
                reason=f"is not searched: over this band a shaper within {asked.tolerance:g} takes "
                f"about {periods:.2g} periods, and finding the fastest takes too long",
            )
    try:
        first = best = made(choice, question)
        for _ in range(TIGHTENED):
            over = best.worst_residual / asked.tolerance
            if "tolerance" not in choice.options or not WITHIN < over <= NEARLY:
                break
            smaller = best.choice.options["tolerance"] + (AIM - over) * asked.tolerance
            if smaller <= 0:
                break
            tighter = replace(
                best.choice,
                options={**choice.options, "tolerance": smaller},
                asked={**choice.asked, "tolerance": smaller},
                bound_holds=False,
            )
            again = made(tighter, question)
            if again.worst_residual >= best.worst_residual:
                break
            best = replace(again, lower_bound_s=first.lower_bound_s)
    except DesignError as error:
        return Refused(choice=choice, reason=str(error))
    return best if best.worst_residual <= WITHIN * asked.tolerance else first


def _periods(half_width: float, tolerance: float) -> float:
    """Return about how many periods a positive shaper over a band takes [-].

    That of an equal-ripple window (C. L. Dolph, Proc. IRE 34 (1946)) whose main lobe ends where the
    band begins: from half widths of 0.3 on at most a third more than `si` takes.
    """
    return math.acosh(1 / tolerance) / (math.pi * (1 - half_width))


def made(choice: Choice, question: Question) -> Designed:
    """Design one shaper and measure what it leaves; raises what the design does."""
    modes = question.designed_for
    plant: Plant = modes[0] if len(modes) == 1 else Modes(modes=modes)
    asked, actuator = question.requirements, question.actuator
    options = choice.kind.options(**choice.options)
    found = design(plant, actuator, choice.kind, options)
    if asked.sample_time_s is not None:
        found, _ = sampled_design(
            found,
            modes[0],
            actuator,
            asked.sample_time_s,
            found.certificate.zeros,
            tolerance=SAMPLE_TOLERANCE,
        )
    return Designed(
        choice=choice,
        found=found,
        worst_residual=_worst(found, question),
        lower_bound_s=found.solver.lower_bound_s if choice.bound_holds else None,
    )


def _worst(found: Design, question: Question) -> float:
    band, damping = question.own_band, question.requirements.damping
    return max(
        largest_in_band(found.impulses, mode, question.actuator, band, damping)
        for mode in question.designed_for
    )
