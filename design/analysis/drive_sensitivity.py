"""The residual where the drive is not as given: all its parameters off at once."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from design.analysis.residuals_of_many import residuals_of_cases
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


def require_parameters(actuator: Actuator, name: str = "drive") -> None:
    """Check that a drive has parameters that may be off.

    Parameters
    ----------
    actuator, name
        The drive, and the field that asks for it to be off.

    Raises
    ------
    InvalidInputError
        If it has none.
    """
    if not parameters_of(actuator):
        raise InvalidInputError(
            name,
            actuator.kind,
            "left out for an actuator without parameters",
            code="drive_without_parameters",
        )


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
        If the drive has no parameters.
    """
    require_parameters(actuator)
    shares = np.linspace(0.0, wanted.most, wanted.points)
    corners = corners_of(actuator)
    residuals: list[float] = []
    worst = corners[0]
    for share in shares.tolist():
        each = _residuals(impulses, modes, actuator, 1 + share * corners)
        worst = 1 + share * corners[int(each.argmax())]
        residuals.append(float(each.max()))
    names = (".".join(path) for path in parameters_of(actuator))
    return DriveSensitivity(
        shares=shares,
        residuals=np.array(residuals),
        worst=dict(zip(names, worst.tolist(), strict=True)),
    )


def drives_off(actuator: Actuator, share: float) -> tuple[Actuator, ...]:
    """Return the drives in all corners: each parameter larger or smaller.

    Parameters
    ----------
    actuator
        The drive as given, of k parameters.
    share
        By which each of them is off [-].

    Returns
    -------
    tuple of Actuator
        2^k drives; one without parameters is the drive as given.

    Raises
    ------
    InvalidInputError
        If a parameter that is off breaks its rule.
    """
    given = parameters_of(actuator)
    drives = []
    for factors in (1 + share * corners_of(actuator)).tolist():
        drive = actuator
        for (path, value), factor in zip(given.items(), factors, strict=True):
            try:
                drive = vary(drive, path, factor * value)
            except InvalidInputError as error:
                raise error.at(".".join(path), factor * value) from None
        drives.append(drive)
    return tuple(drives)


def corners_of(actuator: Actuator) -> FloatArray:
    """Return the corners: where each of k parameters is off, shape (2^k, k).

    An entry is -1 where the parameter is smaller than given, 1 where it is larger.
    """
    return np.array(list(product((-1.0, 1.0), repeat=len(parameters_of(actuator)))))


def _residuals(
    impulses: Impulses, modes: tuple[Mode, ...], actuator: Actuator, factors: FloatArray
) -> FloatArray:
    """Return the largest residual of any mode for each row of factors, shape (m,).

    The coefficients of the lags are scaled, so that a drive that is off has no bounds to keep.
    """
    lags = (actuator.accel_lag, actuator.decel_lag)
    by_set = factors.reshape(len(factors), 2, -1)
    first_s = np.array([lag.first_s for lag in lags]) * by_set[..., -1]
    second_s2 = np.zeros_like(first_s)
    if by_set.shape[2] > 1:  # ``first = 2 z / w``, ``second = 1 / w^2``
        first_s /= by_set[..., 0]
        second_s2 = np.array([lag.second_s2 for lag in lags]) / by_set[..., 0] ** 2
    limits = actuator if isinstance(actuator, RateLimited) else None
    each = [
        residuals_of_cases(
            impulses,
            np.full(len(factors), mode.pole_rad_s),
            first_s,
            second_s2,
            actuator.model,
            limits,
        )
        for mode in modes
    ]
    largest: FloatArray = np.max(each, axis=0)
    return largest
