"""Wire form of recommendations."""

from typing import Annotated, Any, Self

from pydantic import Field

from design.analysis.drive_sensitivity import MAX_OFF
from design.recommendations.candidates import Refused
from design.recommendations.choices import Choice
from design.recommendations.judging import Candidate
from design.recommendations.recommendation import Recommendation
from design.recommendations.requirements import (
    MAX_COMMAND,
    MAX_HALF_WIDTH,
    MAX_RATIO,
    MIN_RATIO,
    MIN_TOLERANCE,
    Requirements,
    Sign,
)
from schemas.actuators import ActuatorIn
from schemas.base import Positive, Version, Wire, leave_out_none
from schemas.damping import DampingRangeIn
from schemas.impulses import ImpulsesWire
from schemas.insensitivity import InsensitivityOut
from schemas.plants import BareMode, PlantIn
from schemas.printed import FirmwareName, MaybePrinted
from schemas.verdicts import VerdictOut, finite_or_none
from schemas.warnings import WarningOut, Warnings


class RecommendationRequest(MaybePrinted):
    """Body of `POST /v1/recommendations`; the design record checks bounds, and says why."""

    plant: PlantIn
    actuator: ActuatorIn
    half_width: Annotated[
        float | None,
        Field(
            description="The true frequency is within 1 - half_width and 1 + half_width of the "
            "plant's; 0.15 if neither it nor the ratios are given [-].",
            json_schema_extra={"minimum": 0, "maximum": MAX_HALF_WIDTH},
        ),
    ] = None
    lower_ratio: Annotated[
        float | None,
        Field(
            description="Least true frequency over the plant's, in place of half_width [-].",
            json_schema_extra={"minimum": MIN_RATIO, "maximum": 1},
        ),
    ] = None
    upper_ratio: Annotated[
        float | None,
        Field(
            description="Largest true frequency, with lower_ratio [-].",
            json_schema_extra={"minimum": 1, "maximum": MAX_RATIO},
        ),
    ] = None
    tolerance: Annotated[
        float,
        Field(
            description="Largest residual over all that the plant may be [-].",
            json_schema_extra={"minimum": MIN_TOLERANCE, "exclusiveMaximum": 1},
        ),
    ] = 0.05
    damping: Annotated[
        DampingRangeIn | None,
        Field(
            description="Range of the damping ratio, which contains that of the plant; null "
            "if that of the plant holds."
        ),
    ] = None
    max_duration_s: Annotated[
        Positive | None,
        Field(
            description="Longest duration of a shaper, behind limits until its last ramp ends [s]."
        ),
    ] = None
    sign: Annotated[
        Sign, Field(description="positive: all impulses above 0; unity: +1, -1, +1, ...")
    ] = "any"
    lowest_command: Annotated[
        float,
        Field(
            description="Lowest level of a shaped unit step, over its height [-].",
            json_schema_extra={"minimum": -MAX_COMMAND, "maximum": 0},
        ),
    ] = 0.0
    highest_command: Annotated[
        float,
        Field(
            description="Highest level of a shaped unit step, over its height [-].",
            json_schema_extra={"minimum": 1, "maximum": 1 + MAX_COMMAND},
        ),
    ] = 1.0
    max_high_mode_gain: Annotated[
        Positive | None,
        Field(
            description="Largest residual in any higher mode, a share of an unshaped step "
            "there [-]."
        ),
    ] = None
    sample_time_s: Annotated[
        Positive | None,
        Field(
            description="Sample time of a controller, on whose samples the impulses then lie [s]."
        ),
    ] = None
    drive_off_by: Annotated[
        float | None,
        Field(
            description="The tolerance holds as well where every parameter of the drive is off by "
            "this share, up or down, 0.1; null if those given are right [-].",
            json_schema_extra={"exclusiveMinimum": 0, "maximum": MAX_OFF},
        ),
    ] = None
    firmware: Annotated[
        FirmwareName | None,
        Field(
            description="Firmware of a printer that is to play the shaper: its kinds alone are "
            "candidates, and are judged as it plays them; null for any."
        ),
    ] = None

    def to_design(self) -> Requirements:
        """Build the design record."""
        firmware = None
        if self.firmware is not None:
            from design.export.printers import PRINTERS  # noqa: PLC0415 - most ask for none

            firmware = PRINTERS[self.firmware]
        return Requirements(
            half_width=self.half_width,
            lower_ratio=self.lower_ratio,
            upper_ratio=self.upper_ratio,
            tolerance=self.tolerance,
            damping=None if self.damping is None else (self.damping.from_, self.damping.to),
            max_duration_s=self.max_duration_s,
            sign=self.sign,
            lowest_command=self.lowest_command,
            highest_command=self.highest_command,
            max_high_mode_gain=self.max_high_mode_gain,
            sample_time_s=self.sample_time_s,
            drive_off_by=self.drive_off_by,
            firmware=firmware,
        )


