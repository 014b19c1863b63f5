"""Commands of unity magnitude on whole samples: the impulses moved.

A shaper of amplitudes +1, -1, +1, ... cannot be made exact on a grid. Moved to the best samples it
has a residual that no choice removes; more impulses (`design.sampling.more_impulses`) lower it.
"""

import itertools

import numpy as np

from design.analysis.workable import require_workable
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.left import TIE, Band, cuts_ramps, largest_over_band, residuals_of_many
from design.sampling.sample_grid import AnyIntArray, nearest_integers, require_gaps

MAX_REACH = 4
"""Samples on each side of an impulse that are looked at [-]."""

MAX_CANDIDATES = 50_000
"""Largest number of rounded shapers that one search compares; it narrows for more impulses."""

MAX_CUT_CANDIDATES = 1_000
"""The same where ramps are cut, so that the formula of many commands at once does not hold: each
takes some one or two milliseconds then."""


def unity_on_grid(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    slope: bool,
    band: Band | None = None,
) -> Impulses:
    """Return the impulses at the best whole samples around them.

    The amplitudes are unchanged.

    Compared is every choice of samples, up to four on each side of the nearest (fewer for more
    than five impulses, or where ramps are cut), in order. The first impulse stays at its nearest
    sample: all of them later by a sample are the same. What is minimised is the residual |V|, and
    with ``slope`` ``|V| + 0.05 |dV/d ln w|``: to first order the most that 5 % of error in
    frequency causes. With a band it is the largest residual over that.

    Parameters
    ----------
    impulses
        The shaper.
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time, > 0, at most the shortest gap between two impulses [s].
    slope
        Whether the slope in frequency counts too.
    band
        Lowest and highest ratio of true and nominal frequency that count; None for 1 alone [-].

    Returns
    -------
    Impulses
        The choice of least residual; of two with the same, the shorter, then the earlier.
        `design.analysis.residual` gives its residual, which is not zero.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule, a set of the actuator is out of all proportion to the
        plant, or there are more than ten impulses.
    """
    require_workable(mode, actuator)
    require_gaps(impulses, sample_time_s)
    cut = cuts_ramps(impulses, actuator, sample_time_s)
    most = MAX_CUT_CANDIDATES if cut else MAX_CANDIDATES
    samples = _choices(nearest_integers(impulses.times_s / sample_time_s), most)
    times = samples * sample_time_s
    if band is None:
        left = residuals_of_many(times, impulses.amplitudes, mode, actuator, slope=slope)
    else:
        left = largest_over_band(times, impulses.amplitudes, mode, actuator, band)
    chosen = samples[_shortest(samples, np.flatnonzero(left <= left.min() + TIE))]
    return Impulses(times_s=chosen * sample_time_s, amplitudes=impulses.amplitudes)


def _choices(centres: AnyIntArray, most: int) -> AnyIntArray:
    """Every ordered choice of samples around the centres, in lexical order, shape (m, n)."""
    free = centres.size - 1
    reach = MAX_REACH
    while (2 * reach + 1) ** free > (most if reach > 1 else MAX_CANDIDATES):
        reach -= 1
    if reach == 0:
        raise InvalidInputError(
            "impulses", centres.size, "few enough to search: at most 10", code="too_many_to_search"
        )
    moves = list(itertools.product(range(-reach, reach + 1), repeat=free))
    samples = np.repeat(centres[None], len(moves), axis=0)
    samples[:, 1:] += np.array(moves, dtype=int)
    ordered: AnyIntArray = samples[np.all(np.diff(samples, axis=1) > 0, axis=1)]
    return ordered


def _shortest(samples: AnyIntArray, among: AnyIntArray) -> int:
    """Return the first of the shortest: rows come in lexical order, so that it is the earlier."""
    return int(among[np.argmin(samples[among, -1])])
