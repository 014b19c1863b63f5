"""How the residual vibration grows with an error in the plant's frequency or damping."""

from dataclasses import dataclass

import numpy as np

from design.analysis.insensitivity import Insensitivity, insensitivity
from design.analysis.sensitivity_range import DampingRange, SensitivityRange
from design.analysis.vectors import evenly_spaced_vectors, residual_vectors
from design.errors import SolverFailedError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray


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
            "the sensitivity curve exceeds the range of numbers", code="curve_overflows"
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


def residual_curve(
    impulses: Impulses, mode: Mode, actuator: Actuator, frequency_ratios: FloatArray
) -> FloatArray:
    """Return the residual at each ratio of true and nominal frequency.

    Damping ratio and times stay; the pole and the normalising step move along.

    Parameters
    ----------
    impulses
        The command.
    mode, actuator
        The nominal mode and its actuator.
    frequency_ratios
        True frequency over the nominal one, shape (m,), > 0 [-].

    Returns
    -------
    FloatArray
        Residual vibration, shape (m,) [-].
    """
    return np.abs(residual_vectors(impulses, mode.pole_rad_s * frequency_ratios, actuator))
