"""The largest value of a curve, between the points of a grid too."""

from collections.abc import Callable

import numpy as np

from design.types import FloatArray

ZOOMS = 7
"""How often a peak is looked at four times closer [-].

Of curves that turn by 0.1 rad from one point to the next the place is then known to
0.1 rad / 4^7 = 6e-6 rad, and the height to the square of that.
"""


def largest_between(
    curve: Callable[[FloatArray], FloatArray], low: float, high: float, points: int
) -> float:
    """Return the largest value of a curve over an interval.

    Parameters
    ----------
    curve
        From places, shape (m,), to values, shape (m,).
    low, high
        Ends of the interval, among the places looked at.
    points
        Places of the first grid, dense enough that no peak is narrower than a step.

    Returns
    -------
    float
        In the unit of the curve, at a place within the interval.
    """
    places = np.linspace(low, high, points)
    values = curve(places)
    largest = float(values.max())
    # The ends too: a peak may lie between one of them and its neighbour.
    around = np.pad(values, 1, constant_values=-np.inf)
    peaks = np.flatnonzero((values >= around[:-2]) & (values >= around[2:]))
    middles, reach = places[peaks], float(places[1] - places[0])
    for _ in range(ZOOMS):
        closer = np.clip(middles[:, None] + reach * np.linspace(-1, 1, 9), low, high)
        values = curve(closer.ravel()).reshape(closer.shape)
        largest = max(largest, float(values.max()))
        middles, reach = closer[np.arange(middles.size), values.argmax(axis=1)], reach / 4
    return largest
