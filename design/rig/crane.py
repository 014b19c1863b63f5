"""What the machine is made of: the crane, its strokes, and a double pendulum's load."""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from design.checks import require_between, require_scale
from design.errors import InvalidInputError
from design.model.plants.mode import MAX_DAMPING_RATIO
from design.model.plants.pendulum import STANDARD_GRAVITY_M_S2
from design.rig.plant import (
    DAMPING,
    GRAVITY,
    LEAST_HEIGHT,
    LINEAR,
    LOWER_LENGTH,
    MASS_RATIO,
    MAX_HOIST,
    PLANT_SIZE,
    lowest_frequency,
)
from design.types import FloatArray

AxisName = Literal["x", "y"]

AXES: tuple[AxisName, AxisName] = ("x", "y")
"""The axes in the order of columns."""

CraneModel = Literal["nonlinear", "linear"]
"""Newton's law for swings of any size; or what is of first order in small ones."""

HOOK_MASS_KG = 0.385
"""Mass of the hook of the mini-crane (Kim 2011, table 2-1) [kg]."""

MAX_SPEED_M_S = 1.5
"""Largest speed of the mini-crane (Kim 2011, table 2-1) [m/s]."""

MAX_SWING_RAD = math.pi / 3
"""Largest angle of a cable from the vertical: beyond it a crane is out of control [rad]."""

STROKES_M = 1.3, 0.755, 1.4
"""Largest travel of the mini-crane in x, y and z (Kim 2011, table 2-1) [m]."""

