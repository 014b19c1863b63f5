"""What a shaper says of itself: its entry in the registry."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, get_args

from design.claims import Quantity
from design.errors import InvalidInputError
from design.formulations.formulation import Formulation
from design.model.actuators.rate_limited import Unlimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode
from design.shapers.options import ShaperOptions

Options = TypeVar("Options", bound=ShaperOptions)

UNLIMITED_ACTUATORS = tuple(one.kind for one in get_args(Unlimited))
"""Kinds of actuators without limits to the rate of the command."""

EVERY_ACTUATOR = tuple(one.kind for one in get_args(Actuator))
"""Kinds of actuators, the one that asks most of a shaper last: the catalogue's example has it."""

EVERY_ACTUATOR_BY_ITS_LAG = tuple(
    sorted(EVERY_ACTUATOR, key=lambda name: name not in {"ideal", "rate_limited"})
)
"""The same for shapers that only use the acceleration set, of which a lag asks most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignCase(Generic[Options]):
    """What a shaper is formulated for.

    Attributes
    ----------
    modes
        Those of the plant, in which nothing is to be left.
    actuator
        What drives it.
    options
        Parameters of the kind.
    is_stop
        Whether the negative of a stop is asked, the sets of the actuator being swapped for it.
    """

    modes: tuple[Mode, ...]
    actuator: Actuator
    options: Options
    is_stop: bool = False

    @property
    def mode(self) -> Mode:
        """The only mode, of kinds that serve one."""
        return self.modes[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingBound:
    """Up to which damping ratio of the plant a kind of shaper exists as numbers.

    Attributes
    ----------
    most
        Largest damping ratio [-].
    beyond
        What its impulses are beyond it, in words.
    """

    most: float
    beyond: str


@dataclass(frozen=True, slots=True, kw_only=True)
class CompiledRows:
    """How the compiled kernel of tables solves a kind whose equations are as many as its unknowns.

    Attributes
    ----------
    for_ideal
        Whether the shaper knows no actuator: its rows are solved for an ideal one.
    closed_form_undamped
        Whether it is a closed form for an undamped plant behind superposed steps.
    """

    for_ideal: bool = False
    closed_form_undamped: bool = False


EVERY_PLANT = DampingBound(most=MAX_DAMPING_RATIO, beyond="there is no such plant")


@dataclass(frozen=True, slots=True, kw_only=True)
class KindOf(Generic[Options]):
    """One kind of shaper, which worker processes are sent: no function of it is made in another.

    Attributes
    ----------
    name
        Its ``kind`` on the wire.
    summary
        One sentence for the catalogue.
    source
        Where it was published.
    claims
        What its impulses keep small, by name: zero unless the formulation says more.
    options
        Record of its parameters; field metadata hold description and bounds.
    actuators
        Names of the actuator kinds that it serves.
    formulation
        From a case to a closed form or a problem.
    most_modes
        Modes of a plant that it serves, at most.
    damping
        Up to which damping ratio of the plant it is: `formulate` refuses what is beyond.
    compiled_rows
        How tables solve it without the pipeline; None of kinds whose rows are designs.
    has_branches
        Whether its undamped closed form has branches, that maps can show.
    """

    name: str
    summary: str
    source: str
    claims: tuple[Quantity, ...]
    options: type[Options]
    actuators: tuple[str, ...]
    formulation: Callable[[DesignCase[Options]], Formulation]
    most_modes: int = 1
    damping: DampingBound = EVERY_PLANT
    compiled_rows: CompiledRows | None = None
    has_branches: bool = False

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
        modes
            The modes of the plant.
        actuator
            What it is designed for.
        options
            Parameters of the kind; the usual ones if not given.

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
            raise InvalidInputError(
                "plant.modes",
                f"{len(case.modes)} modes",
                f"a list of one: {self.name} serves a single mode; multi_zv, multi_umzv and "
                "convolved serve several",
                code="kind_of_one_mode",
            )
        if self.damping is not EVERY_PLANT:
            self.require_damping(case.modes)
        return self.formulation(case)

    def require_damping(self, modes: tuple[Mode, ...]) -> None:
        """Raise InvalidInputError for the first mode that is damped too much."""
        for number, mode in enumerate(modes):
            field_name = "plant" if len(modes) == 1 else f"plant.modes.{number}"
            require_damping(self.name, self.damping, mode, field_name)


ShaperKind = KindOf[Any]
"""A kind of shaper, whatever its parameters are."""


def require_damping(
    name: str, damping: DampingBound, mode: Mode, field_name: str = "plant"
) -> None:
    """Check that a mode is damped no more than a kind of shaper serves.

    Parameters
    ----------
    name
        Name of the kind.
    damping
        Its bound.
    mode
        The mode.
    field_name
        Dotted path of the mode, for the error.

    Raises
    ------
    InvalidInputError
        If the damping ratio is above the bound.
    """
    if mode.damping_ratio > damping.most:
        raise InvalidInputError(
            f"{field_name}.damping_ratio",
            mode.damping_ratio,
            f"at most {damping.most:g} for {name}: beyond it {damping.beyond}",
            code="too_damped_for_kind",
        )
