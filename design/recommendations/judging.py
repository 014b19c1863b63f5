"""What a shaper does for a question, requirement by requirement, with the reason in words."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.analysis.high_modes import HIGH_MODES, high_mode_gain
from design.analysis.insensitivity import Insensitivity, insensitivity
from design.analysis.ramp_figures import moving_time_s
from design.analysis.residual import residual_vibration
from design.analysis.smoothing import Smoothing, smoothing
from design.analysis.worst_mode import common_interval
from design.errors import InvalidInputError
from design.model.impulses import Impulses
from design.model.plants.modes import Modes
from design.model.plants.registry import Plant
from design.recommendations.candidates import WITHIN, Designed
from design.recommendations.firmware import PLAYED_WITHIN, Firmware, Played
from design.recommendations.requirements import Question
from design.recommendations.worst import worst_residual

MAX_SHOWN_AMPLITUDES = 4
"""Amplitudes that a reason repeats."""

ROUNDING = 1e-9
"""What amplitudes, sums and times may be off by, over one or over themselves [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """One requirement, and whether a shaper meets it.

    Attributes
    ----------
    requirement
        Its field's name.
    met
        Whether it is met.
    value, limit
        What is compared, in the field's unit; None of a sign.
    reason
        The same in words.
    """

    requirement: str
    met: bool
    value: float | None
    limit: float | None
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """A shaper, judged.

    Attributes
    ----------
    designed
        The shaper.
    residual
        Its largest residual in the nominal modes with the actuator given [-].
    insensitivity
        Ratios of the nominal frequencies around 1 at which it keeps the tolerance, at the damping
        that it is designed for; None where it does not at 1.
    high_mode_gain
        Its largest residual from 1.5 to 10 times the highest mode, at the least damping [-].
    lowest_command, highest_command
        Levels of a shaped unit step, over its cruise speed [-].
    smoothing
        By how much it delays and rounds a path.
    end_s
        From its first step to the last, or to the end of the last ramp behind limits: what it is
        ranked by [s].
    verdicts
        One for each requirement.
    same_as
        Name of the candidate ahead of it whose impulses are the same; None where there is none.
    played
        What the firmware makes of it; None where none is asked for, or it cannot play the shaper.
    """

    designed: Designed
    residual: float
    insensitivity: Insensitivity | None
    high_mode_gain: float
    lowest_command: float
    highest_command: float
    smoothing: Smoothing
    end_s: float
    verdicts: tuple[Verdict, ...]
    same_as: str | None = None
    played: Played | None = None

    @property
    def name(self) -> str:
        """Its kind, with what distinguishes it from others of that kind."""
        return self.designed.choice.name

    @property
    def impulses(self) -> Impulses:
        """The shaper."""
        return self.designed.found.impulses

    @property
    def duration_s(self) -> float:
        """From its first step to the last [s]."""
        return self.impulses.duration_s

    @property
    def peak_command(self) -> float:
        """Largest size of the command, over its cruise speed [-]."""
        return max(-self.lowest_command, self.highest_command)

    @property
    def missed(self) -> tuple[str, ...]:
        """Requirements that it does not meet."""
        return tuple(verdict.requirement for verdict in self.unmet)

    @property
    def unmet(self) -> tuple[Verdict, ...]:
        """Verdicts on those that it does not meet.

        What misses the tolerance with the drive as given is not said once more of one that is off.
        """
        unmet = [verdict for verdict in self.verdicts if not verdict.met]
        beyond = any(verdict.requirement == "tolerance" for verdict in unmet)
        return tuple(
            verdict for verdict in unmet if not (beyond and verdict.requirement == "drive_off_by")
        )

    @property
    def width(self) -> float:
        """Width of the insensitivity; 0 without any, inf without an end [-]."""
        if self.insensitivity is None:
            return 0.0
        width = self.insensitivity.width
        return math.inf if width is None else width


def judge_choice(designed: Designed, question: Question) -> Candidate:
    """Measure a shaper and hold it against every requirement.

    Parameters
    ----------
    designed
        The shaper and its warnings.
    question
        What is asked.

    Returns
    -------
    Candidate
        With a verdict for each requirement.
    """
    impulses, actuator = designed.found.impulses, question.actuator
    tolerance = question.requirements.tolerance
    intervals = [insensitivity(impulses, mode, actuator, tolerance) for mode in question.nominal]
    highest = max(question.nominal, key=lambda mode: mode.natural_frequency_rad_s)
    if question.requirements.damping is not None:
        highest = replace(highest, damping_ratio=question.requirements.damping[0])
    levels = np.concatenate(([0.0], np.cumsum(impulses.amplitudes)))
    candidate = Candidate(
        designed=designed,
        residual=max(residual_vibration(impulses, mode, actuator) for mode in question.nominal),
        insensitivity=common_interval(intervals),
        high_mode_gain=high_mode_gain(impulses, highest, actuator),
        lowest_command=float(levels.min()),
        highest_command=float(levels.max()),
        smoothing=smoothing(impulses),
        end_s=moving_time_s(impulses, actuator),
        verdicts=(),
    )
    verdicts = [*_verdicts(candidate, question)]
    played = None
    if question.requirements.firmware is not None:
        played, verdict = play(designed, question, question.requirements.firmware)
        verdicts.append(verdict)
    return replace(candidate, verdicts=tuple(verdicts), played=played)


def play(
    designed: Designed, question: Question, firmware: Firmware
) -> tuple[Played | None, Verdict]:
    """Hold what a firmware makes of a shaper against the tolerance.

    Parameters
    ----------
    designed, question, firmware
        The shaper, what is asked, and what is to play it.

    Returns
    -------
    Played or None
        With lines that say what is left where it is asked; None where it cannot.
    Verdict
        With the residual as it is played.
    """
    modes, choice, asked = question.designed_for, designed.choice, question.requirements
    plant: Plant = modes[0] if len(modes) == 1 else Modes(modes=modes)
    options = choice.kind.options(**choice.options)
    try:
        played = firmware.play(
            plant, question.actuator, choice.kind, options, designed.found.impulses
        )
    except InvalidInputError as error:
        told = f"is refused by {firmware.title}: {error}"
        return None, Verdict(
            requirement="firmware", met=False, value=None, limit=asked.tolerance, reason=told
        )
    worst = worst_residual(played.impulses, question)
    met = worst <= PLAYED_WITHIN * asked.tolerance
    lines = [
        f"{firmware.comment} asked: {percent(asked.tolerance)} {ranges(question)}; as "
        f"{firmware.title} plays it {100 * worst:.4g} %",
        *played.lines,
    ]
    if played.for_older is not None:
        older = max(worst_residual(one, question) for one in played.for_older.played)
        lines += [
            f"{firmware.comment} in a {firmware.title} that refuses the line: {100 * older:.4g} % "
            "there by",
            f"{firmware.comment} {played.for_older.line}",
        ]
    return replace(played, lines=tuple(lines)), Verdict(
        requirement="firmware",
        met=met,
        value=worst,
        limit=asked.tolerance,
        reason=f"has a residual {_at_most(worst, met=met)} there as {firmware.title} plays it, "
        f"{'within' if met else 'above'} {percent(asked.tolerance)}"
        f"{' except for its own digits' if worst > WITHIN * asked.tolerance and met else ''}",
    )


def _verdicts(candidate: Candidate, question: Question) -> Iterator[Verdict]:
    asked = question.requirements
    worst = candidate.designed.worst_residual
    met = worst <= WITHIN * asked.tolerance
    yield Verdict(
        requirement="tolerance",
        met=met,
        value=worst,
        limit=asked.tolerance,
        reason=f"has a residual {_at_most(worst, met=met)} {ranges(question)}, "
        f"{'within' if met else 'above'} {percent(asked.tolerance)}",
    )
    off = candidate.designed.drive_off_residual
    if off is not None and asked.drive_off_by is not None:
        met = off <= WITHIN * asked.tolerance
        yield Verdict(
            requirement="drive_off_by",
            met=met,
            value=off,
            limit=asked.tolerance,
            reason=f"has a residual {_at_most(off, met=met)} there with every parameter of the "
            f"drive off by {percent(asked.drive_off_by)}, "
            f"{'within' if met else 'above'} {percent(asked.tolerance)}",
        )
    if asked.max_duration_s is not None:
        met = candidate.end_s <= asked.max_duration_s * (1 + ROUNDING)
        yield Verdict(
            requirement="max_duration_s",
            met=met,
            value=candidate.end_s,
            limit=asked.max_duration_s,
            reason=f"takes {candidate.end_s:.4g} s, "
            f"{'within' if met else 'longer than'} {asked.max_duration_s:.4g} s",
        )
    if asked.sign != "any":
        met = _of_sign(candidate.impulses, asked.sign)
        yield Verdict(
            requirement="sign",
            met=met,
            value=None,
            limit=None,
            reason=_sign_in_words(candidate.impulses, asked.sign, met=met),
        )
    yield _command_verdict(candidate, question)
    if asked.max_high_mode_gain is not None:
        gain, limit = candidate.high_mode_gain, asked.max_high_mode_gain
        met = gain <= limit * (1 + ROUNDING)
        yield Verdict(
            requirement="max_high_mode_gain",
            met=met,
            value=gain,
            limit=limit,
            reason=f"has a residual of {'at most' if met else 'up to'} {gain:.3g} of an unshaped "
            f"step in modes from {HIGH_MODES[0]:g} to {HIGH_MODES[1]:g} times the "
            f"frequency, {'within' if met else 'above'} {limit:.3g}",
        )


def _at_most(worst: float, *, met: bool) -> str:
    if worst == math.inf:
        return "without bound, as the decelerating set resonates there,"
    return f"of {'at most' if met else 'up to'} {percent(worst)}"


def _command_verdict(candidate: Candidate, question: Question) -> Verdict:
    asked = question.requirements
    low, high = candidate.lowest_command, candidate.highest_command
    between = f"between {asked.lowest_command:.4g} and {asked.highest_command:.4g} of full speed"
    if low < asked.lowest_command - ROUNDING:
        return Verdict(
            requirement="lowest_command",
            met=False,
            value=low,
            limit=asked.lowest_command,
            reason=f"takes the command down to {low:.4g}, not {between}",
        )
    met = high <= asked.highest_command + ROUNDING
    return Verdict(
        requirement="highest_command",
        met=met,
        value=high,
        limit=asked.highest_command,
        reason=f"keeps the command {between}"
        if met
        else f"takes the command up to {high:.4g}, not {between}",
    )


def _of_sign(impulses: Impulses, sign: str) -> bool:
    amplitudes = impulses.amplitudes
    if sign == "positive":
        return bool((amplitudes > 0).all())
    unity = np.where(np.arange(amplitudes.size) % 2 == 0, 1.0, -1.0)
    return bool((np.abs(amplitudes - unity) <= ROUNDING).all())


def _sign_in_words(impulses: Impulses, sign: str, *, met: bool) -> str:
    if sign == "positive":
        if met:
            return "all its impulses are positive"
        return f"has negative impulses, down to {float(impulses.amplitudes.min()):.4g}"
    if met:
        return "its impulses are +1 and -1 in turn"
    told = [f"{amplitude:.3g}" for amplitude in impulses.amplitudes.tolist()]
    shown = ", ".join([
        *told[:MAX_SHOWN_AMPLITUDES],
        *(["..."] if len(told) > MAX_SHOWN_AMPLITUDES else []),
    ])
    return f"its impulses are {shown}, not +1 and -1 in turn"


def ranges(question: Question) -> str:
    """Return where the tolerance is asked, in words."""
    low, high = question.band
    hertz = question.nominal[0].natural_frequency_rad_s / (2 * math.pi)
    told = f"from {low:.4g} to {high:.4g} of the frequency" if high > low else "at the frequency"
    if len(question.nominal) > 1:
        told += " in every mode"
    elif high > low:
        told += f" ({hertz * low:.4g} to {hertz * high:.4g} Hz)"
    else:
        told += f" ({hertz:.4g} Hz)"
    if question.requirements.damping is not None:
        least, most = question.requirements.damping
        told += f" and damping ratios {least:g} to {most:g}"
    return told


def percent(share: float) -> str:
    """Return a share as a percentage with three digits."""
    return f"{100 * share:.3g} %"