MIN_CABLE_M, MAX_CABLE_M = 1e-3, 1e3
"""Bounds of a cable's length [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Load:
    """A load that swings under the hook."""

    mass_kg: float  # > 0 [kg]
    length_m: float  # From the hook to the centre of the load, 0.001 to 1000 [m]

    def __post_init__(self) -> None:
        if not 0 < self.mass_kg < math.inf:
            raise InvalidInputError(
                "mass_kg",
                self.mass_kg,
                "finite and > 0; a hook without a load is a crane without load",
                code="load_without_mass",
            )
        require_scale("mass_kg", self.mass_kg)
        require_between("length_m", self.length_m, MIN_CABLE_M, MAX_CABLE_M)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stroke:
    """How far an axis can go, and where its limit switches are."""

    length_m: float  # From end to end, > 0 [m]
    start_m: float  # Where the axis stands at first, 0 to the length [m]
    # How far before either end the limit switches are, >= 0; None if there are none [m]
    switch_m: float | None = None

    def __post_init__(self) -> None:
        require_scale("length_m", self.length_m)
        margin = self.switch_m or 0.0
        require_between("switch_m", margin, 0.0, self.length_m / 2)
        require_between("start_m", self.start_m, margin, self.length_m - margin)


@dataclass(frozen=True, slots=True, kw_only=True)
class Crane:
    """A hook on a cable under a trolley that goes in x and y."""

    cable_length_m: float  # From the trolley to the hook at first, 0.001 to 1000 [m]
    damping_ratio: float = 0.0  # Of the slowest mode, at any length, 0 to 0.99 [-]
    gravity_m_s2: float = STANDARD_GRAVITY_M_S2  # Acceleration of free fall, > 0 [m/s^2]
    hook_mass_kg: float = HOOK_MASS_KG  # > 0 [kg]
    load: Load | None = None  # What swings under the hook; None if nothing does
    model: CraneModel = "nonlinear"
    # Strokes in x and y; None where nothing ends them
    strokes: tuple[Stroke | None, Stroke | None] = (None, None)
    max_speed_m_s: float = field(default=MAX_SPEED_M_S)  # Of each axis and the hoist, > 0 [m/s]
    # Most that the hoist can let down, from the trolley to the hook [m]
    max_cable_length_m: float = MAX_CABLE_M

    def __post_init__(self) -> None:
        require_between("max_cable_length_m", self.max_cable_length_m, MIN_CABLE_M, MAX_CABLE_M)
        require_between("cable_length_m", self.cable_length_m, MIN_CABLE_M, self.max_cable_length_m)
        require_between("damping_ratio", self.damping_ratio, 0.0, MAX_DAMPING_RATIO)
        for name in ("gravity_m_s2", "hook_mass_kg", "max_speed_m_s"):
            require_scale(name, getattr(self, name))

    @property
    def plant_row(self) -> FloatArray:
        """The crane as compiled code reads it, shape (PLANT_SIZE,)."""
        row = np.zeros(PLANT_SIZE)
        row[GRAVITY], row[DAMPING] = self.gravity_m_s2, self.damping_ratio
        row[LINEAR] = self.model == "linear"
        row[MAX_HOIST] = self.max_speed_m_s
        row[LEAST_HEIGHT] = math.cos(MAX_SWING_RAD)
        if self.load is not None:
            row[MASS_RATIO] = self.load.mass_kg / self.hook_mass_kg
            row[LOWER_LENGTH] = self.load.length_m
        return row

    def decays_s(self, cable_length_m: FloatArray) -> FloatArray:
        """Return the rate at which swings die away at lengths, shape (n,) [1/s]."""
        if self.damping_ratio == 0.0:
            return np.zeros(cable_length_m.size)
        lowest = [self.frequencies_rad_s(length)[0] for length in cable_length_m.tolist()]
        return self.damping_ratio * np.array(lowest)

    def frequencies_rad_s(self, cable_length_m: float) -> tuple[float, ...]:
        """Return the natural frequencies of small swings at a length of the cable.

        Parameters
        ----------
        cable_length_m
            From the trolley to the hook [m].

        Returns
        -------
        tuple of float
            One, or two with a load, ascending [rad/s].
        """
        if self.load is None:
            return (lowest_frequency(self.gravity_m_s2, 0.0, cable_length_m, 0.0),)
        mass_ratio, lower_m = self.load.mass_kg / self.hook_mass_kg, self.load.length_m
        slowest = lowest_frequency(self.gravity_m_s2, mass_ratio, cable_length_m, lower_m)
        # The product of both squares is (1 + u) g^2 / (l k).
        product = math.sqrt((1 + mass_ratio) / (cable_length_m * lower_m)) * self.gravity_m_s2
        return slowest, product / slowest

    @property
    def slowest_rad_s(self) -> float:
        """Lowest natural frequency of small swings at the first length [rad/s]."""
        return self.frequencies_rad_s(self.cable_length_m)[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitSwitch:
    """An axis has come to a limit switch, and its drive was commanded to stop.

    Attributes
    ----------
    axis
        Which.
    at_s, position_m
        When and where [s], [m].
    """

    axis: AxisName
    at_s: float
    position_m: float


CableName = Literal["upper", "lower"]
"""From the trolley to the hook, or from the hook to the load."""

CABLES: tuple[CableName, CableName] = ("upper", "lower")
"""The cables in the order of rows."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SlackCable:
    """A cable that the motion would need to push.

    Attributes
    ----------
    cable
        Which.
    at_s, duration_s
        When it first would, and for how long in all [s].
    push_n
        Largest force that it would push with, > 0 [N].
    """

    cable: CableName
    at_s: float
    duration_s: float
    push_n: float


def require_cable(cable_length_m: float, most_m: float) -> None:
    """Check that a cable can be hoisted to a length.

    Parameters
    ----------
    cable_length_m
        The length [m].
    most_m
        Most that the hoist can let down [m].

    Raises
    ------
    InvalidInputError
        If the cable would be hoisted through zero, or be too long.
    """
    if not cable_length_m >= MIN_CABLE_M:
        raise InvalidInputError(
            "cable_length_m",
            cable_length_m,
            f"at least {MIN_CABLE_M:g}: a cable is not hoisted through zero",
            code="cable_through_zero",
        )
    require_between("cable_length_m", cable_length_m, MIN_CABLE_M, most_m)
