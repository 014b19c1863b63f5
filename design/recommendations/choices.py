"""Which shapers may serve: kinds of the registry, with parameters that suit the question.

Kinds are known by the names of their parameters alone, so that a new one is asked without a line
here.
"""

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, get_args

from design.recommendations.requirements import Question
from design.shapers.kind import ShaperKind
from design.shapers.several_modes import BASES


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
        """The kind, with what distinguishes it from others of that kind."""
        told = [
            name if self.options[name] is True else f"{name} {self.options[name]}"
            for name in TELLING
            if name in self.options
        ]
        return f"{self.kind.name} ({', '.join(told)})" if told else self.kind.name


TELLING = ("base", "amplitudes", "max_velocity_ratio", "slope")
"""Parameters of which several values are tried."""


MAX_MODES_WITH_SLOPE = 3
"""Modes up to which slopes are tried: with more, few designs are found, in seconds each."""


def serves(kind: ShaperKind, question: Question) -> bool:
    """Return whether a kind is for as many modes as the plant has.

    Kinds for several modes serve one too; for a plant of one mode the kinds that they are made of
    (`zv`, `umzv`, their bases) stand in their place. Of a firmware, its kinds alone serve.

    Parameters
    ----------
    kind
        Kind of the shaper.
    question
        What is asked.

    Returns
    -------
    bool
        Whether the kind is designed for the question.
    """
    if kind.large_swings:  # whose speed is no requirement
        return False
    firmware = question.requirements.firmware
    if firmware is not None and kind.name not in firmware.kinds:
        return False
    return (len(question.nominal) > 1) == kind.serves_several


def choices(kind: ShaperKind, question: Question) -> Iterator[Choice]:
    """Yield the ways in which one kind may serve, its own parameters first.

    Parameters
    ----------
    kind
        Kind of the shaper.
    question
        What is asked.

    Yields
    ------
    Choice
        With the tolerance and band of the question, within the bounds of the kind.
    """
    names = {option.name: option for option in dataclasses.fields(kind.options)}
    asked = question.requirements
    common: dict[str, Any] = {}
    if "tolerance" in names and "base" not in names:
        common["tolerance"] = _tolerance(names["tolerance"].metadata, asked.tolerance)
    if "half_width" in names:
        # A band narrower than the kind's narrowest is served by that.
        narrowest = names["half_width"].metadata.get("ge", 0.0)
        common["half_width"] = max(question.half_width, narrowest)
    if asked.firmware is not None:
        common |= asked.firmware.fixed.get(kind.name, {})
    exact = (
        common.get("half_width") == question.half_width
        and common.get("tolerance") == asked.tolerance
    )
    commands = {"lowest_command": asked.lowest_command, "highest_command": asked.highest_command}
    variants: list[dict[str, Any]] = [{}]
    if "amplitudes" in names:
        variants = [{}, {"amplitudes": "negative", **commands}]
    if "max_velocity_ratio" in names and asked.highest_command > 1:
        variants = [{}, {"max_velocity_ratio": asked.highest_command}]
    if "slope" in names and len(question.nominal) <= MAX_MODES_WITH_SLOPE:
        variants = [{}, {"slope": True}]
    if "base" in names:
        variants = [_of_base(base, asked.tolerance) for base in get_args(names["base"].type)]
    for variant in variants:
        changed = {**common, **variant}
        told = {name: value for name, value in changed.items() if value != names[name].default}
        if question.scheduled:
            told.pop("half_width", None)  # a design for such a plant takes it from the plant
        yield Choice(kind=kind, options=changed, asked=told, bound_holds=exact)


def _of_base(base: str, tolerance: float) -> dict[str, Any]:
    takes = {option.name: option.metadata for option in dataclasses.fields(BASES[base].options)}
    if "tolerance" not in takes:
        return {"base": base}
    return {"base": base, "tolerance": _tolerance(takes["tolerance"], tolerance)}


def _tolerance(bounds: Mapping[str, Any], asked: float) -> float:
    """Return the tolerance asked, or the largest of a kind that has none as large."""
    return min(asked, float(bounds.get("le", asked)))
