"""What a shaper says of itself: its entry in the registry."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from design.claims import Quantity
from design.formulations.formulation import Formulation
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.shapers.compiled_rows import CompiledRows
from design.shapers.damping import EVERY_PLANT, DampingBound, require_modes_damped
from design.shapers.options import ShaperOptions
from design.shapers.refusals import refuse_several

Options = TypeVar("Options", bound=ShaperOptions)


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignCase(Generic[Options]):
    """What a shaper is formulated for."""

    modes: tuple[Mode, ...]  # Those of the plant, in which nothing is to be left
    actuator: Actuator  # What drives it
    options: Options  # Parameters of the kind
    # Whether the negative of a stop is asked, the sets of the actuator being swapped for it
    is_stop: bool = False
    plant: Plant | None = None  # That of the modes, for kinds that need more of it than them

    @property
    def mode(self) -> Mode:
        """The only mode, of kinds that serve one."""
        return self.modes[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class KindOf(Generic[Options]):
    """One kind of shaper, which worker processes are sent: no function of it is made in another."""

    name: str  # Its ``kind`` on the wire
    summary: str  # One sentence for the catalogue
    source: str  # Where it was published
    claims: tuple[Quantity, ...]  # What its impulses keep at zero, or as the formulation says
    options: type[Options]  # Record of its parameters; field metadata hold description and bounds
    actuators: tuple[str, ...]  # Names of the actuator kinds that it serves
    formulation: Callable[[DesignCase[Options]], Formulation]
    most_modes: int = 1  # Modes of a plant that it serves, at most
    # Up to which damping ratio of the plant it is: `formulate` refuses what is beyond
    damping: DampingBound = EVERY_PLANT
    # How tables solve it without the pipeline; None of kinds whose rows are designs
    compiled_rows: CompiledRows | None = None
    has_branches: bool = False  # Whether its undamped closed form has branches, that maps can show
    large_swings: bool = False  # Whether it is for swings that are not small, of a pendulum alone

    @property
    def serves_several(self) -> bool:
        """Whether it serves plants of several modes."""
        return self.most_modes > 1

    def case(
        self, modes: tuple[Mode, ...], actuator: Actuator, options: Options | None = None
    ) -> DesignCase[Options]:
        """Return a case of this kind.

        Parameters
        ----------
        modes, actuator, options
            The modes of the plant, its drive, and parameters; the usual ones if not given.

        Returns
        -------
        DesignCase
            What `formulate` takes.
        """
        return DesignCase(
            modes=modes, actuator=actuator, options=self.options() if options is None else options
        )

    def formulate(self, case: DesignCase[Options]) -> Formulation:
        """Return the closed form, or the problem, of a case.

        Returns
        -------
        Formulation
            A closed form or a problem.

        Raises
        ------
        InvalidInputError
            If the plant has more modes, or more damping, than the kind serves, or an option does
            not go with the rest.
        InfeasibleDesignError
            If there is no such shaper.
        """
        if len(case.modes) > self.most_modes:
            refuse_several(self.name, len(case.modes))
        if self.damping is not EVERY_PLANT:
            require_modes_damped(self.name, self.damping, case.modes)
        return self.formulation(case)


ShaperKind = KindOf[Any]
"""A kind of shaper, whatever its parameters are."""
