"""Steps up and down that leave nothing of a large swing, as data."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from design.claims import Promise, zeros
from design.model.actuators.registry import Actuator
from design.model.plants.large_swing import LargeSwing

if TYPE_CHECKING:
    from design.formulations.formulation import Formulation


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LargeSwingProblem:
    """Times at which a load that swings far is left at rest.

    Attributes
    ----------
    swing
        The load at its full speed.
    linear
        The same steps for small swings: where the search begins.
    slope
        Whether nothing changes with the length of the cable either, to first order.
    designed_for
        The drive, without limits to the acceleration.
    """

    swing: LargeSwing
    linear: "Formulation"
    slope: bool
    designed_for: Actuator

    @property
    def claims(self) -> tuple[Promise, ...]:
        """No residual of the large swing, and no slope where it counts."""
        return zeros(("residual", "slope") if self.slope else ("residual",))
