"""Wire form of impulses, in and out."""

from typing import Annotated, Self

import numpy as np
from pydantic import Field

from design.model.impulses import Impulses
from design.model.merging import merged
from schemas.base import Wire

MAX_IMPULSES = 1000


class ImpulsesWire(Wire):
    """Steps of a velocity command."""

    times_s: Annotated[
        list[float],
        Field(
            min_length=1,
            max_length=MAX_IMPULSES,
            description="Times, not decreasing; steps at one time are one [s].",
        ),
    ]
    amplitudes: Annotated[
        list[float],
        Field(min_length=1, max_length=MAX_IMPULSES, description="Shares of full speed [-]."),
    ]

    def to_design(self) -> Impulses:
        """Build the design record, its steps at one time as one."""
        given = Impulses(times_s=np.array(self.times_s), amplitudes=np.array(self.amplitudes))
        return merged(given)

    @classmethod
    def from_design(cls, impulses: Impulses) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            times_s=impulses.times_s.tolist(), amplitudes=impulses.amplitudes.tolist()
        )
