"""A request for the firmware of a printer, whose plant is then that of a printer."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from schemas.base import Wire
from schemas.plants import DoublePendulumIn, ModesIn, PendulumIn, PlantIn, ScheduledIn, SpringMassIn

FirmwareName = Literal["klipper", "marlin", "rrf"]

FREQUENCY = "natural_frequency_rad_s"


@dataclass(frozen=True, slots=True)
class PrintedPlant:
    """The plant of a printer."""

    plant: PlantIn

    def numbers(self, _: str) -> Iterator[tuple[str, str, float]]:
        """Yield the frequency of each mode, at the number that makes it."""
        if isinstance(self.plant, ScheduledIn):
            ends = self.plant.to_design()
            for name, end in (("from", ends.first), ("to", ends.last)):
                yield f"/plant/{name}", FREQUENCY, end.mode.natural_frequency_rad_s
            return
        modes = self.plant.to_design().modes
        if isinstance(self.plant, ModesIn):
            where = [f"modes/{number}/{FREQUENCY}" for number, _ in enumerate(modes)]
        elif isinstance(self.plant, DoublePendulumIn):
            where = ["cable_length_m", "load_length_m"]
        elif isinstance(self.plant, PendulumIn):
            where = ["cable_length_m"]
        else:
            where = ["stiffness_n_m" if isinstance(self.plant, SpringMassIn) else FREQUENCY]
        for pointer, mode in zip(where, modes, strict=True):
            yield f"/plant/{pointer}", FREQUENCY, mode.natural_frequency_rad_s


class MaybePrinted(Wire):
    """A request that may be for the firmware of a printer."""

    @property
    def printed(self) -> PrintedPlant | None:
        """The plant of a printer; None where no firmware is asked for."""
        if getattr(self, "firmware", None) is None:
            return None
        plant: PlantIn = getattr(self, "plant")  # noqa: B009 - a field of the request
        return PrintedPlant(plant)
