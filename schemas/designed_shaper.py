"""Wire form of a shaper in the answer with its design."""

from typing import Annotated

from pydantic import Field

from schemas.base import Wire, leave_out_none
from schemas.impulses import ImpulsesWire


class ShaperOut(Wire):
    """The shaper."""

    kind: Annotated[str, Field(description="Kind of shaper, as in the request.")]
    impulses: Annotated[ImpulsesWire, Field(description="Steps of the command for a unit step.")]
    duration_s: Annotated[float, Field(description="Time that it adds to a move [s].")]
    ramp_end_s: Annotated[
        float | None,
        leave_out_none(
            "Behind limits, when the last ramp ends, after the first step; otherwise left out [s]."
        ),
    ]
