"""The residual where the drive is not as given: all its parameters off at once."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from design.analysis.residual import residual_vibration
from design.analysis.workable import require_workable
from design.checks import require_between
from design.errors import InvalidInputError
from design.fields import vary
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray

MAX_OFF = 0.5
"""Largest share that the parameters of a drive may be off: beyond it, it is another drive [-]."""

MAX_DRIVE_POINTS = 101
"""Points of the curve, at most: each has the residual of sixteen drives."""

Path = tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveRange:
    """By how much the drive may be off."""

    most: float = 0.2  # Largest share, > 0, at most 0.5 [-]
    points: int = 3  # Shares from 0 to that, evenly spaced, 2 to 101

    def __post_init__(self) -> None:
        require_between("drive.to", self.most, 0.0, MAX_OFF)
        require_between("drive.points", self.points, 2, MAX_DRIVE_POINTS)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DriveSensitivity:
    """The residual over the share by which a drive is off.

    Attributes
    ----------
    shares
        Shares by which every parameter is off, up or down, shape (k,) [-].
    residuals
        Largest residual of any mode and any such drive, shape (k,) [-].
    worst
        Parameters of the worst drive at the largest share, over those given, by their dotted
        paths from the actuator [-].
    """

    shares: FloatArray
    residuals: FloatArray
    worst: dict[str, float]


def parameters_of(actuator: Actuator) -> dict[Path, float]:
    """Return the parameters of a drive by their paths; none of an ideal one.

    They are those of its two sets. Limits and dead times are no part of them.
    """
    if isinstance(actuator, RateLimited):
        return {("then", *path): value for path, value in parameters_of(actuator.then).items()}
    if isinstance(actuator, FirstOrder):
        names = ("accel_time_constant_s", "decel_time_constant_s")
        return {(name,): getattr(actuator, name) for name in names}
    if isinstance(actuator, SecondOrder):
        return {
            (name, field): getattr(getattr(actuator, name), field)
            for name in ("accel", "decel")
            for field in ("natural_frequency_rad_s", "damping_ratio")
        }
    return {}


def drive_sensitivity(
    impulses: Impulses, modes: tuple[Mode, ...], actuator: Actuator, wanted: DriveRange
) -> DriveSensitivity:
    """Return the residual where every parameter of the drive is off.

    At each share all combinations of larger and smaller parameters are tried. Each residual is over
    the unshaped step of the drive that is off.

    Parameters
    ----------
    impulses, modes, actuator
        The command, the modes of the plant, and the drive as given.
    wanted
        By how much the drive is off.

    Returns
    -------
    DriveSensitivity
        The largest residual at each share, and the worst drive.

    Raises
    ------
    InvalidInputError
        If the drive has no parameters, or one breaks its rule where it is off.
    """
    given = parameters_of(actuator)
    if not given:
        raise InvalidInputError(
            "drive",
            actuator.kind,
            "left out for an actuator without parameters",
            code="drive_without_parameters",
        )
    shares = np.linspace(0.0, wanted.most, wanted.points)
    residuals: list[float] = []
    worst: tuple[float, ...] = ()
    for share in shares.tolist():
        each = [
            (_largest(impulses, modes, _off(actuator, given, factors)), factors)
            for factors in product((1 - share, 1 + share), repeat=len(given))
        ]
        most, worst = max(each, key=lambda one: one[0])
        residuals.append(most)
    names = (".".join(path) for path in given)
    return DriveSensitivity(
        shares=shares,
        residuals=np.array(residuals),
        worst=dict(zip(names, worst, strict=True)),
    )


def _off(actuator: Actuator, given: dict[Path, float], factors: tuple[float, ...]) -> Actuator:
    drive = actuator
    for (path, value), factor in zip(given.items(), factors, strict=True):
        try:
            drive = vary(drive, list(path), factor * value)
        except InvalidInputError as error:
            raise InvalidInputError(
                "drive.to",
                round(abs(factor - 1), 9),
                f"such that the drive stays within bounds; {'.'.join(path)} must be {error.rule}",
                code="drive_off_bounds",
            ) from None
    return drive


def _largest(impulses: Impulses, modes: tuple[Mode, ...], drive: Actuator) -> float:
    for mode in modes:
        require_workable(mode, drive)
    return max(residual_vibration(impulses, mode, drive) for mode in modes)
