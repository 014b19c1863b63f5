"""Bands that a promise does not give: the widest around 1 that the impulses themselves keep."""

from dataclasses import replace

from design.analysis.insensitivity import insensitivity
from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.solvers.solution import Solution

BAND_MARGIN = 1e-6
"""Share by which a band is reported narrower than found: its ends are within the tolerance [-]."""


def with_own_band(
    promise: Promise, solution: Solution, modes: tuple[Mode, ...], actuator: Actuator
) -> Promise | None:
    """Return a promise with the widest band around 1 that the impulses keep.

    Parameters
    ----------
    promise
        A tolerance over a band that is left open.
    solution
        The impulses, with the ratios where their curve has zeros and peaks.
    modes, actuator
        The modes of the plant, and what the impulses are designed for.

    Returns
    -------
    Promise or None
        None if they pass the tolerance between their own zeros: then they solve the equations, and
        have another curve than these are to find.
    """
    found = insensitivity(solution.impulses, modes[promise.mode], actuator, promise.limit)
    if found is None:
        return None
    lower, upper = found.searched_from_ratio, found.searched_to_ratio
    if ((solution.ratios < lower) | (solution.ratios > upper)).any():
        return None
    half_width = min(1 - lower, upper - 1) * (1 - BAND_MARGIN)
    return replace(promise, band=(1 - half_width, 1 + half_width))
