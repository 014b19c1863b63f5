"""What a shaper says of itself: its entry in the registry."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from design.claims import Quantity
from design.errors import InvalidInputError
from design.formulations.formulation import Formulation
from design.model.actuators.registry import Actuator
from design.model.plants.mode import LARGEST_DAMPING_RATIO, Mode
from design.types import require_between

SHORTEST_HORIZON_PERIODS = 0.1
LONGEST_HORIZON_PERIODS = 100.0
"""Bounds of how long a shaper is searched, in undamped periods [-]."""

SMALLEST_PEAK = 0.01
LARGEST_PEAK = 100.0
"""Bounds of the peak command over the cruise speed: beyond them one of the two is nothing [-]."""


SMALLEST_TOLERANCE, LARGEST_TOLERANCE = 1e-3, 0.5
"""Bounds of a tolerance: below, zeros do as well; above, hardly any shaper is needed [-]."""

USUAL_TOLERANCE = 0.05
"""Tolerance of the literature [-]."""


def tolerance_field(description: str) -> float:
    """Return the field of a tolerance between `SMALLEST_TOLERANCE` and `LARGEST_TOLERANCE`."""
    return field(
        default=USUAL_TOLERANCE,
        metadata={
            "description": description,
            "ge": SMALLEST_TOLERANCE,
            "le": LARGEST_TOLERANCE,
        },
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SettleOptions:
    """Parameters of the shapers whose steps may have to settle.

    Attributes
    ----------
    settle
        Whether the actuator must reach 80 % of each step before the next.
    max_duration_periods
        Longest shaper searched, in undamped periods of the plant [-].
    """

    settle: bool = field(
        default=False,
        metadata={
            "description": "Let the actuator reach 80 % of each step before the next switch."
        },
    )
    max_duration_periods: float = field(
        default=3.0,
        metadata={
            "description": "Longest shaper searched, in undamped periods of the plant.",
            "ge": SHORTEST_HORIZON_PERIODS,
            "le": LONGEST_HORIZON_PERIODS,
        },
    )

    def __post_init__(self) -> None:
        require_between(
            "max_duration_periods",
            self.max_duration_periods,
            SHORTEST_HORIZON_PERIODS,
            LONGEST_HORIZON_PERIODS,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class PeakOptions(SettleOptions):
    """Parameters of the shapers whose first pulse may be higher than the cruise speed.

    Attributes
    ----------
    max_velocity_ratio
        Height of that pulse over the cruise speed [-].
    """

    max_velocity_ratio: float = field(
        default=1.0,
        metadata={
            "description": "Peak of the command, over its cruise speed.",
            "ge": SMALLEST_PEAK,
            "le": LARGEST_PEAK,
        },
    )

    def __post_init__(self) -> None:
        SettleOptions.__post_init__(self)
        require_between("max_velocity_ratio", self.max_velocity_ratio, SMALLEST_PEAK, LARGEST_PEAK)


@dataclass(frozen=True, slots=True, kw_only=True)
class NoOptions:
    """A shaper without parameters."""


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


EVERY_PLANT = DampingBound(most=LARGEST_DAMPING_RATIO, beyond="there is no such plant")


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaperKind:
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
    formulate
        From mode, actuator and options to a closed form or a problem.
    formulate_stop
        The same for the negative of a stop, given the actuator with its sets in each other's place;
        None where that is a start.
    formulate_jointly
        The same for several modes; None for shapers of one mode.
    damping
        Up to which damping ratio of the plant it is: each of the three refuses what is beyond.
    """

    name: str
    summary: str
    source: str
    claims: tuple[Quantity, ...]
    options: type[Any]
    actuators: tuple[str, ...]
    formulate: Callable[[Mode, Actuator, Any], Formulation]
    formulate_stop: Callable[[Mode, Actuator, Any], Formulation] | None = None
    formulate_jointly: Callable[[tuple[Mode, ...], Actuator, Any], Formulation] | None = None
    damping: DampingBound = EVERY_PLANT

    def __post_init__(self) -> None:
        """Put the bound of damping ahead of everything that formulates."""
        if self.damping is EVERY_PLANT:
            return
        for name in ("formulate", "formulate_stop"):
            own = getattr(self, name)
            if own is not None:
                bounded = partial(_bounded, self.name, self.damping, own)
                object.__setattr__(self, name, bounded)

    def require_damping(self, modes: tuple[Mode, ...]) -> None:
        """Raise InvalidInputError for the first of several modes that is damped too much."""
        for number, mode in enumerate(modes):
            field_name = "plant" if len(modes) == 1 else f"plant.modes.{number}"
            require_damping(self.name, self.damping, mode, field_name)


def require_damping(
    name: str, damping: DampingBound, mode: Mode, field_name: str = "plant"
) -> None:
    """Raise InvalidInputError where a mode is damped more than a kind of shaper serves."""
    if mode.damping_ratio > damping.most:
        raise InvalidInputError(
            f"{field_name}.damping_ratio",
            mode.damping_ratio,
            f"at most {damping.most:g} for {name}: beyond it {damping.beyond}",
        )


def _bounded(
    name: str,
    damping: DampingBound,
    formulate: Callable[[Mode, Actuator, Any], Formulation],
    mode: Mode,
    actuator: Actuator,
    options: Any,  # noqa: ANN401
) -> Formulation:
    require_damping(name, damping, mode)
    return formulate(mode, actuator, options)


def for_one_of(
    formulate_jointly: Callable[[tuple[Mode, ...], Actuator, Any], Formulation],
) -> Callable[[Mode, Actuator, Any], Formulation]:
    """Return how a shaper of several modes is formulated for a plant that has one."""
    return partial(_for_one, formulate_jointly)


def _for_one(
    formulate_jointly: Callable[[tuple[Mode, ...], Actuator, Any], Formulation],
    mode: Mode,
    actuator: Actuator,
    options: Any,  # noqa: ANN401
) -> Formulation:
    return formulate_jointly((mode,), actuator, options)
