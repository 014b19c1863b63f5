"""Wire form of what a shaper does over a range of the plant."""

from typing import Annotated, Self

from pydantic import Field

from design.model.plants.scheduled import Scheduled
from schemas.base import Wire


class RangeOut(Wire):
    """What a shaper does over the range of a scheduled plant."""

    natural_frequency_rad_s: Annotated[
        float, Field(description="Middle of the range, for which the shaper is designed [rad/s].")
    ]
    lower_ratio: Annotated[float, Field(description="Lowest frequency over the middle one [-].")]
    upper_ratio: Annotated[float, Field(description="Highest frequency over the middle one [-].")]
    worst_residual: Annotated[
        float, Field(description="Largest residual in the range, with the actuator given [-].")
    ]

    @classmethod
    def from_design(cls, plant: Scheduled, worst_residual: float) -> Self:
        """Wrap the design record.

        Parameters
        ----------
        plant
            The plant of the request.
        worst_residual
            Largest residual of its shaper at any frequency of the range [-].

        Returns
        -------
        Self
            The range, with that.
        """
        low, high = plant.band
        return cls.model_construct(
            natural_frequency_rad_s=plant.middle.natural_frequency_rad_s,
            lower_ratio=low,
            upper_ratio=high,
            worst_residual=worst_residual,
        )
