"""Wire form of a residual over the share by which a drive is off."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.drive_sensitivity import (
    MAX_DRIVE_POINTS,
    MAX_OFF,
    DriveRange,
    DriveSensitivity,
)
from schemas.base import Wire


class DriveIn(Wire):
    """By how much the parameters of the drive may be off."""

    to: Annotated[
        float,
        Field(
            gt=0, le=MAX_OFF, description="Largest share by which each parameter is off, 0.1 [-]."
        ),
    ] = 0.2
    points: Annotated[
        int, Field(ge=2, le=MAX_DRIVE_POINTS, description="Shares from 0 to that.")
    ] = 3

    def to_design(self) -> DriveRange:
        """Build the design record."""
        return DriveRange(most=self.to, points=self.points)


class DriveOut(Wire):
    """The residual over the share by which every parameter of the drive is off."""

    off_by: Annotated[
        list[float], Field(description="Shares by which each parameter is off, up or down [-].")
    ]
    residual: Annotated[
        list[float],
        Field(description="Largest residual of any mode and any such drive, at each share [-]."),
    ]
    worst_drive: Annotated[
        dict[str, float],
        Field(
            description="Parameters of the worst drive at the largest share, over those given, "
            "such as accel.damping_ratio [-]."
        ),
    ]

    @classmethod
    def from_design(cls, found: DriveSensitivity) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            off_by=found.shares.tolist(), residual=found.residuals.tolist(), worst_drive=found.worst
        )
