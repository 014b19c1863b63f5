"""The machine of live shaping: its drive, its modes, and what plans must leave."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from design.checks import MAX_VALUE, require_between, require_scale
from design.errors import InvalidInputError
from design.live.kernel import FIRST, MODE_SIZE, OF_SET, POLE, SECOND, SET_SIZE, SWITCHED
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.registry import Actuator
from design.model.plants.double_pendulum import DoublePendulum
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.model.plants.spring_mass import SpringMass
from design.types import FloatArray

Steady = Mode | Pendulum | SpringMass | Modes | DoublePendulum
"""Plants whose modes stay as they are."""

LIVE_KINDS = ("numzv", "numzvd", "num_multi", "umzv")
"""Kinds of shapers whose claims a plan can keep."""

MIN_LIMIT, MAX_LIMIT = 0.05, 10.0
"""Limits to the deflection: below, a start takes more than three periods and its steps are coarse,
above, nothing is limited [-]."""

MAX_ITERATIONS = 12
"""Of Newton's method from one start: it converges in four to nine steps."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveKind:
    """What a plan must leave, by the name of the shaper that claims it.

    Attributes
    ----------
    name
        Of `LIVE_KINDS`: ``umzv`` is planned as if the drive were ideal.
    slope
        Whether the slope of each mode's vibration is zero too; ``numzvd`` has it.
    """

    name: str = "numzv"
    slope: bool = False

    def __post_init__(self) -> None:
        if self.name not in LIVE_KINDS:
            raise InvalidInputError(
                "kind",
                self.name,
                "one of " + ", ".join(LIVE_KINDS) + " in live mode: their commands are full speed "
                "or rest, and are solved anew at each event",
                code="kind_not_live",
            )
        if self.name == "numzvd":
            object.__setattr__(self, "slope", True)

    @property
    def ideal(self) -> bool:
        """Whether plans are made as if the drive were ideal."""
        return self.name == "umzv"


@dataclass(frozen=True, kw_only=True)
class LiveMachine:
    """Drive and plant of both axes, which are alike.

    Attributes
    ----------
    plant
        What swings under either axis, its cable as it is at first.
    actuator
        The drive, without limits to acceleration.
    kind
        What plans leave at first.
    largest_swing
        Largest amplitude of a mode that the model stands for, over that of an unshaped step;
        any if None [-].
    sample_time_s
        Events come at most once in it; any if None [s].
    deflection_limit
        Largest deflection on the way, over that of an unshaped step; any if None [-].
    max_iterations
        Of Newton's method from one start.
    """

    plant: Steady
    actuator: Unlimited
    kind: LiveKind = LiveKind()
    largest_swing: float | None = None
    sample_time_s: float | None = None
    deflection_limit: float | None = None
    max_iterations: int = MAX_ITERATIONS

    def __post_init__(self) -> None:
        live_drive(self.actuator)
        live_plant(self.plant)
        if self.largest_swing is not None:
            require_scale("largest_swing", self.largest_swing)
        if self.sample_time_s is not None:
            require_between("sample_time_s", self.sample_time_s, 0.0, MAX_VALUE)
        if self.deflection_limit is not None:
            require_between("deflection_limit", self.deflection_limit, MIN_LIMIT, MAX_LIMIT)
        self.require_kind(self.kind)

    def require_kind(self, kind: LiveKind) -> None:
        """Check that plans of a kind can keep the limit to the deflection.

        Raises
        ------
        InvalidInputError
            If it asks for more than no residual, or ignores the drive.
        """
        if self.deflection_limit is not None:
            require_kind_with_limit(kind)

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Modes of the plant as it is at first."""
        return self.plant.modes

    @cached_property
    def drive_row(self) -> FloatArray:
        """The drive, as the kernel knows it."""
        return drive_row(self.actuator)


def require_kind_with_limit(kind: LiveKind) -> None:
    """Check that plans of a kind can keep a limit to the deflection.

    Raises
    ------
    InvalidInputError
        If it asks for more than no residual, or ignores the drive.
    """
    if kind.slope or kind.ideal:
        raise InvalidInputError(
            "kind",
            kind.name,
            "numzv, or num_multi without slope, with deflection_limit: a command that keeps "
            "the limit makes the residual zero behind this drive, and nothing more",
            code="kind_not_with_deflection_limit",
        )


def live_drive(actuator: Actuator) -> Unlimited:
    """Return a drive that is served live.

    Returns
    -------
    Unlimited
        As given.

    Raises
    ------
    InvalidInputError
        If it has limits to acceleration.
    """
    if isinstance(actuator, RateLimited):
        raise InvalidInputError(
            "actuator.kind",
            actuator.kind,
            "ideal, first_order or second_order in live mode: behind limits to acceleration the "
            "state has no closed form to solve from. A delay line serves it",
            code="drive_not_live",
        )
    return actuator


def live_plant(plant: Plant) -> Steady:
    """Return a plant that is served live.

    Returns
    -------
    Steady
        As given.

    Raises
    ------
    InvalidInputError
        If its modes are not known once and for all.
    """
    if not isinstance(plant, Steady):
        raise InvalidInputError(
            "plant.kind",
            type(plant).__name__.lower(),
            "a mode, modes, a pendulum, a double pendulum or masses on a spring in live mode",
            code="plant_not_live",
        )
    return plant


def drive_row(actuator: Unlimited) -> FloatArray:
    """Return a drive as `design.live.kernel` knows it, shape (DRIVE_SIZE,)."""
    lags = actuator.accel_lag, actuator.decel_lag
    row = np.array([*(lag.first_s for lag in lags), *(lag.second_s2 for lag in lags), 0.0])
    row[SWITCHED] = float(actuator.model == "switched")
    return row


def mode_rows(modes: tuple[Mode, ...], drive: FloatArray) -> FloatArray:
    """Return modes as `design.live.kernel` knows them behind a drive.

    Parameters
    ----------
    modes
        The modes, n of them.
    drive
        As of `drive_row`.

    Returns
    -------
    FloatArray
        Shape (n, MODE_SIZE).
    """
    rows = np.zeros((len(modes), MODE_SIZE))
    for row, mode in zip(rows, modes, strict=True):
        pole = mode.pole_rad_s
        row[POLE], row[POLE + 1] = pole.real, pole.imag
        for force in (0, 1):
            first, second = float(drive[FIRST + force]), float(drive[SECOND + force])
            gain = 1 / (1 + pole * (first + pole * second))
            slope = -(gain**2) * pole * (first + 2 * pole * second)
            parts = (-gain, gain * second * pole, -slope, (slope + gain) * second * pole)
            begin = OF_SET + SET_SIZE * force
            row[begin : begin + SET_SIZE] = np.array(parts).view(np.float64)
    return rows


IDEAL_ROW = drive_row(Ideal())
"""An ideal drive, as the kernel knows it."""
