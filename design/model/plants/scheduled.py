"""A plant whose frequency is anywhere in a range."""

from dataclasses import dataclass

from design.errors import InvalidInputError
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.spring_mass import SpringMass

MAX_FREQUENCY_RANGE = 10.0
"""Highest over lowest frequency of a range: no shaper of a few impulses spans more [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scheduled:
    """A plant of one mode, of which a length, a mass or a stiffness is anywhere in a range."""

    # The plant at either end of the range, of equal damping ratio
    first: Mode | Pendulum | SpringMass
    last: Mode | Pendulum | SpringMass

    def __post_init__(self) -> None:
        ends = self.first.mode, self.last.mode
        if ends[0].damping_ratio != ends[1].damping_ratio:
            raise InvalidInputError(
                "over",
                "damping_ratio",
                "a field that changes the frequency; for damping there is sensitivity.damping",
                code="range_of_damping",
            )
        if not MAX_FREQUENCY_RANGE >= self.band[1] / self.band[0] > 1:
            raise InvalidInputError(
                "to",
                f"frequencies 1 to {self.band[1] / self.band[0]:.4g}",
                "such that the highest frequency is more than the lowest, and at most "
                f"{MAX_FREQUENCY_RANGE:g} times as high",
                code="range_too_wide",
            )

    @property
    def mode(self) -> Mode:
        """Raise InvalidInputError: a scheduled plant has no one frequency."""
        raise InvalidInputError(
            "plant.kind", "scheduled", "a plant of one frequency here", code="single_frequency_only"
        )

    @property
    def middle(self) -> Mode:
        """The mode in the middle of the range, for which shapers are designed.

        Its frequency is the mean of the lowest and the highest.
        """
        ends = [end.mode.natural_frequency_rad_s for end in (self.first, self.last)]
        return Mode(
            natural_frequency_rad_s=sum(ends) / 2, damping_ratio=self.first.mode.damping_ratio
        )

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Every mode to be shaped, here the middle one."""
        return (self.middle,)

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency over that of `middle` [-]."""
        ends = [end.mode.natural_frequency_rad_s for end in (self.first, self.last)]
        middle = sum(ends) / 2
        return min(ends) / middle, max(ends) / middle