class CandidateOut(Wire):
    """A shaper, judged."""

    name: Annotated[
        str, Field(description="Kind, with what distinguishes it from others of that kind.")
    ]
    shaper: Annotated[
        dict[str, Any],
        Field(description="Shaper as `POST /v1/designs` takes it, for the plant designed_for."),
    ]
    impulses: Annotated[ImpulsesWire, Field(description="Steps of the command for a unit step.")]
    duration_s: Annotated[float, Field(description="Time that it adds to a move [s].")]
    ramp_end_s: Annotated[
        float | None,
        leave_out_none(
            "Behind limits, when the last ramp ends, after the first step: what shapers are ranked "
            "by there; otherwise left out [s]."
        ),
    ]
    meets_all: Annotated[bool, Field(description="Whether it meets every requirement.")]
    requirements: Annotated[
        list[VerdictOut], Field(description="Verdict on each requirement, with its reason.")
    ]
    worst_residual: Annotated[
        float | None,
        Field(
            description="Largest residual over band and damping, with the actuator given, by "
            "simulation; null where the decelerating set resonates within both [-]."
        ),
    ]
    residual: Annotated[float, Field(description="Residual at the plant's natural frequency [-].")]
    insensitivity: Annotated[
        InsensitivityOut | None,
        Field(description="Interval of ratios at the tolerance; null where there is none."),
    ]
    high_mode_gain: Annotated[
        float,
        Field(
            description="Largest residual from 1.5 to 10 times the frequency, a share of the "
            "unshaped step there [-]."
        ),
    ]
    peak_command: Annotated[float, Field(description="Largest size of the command [-].")]
    lowest_command: Annotated[
        float, Field(description="Lowest level of the shaped unit step, over its height [-].")
    ]
    highest_command: Annotated[
        float, Field(description="Highest level of the shaped unit step, over its height [-].")
    ]
    delay_s: Annotated[float, Field(description="Mean time of its impulses [s].")]
    smoothing_s2: Annotated[
        float,
        Field(
            description="Half the variance of the impulses' times. Times an acceleration, it is "
            "the distance of a shaped path from the unshaped one delayed by delay_s "
            "[s^2]."
        ),
    ]
    lower_bound_s: Annotated[
        float | None,
        leave_out_none(
            "No shaper of its class that keeps the tolerance over the band is as short as this; "
            "left out where nothing is proven [s]."
        ),
    ]
    same_as: Annotated[
        str | None,
        leave_out_none("Name of an earlier candidate with the same impulses."),
    ]
    warnings: Warnings

    @classmethod
    def from_design(cls, candidate: Candidate, sample_time_s: float | None) -> Self:
        """Wrap the design record.

        Parameters
        ----------
        candidate
            The shaper, judged.
        sample_time_s
            Sample time that was asked for [s]; None for none.

        Returns
        -------
        Self
            With the request that designs this shaper.
        """
        made = candidate.designed
        return cls.model_construct(
            name=candidate.name,
            shaper=_shaper(made.choice, sample_time_s),
            impulses=ImpulsesWire.from_design(candidate.impulses),
            duration_s=candidate.duration_s,
            ramp_end_s=None if candidate.end_s == candidate.duration_s else candidate.end_s,
            meets_all=not candidate.missed,
            requirements=[VerdictOut.from_design(one) for one in candidate.verdicts],
            worst_residual=finite_or_none(made.worst_residual),
            residual=candidate.residual,
            insensitivity=None
            if candidate.insensitivity is None
            else InsensitivityOut.from_design(candidate.insensitivity),
            high_mode_gain=candidate.high_mode_gain,
            peak_command=candidate.peak_command,
            lowest_command=candidate.lowest_command,
            highest_command=candidate.highest_command,
            delay_s=candidate.smoothing.delay_s,
            smoothing_s2=candidate.smoothing.smoothing_s2,
            lower_bound_s=made.lower_bound_s,
            same_as=candidate.same_as,
            warnings=[WarningOut.from_design(one) for one in made.warnings],
        )


