"""How the residual vibration grows with an error in the plant's frequency or damping."""

from dataclasses import dataclass

import numpy as np

from design.analysis.damping_curve import MAX_CURVE_POINTS, DampingRange, over_damping
from design.analysis.insensitivity import Insensitivity, insensitivity
from design.analysis.residual import evenly_spaced_vectors
from design.checks import require_between
from design.errors import InvalidInputError, SolverFailedError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray

RATIO_BOUNDS = (1e-6, 1e6)
"""Frequency ratios of a curve [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SensitivityRange:
    """What part of the curve is wanted."""

    # First and last frequency ratio, ``0 < from < to`` [-]
    from_ratio: float = 0.5
    to_ratio: float = 1.5
    points: int = 201  # Number of points, 2 to 20,001
    tolerance: float = 0.05  # Residual of the insensitivity, 0 to 1, both excluded [-]
    damping: DampingRange | None = None  # Range of a curve over damping; None for no such curve

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
    """A sensitivity curve."""

    frequency_ratios: FloatArray  # True over nominal frequency, shape (m,) [-]
    residuals: FloatArray  # Residual vibration there, shape (m,) [-]
    tolerance: float  # Tolerance of the insensitivity [-]
    insensitivity: Insensitivity | None  # None where the nominal itself is above the tolerance
    # Damping ratios and the residuals there, shape (k,) each [-]; None where not asked for
    damping: tuple[FloatArray, FloatArray] | None = None


def sensitivity(
    impulses: Impulses, mode: Mode, actuator: Actuator, wanted: SensitivityRange
) -> Sensitivity:
    """Return the sensitivity curve of any impulses.

    Parameters
    ----------
    impulses, mode, actuator
        A shaper or a whole command, the nominal mode and its actuator.
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
            "the sensitivity curve exceeds the range of numbers", code="curve_overflows"
        )
    return Sensitivity(
        frequency_ratios=np.linspace(wanted.from_ratio, wanted.to_ratio, wanted.points),
        residuals=residuals,
        tolerance=wanted.tolerance,
        insensitivity=insensitivity(impulses, mode, actuator, wanted.tolerance),
        damping=None
        if wanted.damping is None
        else over_damping(impulses, mode, actuator, wanted.damping),
    )
