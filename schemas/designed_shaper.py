"""Wire form of a shaper in the answer with its design."""

from typing import Annotated

from pydantic import Field

from schemas.base import Wire, leave_out_none
from schemas.impulses import ImpulsesWire


class ShaperOut(Wire):
    """The shaper."""

    kind: str
    impulses: ImpulsesWire
    duration_s: Annotated[float, Field(description="Time that it adds to a move [s].")]
    ramp_end_s: Annotated[
        float | None,
        leave_out_none(
            "Behind limits, when the last ramp ends, after the first step; otherwise left out [s]."
        ),
    ]