def _shaper(choice: Choice, sample_time_s: float | None) -> dict[str, Any]:
    told = {"kind": choice.kind.name, **choice.asked}
    return told if sample_time_s is None else {**told, "sample_time_s": sample_time_s}


class RefusedOut(Wire):
    """A kind of shaper of which there is none here."""

    name: Annotated[
        str, Field(description="Kind, with what distinguishes it from others of that kind.")
    ]
    shaper: Annotated[
        dict[str, Any],
        Field(description="Shaper that was refused, as `POST /v1/designs` takes it."),
    ]
    reason: Annotated[str, Field(description="Why there is none.")]

    @classmethod
    def from_design(cls, refused: Refused, sample_time_s: float | None) -> Self:
        """Wrap the design record.

        Parameters
        ----------
        refused
            Kind, parameters and reason.
        sample_time_s
            Sample time that was asked for [s]; None for none.

        Returns
        -------
        Self
            With the request that was refused.
        """
        return cls.model_construct(
            name=refused.choice.name,
            shaper=_shaper(refused.choice, sample_time_s),
            reason=refused.reason,
        )


class BandOut(Wire):
    """Band of the tolerance asked, as ratios of the plant's frequency."""

    lower_ratio: Annotated[float, Field(description="Least true frequency over the plant's [-].")]
    upper_ratio: Annotated[float, Field(description="Largest true frequency over the plant's [-].")]


class RecommendationResponse(Wire):
    """Answer of `POST /v1/recommendations`."""

    recommended: Annotated[
        CandidateOut, Field(description="The fastest shaper that meets all that is asked.")
    ]
    why: Annotated[list[str], Field(description="Reasons for that shaper, in sentences.")]
    runners_up: Annotated[
        list[CandidateOut], Field(description="All others that meet it, the fastest first.")
    ]
    others: Annotated[
        list[CandidateOut], Field(description="Shapers that do not meet it, the fastest first.")
    ]
    refused: Annotated[list[RefusedOut], Field(description="Kinds that could not be designed.")]
    band: Annotated[BandOut, Field(description="Band over which the tolerance is asked.")]
    designed_for: Annotated[
        list[BareMode],
        Field(description="The middle of what the plant may be: the plant of all these designs."),
    ]
    firmware_lines: Annotated[
        list[str] | None,
        leave_out_none(
            "Configuration of the shaper for the firmware that is asked for; otherwise left out."
        ),
    ]
    version: Version

    @classmethod
    def from_design(cls, found: Recommendation, version: str) -> Self:
        """Wrap the design record.

        Parameters
        ----------
        found
            All shapers, ranked.
        version
            Of the tool.

        Returns
        -------
        Self
            The recommended shaper, the others and the refused ones.
        """
        question = found.question
        sample_time_s = question.requirements.sample_time_s
        played = found.recommended.played
        best, *further = (CandidateOut.from_design(one, sample_time_s) for one in found.candidates)
        return cls.model_construct(
            recommended=best,
            why=list(found.why),
            runners_up=further,
            others=[CandidateOut.from_design(one, sample_time_s) for one in found.others],
            refused=[RefusedOut.from_design(one, sample_time_s) for one in found.refused],
            band=BandOut.model_construct(
                lower_ratio=question.band[0], upper_ratio=question.band[1]
            ),
            designed_for=[
                BareMode.model_construct(
                    natural_frequency_rad_s=mode.natural_frequency_rad_s,
                    damping_ratio=mode.damping_ratio,
                )
                for mode in question.designed_for
            ],
            firmware_lines=None if played is None else list(played.lines),
            version=version,
        )
