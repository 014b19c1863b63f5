"""How the residual vibration grows with an error in the plant's frequency or damping."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from design.analysis.insensitivity import Insensitivity, common_interval, insensitivity
from design.analysis.vectors import evenly_spaced_vectors, residual_vectors
from design.errors import InvalidInputError, SolverFailedError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode
from design.types import FloatArray, require_between

MAX_CURVE_POINTS = 20_001
"""Longest curve, a bound on the work of one request."""

RATIO_BOUNDS = (1e-6, 1e6)
"""Frequency ratios of a curve [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingRange:
    """Which damping ratios the plant may have.

    Attributes
    ----------
    start, stop
        Least and largest, ``0 <= start < stop <= 0.99`` [-].
    points
        Number of points, 2 to 20,001.
    """

    start: float
    stop: float
    points: int = 101

    def __post_init__(self) -> None:
        require_between("damping.from", self.start, 0.0, MAX_DAMPING_RATIO)
        require_between("damping.to", self.stop, 0.0, MAX_DAMPING_RATIO)
        if self.stop <= self.start:
            raise InvalidInputError(
                "damping.to", self.stop, f"greater than from, {self.start!r}", code="range_reversed"
            )
        require_between("damping.points", self.points, 2, MAX_CURVE_POINTS)


@dataclass(frozen=True, slots=True, kw_only=True)
class SensitivityRange:
    """What part of the curve is wanted.

    Attributes
    ----------
    from_ratio, to_ratio
        First and last frequency ratio, ``0 < from < to`` [-].
    points
        Number of points, 2 to 20,001.
    tolerance
        Residual at which the insensitivity is told, 0 to 1, both excluded [-].
    damping
        Range of a curve over the damping ratio; None for no such curve.
    """

    from_ratio: float = 0.5
    to_ratio: float = 1.5
    points: int = 201
    tolerance: float = 0.05
    damping: DampingRange | None = None

    def __post_init__(self) -> None:
        require_between("from_ratio", self.from_ratio, *RATIO_BOUNDS)
        require_between("to_ratio", self.to_ratio, *RATIO_BOUNDS)
        if self.to_ratio <= self.from_ratio:
            raise InvalidInputError(
                "to_ratio",
                self.to_ratio,
                f"greater than from_ratio, {self.from_ratio!r}",
                code="ratios_reversed",
            )
        require_between("points", self.points, 2, MAX_CURVE_POINTS)
        if not 0 < self.tolerance < 1:
            raise InvalidInputError(
                "tolerance", self.tolerance, "between 0 and 1, both excluded", code="out_of_range"
            )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensitivity:
    """A sensitivity curve.

    Attributes
    ----------
    frequency_ratios
        True over nominal frequency, shape (m,) [-].
    residuals
        Residual vibration there, shape (m,) [-].
    tolerance
        Tolerance of the insensitivity [-].
    insensitivity
        None where the nominal itself is above the tolerance.
    damping
        Damping ratios and the residuals there, shape (k,) each [-]; None where not asked for.
    """

    frequency_ratios: FloatArray
    residuals: FloatArray
    tolerance: float
    insensitivity: Insensitivity | None
    damping: tuple[FloatArray, FloatArray] | None = None


def sensitivity(
    impulses: Impulses, mode: Mode, actuator: Actuator, wanted: SensitivityRange
) -> Sensitivity:
    """Return the sensitivity curve of any impulses.

    Parameters
    ----------
    impulses
        A shaper or a whole command.
    mode, actuator
        The nominal mode and its actuator.
    wanted
        Range, points and tolerance.

    Returns
    -------
    Sensitivity
        The curve with its insensitivity, and the curve over damping where it is wanted.

    Raises
    ------
    InvalidInputError
        If the command lasts for more than 1e6 rad of the mode's phase.
    SolverFailedError
        If a residual of the curve is too large for a number.
    """
    pole = mode.pole_rad_s
    vectors = evenly_spaced_vectors(
        impulses, pole * wanted.from_ratio, pole * wanted.to_ratio, wanted.points, actuator
    )
    residuals = np.abs(vectors)
    if not np.isfinite(residuals).all():
        raise SolverFailedError(
            "the sensitivity curve leaves the range of numbers", code="curve_overflows"
        )
    return Sensitivity(
        frequency_ratios=np.linspace(wanted.from_ratio, wanted.to_ratio, wanted.points),
        residuals=residuals,
        tolerance=wanted.tolerance,
        insensitivity=insensitivity(impulses, mode, actuator, wanted.tolerance),
        damping=None
        if wanted.damping is None
        else _over_damping(impulses, mode, actuator, wanted.damping),
    )


def _over_damping(
    impulses: Impulses, mode: Mode, actuator: Actuator, wanted: DampingRange
) -> tuple[FloatArray, FloatArray]:
    """Return damping ratios and what is left there at the mode's own natural frequency."""
    ratios = np.linspace(wanted.start, wanted.stop, wanted.points)
    poles = mode.natural_frequency_rad_s * (-ratios + 1j * np.sqrt(1 - ratios**2))
    return ratios, np.abs(residual_vectors(impulses, poles, actuator))


def worst_of(curves: Sequence[Sensitivity]) -> Sensitivity:
    """Return the largest residuals of several modes that change alike.

    The frequencies of all modes are off by the same ratio.

    Parameters
    ----------
    curves
        One a mode, over the same ratios and at the same tolerance; at least one.

    Returns
    -------
    Sensitivity
        Its insensitivity is the interval common to all modes; None where one mode has none.
    """
    damped = [curve.damping for curve in curves if curve.damping is not None]
    over_damping = None
    if damped:
        over_damping = damped[0][0], np.max([residuals for _, residuals in damped], axis=0)
    return Sensitivity(
        frequency_ratios=curves[0].frequency_ratios,
        residuals=np.max([curve.residuals for curve in curves], axis=0),
        tolerance=curves[0].tolerance,
        insensitivity=common_interval([curve.insensitivity for curve in curves]),
        damping=over_damping,
    )
