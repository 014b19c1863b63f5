"""What is mapped: a quantity, of which shaper or move, in which plant and actuator."""

from dataclasses import dataclass
from typing import Any, Literal

from design.checks import require_scale
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.types import FloatArray

Quantity = Literal[
    "residual", "deflection_m", "times_s", "duration_s", "branch", "alpha", "beta_rad"
]
"""What a map shows; `Map.values` says what each is."""

OF_DESIGNS = ("times_s", "duration_s", "branch")
"""Quantities of the shaper itself, which is designed in every cell."""

OF_ACTUATORS = ("alpha", "beta_rad")
"""Quantities of plant and actuator, without a shaper."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """A start and a stop.

    Attributes
    ----------
    pulse_s
        From the first step of the start to the first step of the stop, > 0 [s].
    stop
        ``solved`` for the actuator whose sets are swapped; ``mirrored``, the gaps of the
        start in reverse order (Kim 2011, 3.56-3.59).
    """

    pulse_s: float
    stop: Literal["solved", "mirrored"] = "solved"

    def __post_init__(self) -> None:
        require_scale("pulse_s", self.pulse_s)


@dataclass(frozen=True, slots=True, kw_only=True)
class Recipe:
    """A shaper that is yet to be designed.

    Attributes
    ----------
    kind, options
        Entry of the registry, and its parameters.
    each
        Whether it is designed anew in every cell; else once, for plant and actuator as given.
    designed_for
        Model of the actuator that it is designed for; None for the actuator's own, by which it is
        always judged.
    """

    kind: ShaperKind
    options: ShaperOptions | None
    each: bool
    designed_for: Model | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class MapCase:
    """What is mapped.

    Attributes
    ----------
    plant, actuator
        What the fields are varied in.
    shaper
        A command that is held, a shaper to design, or None where the quantity needs none.
    move
        The move that the shaper starts and stops; None for the shaper alone.
    quantity
        The quantity of the map.
    speed_m_s
        Full speed, for a deflection [m/s].
    """

    plant: Plant
    actuator: Actuator
    shaper: Impulses | Recipe | None = None
    move: Move | None = None
    quantity: Quantity = "residual"
    speed_m_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Map:
    """A map.

    Attributes
    ----------
    quantity
        The quantity of the map.
    values
        Shape (len(y), len(x), k), one row without y; not a number where a cell has no such shaper
        or move. k is 1, except for ``times_s``, the times of all impulses, and ``branch``, n, m and
        the sign of `closed_form_branch`.
        ``residual``: share of an unshaped step [-]. ``deflection_m``: the same at the payload [m].
        ``duration_s``: first to last impulse [s]. ``alpha``, ``beta_rad``: magnitude and lag of
        G_decel/G_accel at the plant's pole [-], [rad].
    """

    quantity: Quantity
    values: FloatArray


Cell = dict[str, Any]
"""Plant, actuator and, in a move, ``move``, with the values of one cell."""
