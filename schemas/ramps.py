"""Wire form of what limits to acceleration make of a command."""

from typing import Annotated, Literal, Self

from pydantic import Field

from design.analysis.binding_limits import BindingLimit, Limit
from design.analysis.ramp_figures import RampFigures, Textbook
from schemas.base import OutOf, Wire, leave_out_none


class BindingLimitOut(OutOf[BindingLimit]):
    """An interval in which one limit binds."""

    from_s: Annotated[float, Field(description="Begin, after the first step [s].")]
    to_s: Annotated[float, Field(description="End [s].")]
    limit: Annotated[
        Limit,
        Field(
            description="acceleration while the magnitude of the velocity grows at its limit, "
            "deceleration while it falls; jerk while the acceleration changes at its limit; speed "
            "while the velocity is full, rest while it is 0."
        ),
    ]


class TextbookOut(OutOf[Textbook]):
    """A shaper of an ideal drive behind the same limits."""

    shaper: Annotated[str, Field(description="Its kind.")]
    command: Annotated[
        Literal["shaped_ramp", "steps"],
        Field(
            description="shaped_ramp: the ramp to full speed, or the unshaped move, convolved with "
            "the shaper; steps: its steps, each begun when the ramp before it is over."
        ),
    ]
    ramp_end_s: Annotated[
        float, Field(description="When its last ramp ends, after the first step [s].")
    ]
    residual: Annotated[
        float, Field(description="Its residual, a share of the step without limits [-].")
    ]
    earlier: Annotated[
        float,
        Field(description="Share of that time by which the command here ends earlier [-]."),
    ]


class LimitsOut(Wire):
    """What limits to acceleration make of the command."""

    binding: Annotated[
        list[BindingLimitOut],
        Field(
            description="Which limit binds when, up to the end of the last ramp; none while a "
            "command holds the velocity between rest and full speed."
        ),
    ]
    textbooks: Annotated[
        list[TextbookOut],
        Field(
            description="Shapers of an ideal drive to compare with, which claim the same; empty "
            "where there is none."
        ),
    ]

    @classmethod
    def from_design(cls, figures: RampFigures) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            binding=[BindingLimitOut.from_design(one) for one in figures.binding],
            textbooks=[TextbookOut.from_design(one) for one in figures.textbooks],
        )


OfLimits = Annotated[
    LimitsOut | None,
    leave_out_none("Behind limits, what binds when, and what is compared; otherwise left out."),
]

UnshapedRampResidual = Annotated[
    float | None,
    leave_out_none(
        "Behind limits, the residual of the ramp of an unshaped step, a share of the step "
        "without limits; otherwise left out [-]."
    ),
]
