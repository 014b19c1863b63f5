"""How what is left of a large swing grows with an error in the length of the cable."""

import math

import numpy as np

from design.analysis.insensitivity import EDGE_MARGIN, Insensitivity
from design.analysis.large_swing_certificate import large_swing_residuals
from design.analysis.sensitivity import Sensitivity, SensitivityRange
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.large_swing import LargeSwing
from design.types import FloatArray

LANES = 64
"""Lengths of the cable that are computed side by side."""

RATIO_LIMITS = 0.25, 2.0
"""How far an edge is looked for: from 16 times the length to a quarter of it,
or to where a damped load forgets its swing before the drive is at rest [-]."""

SCAN_RAD = 0.1
"""How far the last step's phase may turn between two points of the search for an edge [rad]."""
ROUNDS = 4
"""Scans of ever shorter stretches; in the last a chord is exact to 1e-12."""


def large_swing_sensitivity(
    impulses: Impulses, swing: LargeSwing, actuator: Actuator, wanted: SensitivityRange
) -> Sensitivity:
    """Return the sensitivity curve of steps on a load that swings far.

    Parameters
    ----------
    impulses, swing, actuator, wanted
        A command; the load at its full speed; a drive without limits to the acceleration; the
        range, the points and the tolerance.

    Returns
    -------
    Sensitivity
        Over the frequency that the length of the cable makes, with its insensitivity. Edges are
        looked for within `RATIO_LIMITS`.

    Raises
    ------
    InvalidInputError
        If a curve over the damping is asked for, or the load forgets a swing before the drive is at
        rest.
    """
    if wanted.damping is not None:
        raise InvalidInputError(
            "sensitivity.damping",
            "a curve over the damping",
            "left out for large swings, whose curve is over the length of the cable",
            code="damping_curve_of_large_swing",
        )
    ratios = np.linspace(wanted.from_ratio, wanted.to_ratio, wanted.points)
    return Sensitivity(
        frequency_ratios=ratios,
        residuals=_residuals(impulses, swing, actuator, ratios),
        tolerance=wanted.tolerance,
        insensitivity=_insensitivity(impulses, swing, actuator, wanted.tolerance),
    )


def _residuals(
    impulses: Impulses, swing: LargeSwing, actuator: Actuator, ratios: FloatArray
) -> FloatArray:
    """Return the residuals at ratios, ascending: neighbours together, as fine as they need."""
    return np.concatenate([
        large_swing_residuals(impulses, swing, actuator, ratios[first : first + LANES])
        for first in range(0, ratios.size, LANES)
    ])


def _insensitivity(
    impulses: Impulses, swing: LargeSwing, actuator: Actuator, tolerance: float
) -> Insensitivity | None:
    """Return the interval around 1 with the residual within a tolerance."""
    most = tolerance * (1 + EDGE_MARGIN)
    if large_swing_residuals(impulses, swing, actuator, np.ones(1))[0] > most:
        return None
    turn = swing.crane.mode.natural_frequency_rad_s * impulses.duration_s
    edges, ends = [], []
    for limit in (RATIO_LIMITS[0], min(RATIO_LIMITS[1], swing.most_ratio(actuator))):
        points = max(2, math.ceil(abs(limit - 1) * turn / SCAN_RAD) + 1)
        ratios = np.linspace(1.0, limit, points)
        edge = None
        for _ in range(ROUNDS):
            residuals = _residuals(impulses, swing, actuator, ratios)
            beyond = int(np.argmax(residuals > most))
            if residuals[beyond] <= most:
                break
            inside, outside = ratios[beyond - 1], ratios[beyond]
            low, high = residuals[beyond - 1], residuals[beyond]
            edge = float(inside + (outside - inside) * (most - low) / (high - low))
            ratios = np.linspace(inside, outside, LANES)
        edges.append(edge)
        ends.append(limit if edge is None else edge)
    return Insensitivity(
        tolerance=tolerance,
        lower_ratio=edges[0],
        upper_ratio=edges[1],
        searched_from_ratio=ends[0],
        searched_to_ratio=ends[1],
    )
