"""Wire form of what is known of a shaper for large swings."""

from typing import Annotated

from pydantic import Field

from design.model.plants.large_swing import SwingFigures
from schemas.base import Wire, leave_out_none


class LargeSwingOut(Wire):
    """Of which swing the residual, the claims and the sensitivity are."""

    speed_m_s: Annotated[
        float,
        Field(
            description="Full speed at which all figures of this answer hold, of the nonlinear "
            "crane [m/s]."
        ),
    ]
    largest_angle_rad: Annotated[
        float, Field(description="Largest angle of the cable from the vertical on the way [rad].")
    ]


OfLargeSwing = Annotated[
    LargeSwingOut | None,
    leave_out_none("Of a shaper for large swings: at which speed; otherwise left out."),
]


def large_swing_of(figures: SwingFigures) -> LargeSwingOut:
    """Wrap the design record."""
    return LargeSwingOut.model_construct(
        speed_m_s=figures.swing.speed_m_s, largest_angle_rad=figures.largest_rad
    )
