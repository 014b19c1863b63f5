"""The frequencies around the nominal one on which the residual is within a tolerance."""

import math
from dataclasses import dataclass

import numpy as np

from design.analysis.edges import Excess, find_edge, step_outward
from design.errors import InvalidInputError
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode

EDGE_MARGIN = 1e-9
"""Relative margin of the tolerance: a shaper designed to touch it at the nominal must not fail."""

SCAN_STEP_PHASE = 2 * math.pi / 48
"""How far the last impulse's phase may turn between two points of the search for an edge [rad]."""

MAX_TURN_RAD = 1e6
"""Longest command, as a turn of the plant's phase [rad]."""

RATIO_LIMITS = (1e-3, 100.0)
"""How far an edge is looked for; an interval that reaches further has none [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Insensitivity:
    """The interval of frequency ratios around 1 on which the residual is within a tolerance."""

    tolerance: float
    # Edges of the connected interval that contains 1 [-]; None where the search found none
    lower_ratio: float | None
    upper_ratio: float | None
    # Between them all is within the tolerance: the edges, or where the search for one ended [-]
    searched_from_ratio: float
    searched_to_ratio: float

    @property
    def width(self) -> float | None:
        """Upper less lower edge; None where there is not either [-]."""
        if self.lower_ratio is None or self.upper_ratio is None:
            return None
        return self.upper_ratio - self.lower_ratio


def insensitivity(
    impulses: Impulses, mode: Mode, actuator: Actuator, tolerance: float
) -> Insensitivity | None:
    """Return the interval around 1 with the residual within a tolerance.

    Either edge of the connected interval is bracketed by a scan outward from 1, fine against the
    turn of the last impulse and with its near-misses looked at again, and then root-found, unless
    it is proven that there is none. The scan ends at `RATIO_LIMITS`, or after `MAX_SCAN_POINTS`.

    Parameters
    ----------
    impulses, mode, actuator
        The command, the nominal mode and its actuator.
    tolerance
        Largest residual, > 0 [-].

    Returns
    -------
    Insensitivity or None
        None where the residual at 1 is above the tolerance.

    Raises
    ------
    InvalidInputError
        If the command lasts for more than 1e6 rad of the mode's phase.
    """
    turn = mode.natural_frequency_rad_s * impulses.duration_s
    if turn > MAX_TURN_RAD:
        raise InvalidInputError(
            "impulses.times_s",
            f"{turn:.3g} rad of the plant's swing in all",
            f"at most {MAX_TURN_RAD:g} rad, beyond which phases lose their digits",
            code="phases_lose_digits",
        )
    if _never_above(impulses, actuator, tolerance):
        return Insensitivity(
            tolerance=tolerance,
            lower_ratio=None,
            upper_ratio=None,
            searched_from_ratio=RATIO_LIMITS[0],
            searched_to_ratio=RATIO_LIMITS[1],
        )
    excess = Excess(impulses, mode, actuator, tolerance * (1 + EDGE_MARGIN))
    if excess.at(1.0) > 0:
        return None
    step = SCAN_STEP_PHASE / excess.turn_rad if excess.turn_rad > 0 else math.inf
    # The first stretch on both sides at once: it nearly always holds both edges.
    below, above = (step_outward(1.0, end, step) for end in RATIO_LIMITS)
    near = np.concatenate((below[::-1], [1.0], above))
    values = excess.over(near)
    middle = below.size
    lower, lowest = find_edge(
        excess, near[middle + 1 :: -1], values[middle + 1 :: -1], RATIO_LIMITS[0], step
    )
    upper, highest = find_edge(
        excess, near[middle - 1 :], values[middle - 1 :], RATIO_LIMITS[1], step
    )
    return Insensitivity(
        tolerance=tolerance,
        lower_ratio=lower,
        upper_ratio=upper,
        searched_from_ratio=lowest,
        searched_to_ratio=highest,
    )


def _never_above(impulses: Impulses, actuator: Actuator, tolerance: float) -> bool:
    """Whether the residual is proven to be within the tolerance at every frequency.

    Steps that all go through the same lag leave no more than the sum of their sizes.
    """
    alike = bool(impulses.accelerates.all()) or actuator.accel_lag == actuator.decel_lag
    same_lag = alike and not isinstance(actuator, RateLimited)
    return same_lag and float(np.abs(impulses.amplitudes).sum()) <= tolerance
