"""The residual over the damping ratio, at the natural frequency as given."""

from dataclasses import dataclass

import numpy as np

from design.analysis.residual import residual_vectors
from design.checks import require_between
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode
from design.types import FloatArray

MAX_CURVE_POINTS = 20_001
"""Longest curve, a bound on the work of one request."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingRange:
    """Which damping ratios the plant may have."""

    # Least and largest, ``0 <= start < stop <= 0.99`` [-]
    start: float
    stop: float
    points: int = 101  # Number of points, 2 to 20,001

    def __post_init__(self) -> None:
        require_between("damping.from", self.start, 0.0, MAX_DAMPING_RATIO)
        require_between("damping.to", self.stop, 0.0, MAX_DAMPING_RATIO)
        if self.stop <= self.start:
            raise InvalidInputError(
                "damping.to", self.stop, f"greater than from, {self.start!r}", code="range_reversed"
            )
        require_between("damping.points", self.points, 2, MAX_CURVE_POINTS)


def over_damping(
    impulses: Impulses, mode: Mode, actuator: Actuator, wanted: DampingRange
) -> tuple[FloatArray, FloatArray]:
    """Return damping ratios and the residual vibration there.

    Parameters
    ----------
    impulses, mode, actuator
        The command, the nominal mode and its drive.
    wanted
        The range of damping ratios.

    Returns
    -------
    tuple of FloatArray
        Ratios and residuals, shape (k,) each [-].
    """
    ratios = np.linspace(wanted.start, wanted.stop, wanted.points)
    poles = mode.natural_frequency_rad_s * (-ratios + 1j * np.sqrt(1 - ratios**2))
    return ratios, np.abs(residual_vectors(impulses, poles, actuator))
