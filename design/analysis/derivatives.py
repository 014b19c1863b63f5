"""Derivatives over the frequency by one polynomial through the values at many."""

from numpy.polynomial import chebyshev

from design.types import ComplexArray, FloatArray

POLYNOMIAL_FROM = 2
"""Highest order asked for from which all derivatives are those of one polynomial."""

NODES = 17
REACH_RAD = 1.0
MAX_REACH = 0.3
"""Frequencies of that polynomial; the turn of the last phase from the middle one to the ends, which
are at most a third away.

Of a vibration that turns by phase p the third derivative is off by less than 1e-15 p^3 by the
polynomial's degree, and by up to 1e-11 p^3 by rounding in what is simulated.
"""


def polynomial_nodes(phase: float) -> tuple[float, FloatArray]:
    """Return the polynomial's reach and nodes, logarithms of frequency ratios.

    The phase is that by which the vibration turns until the last step [rad].
    """
    reach = min(REACH_RAD / phase, MAX_REACH)
    return reach, reach * chebyshev.chebpts1(NODES)


def polynomial_derivatives(values: ComplexArray, reach: float, highest: int) -> list[complex]:
    """Return the derivatives at the middle of the nodes.

    Parameters
    ----------
    values, reach
        What the polynomial goes through at the nodes of `polynomial_nodes`, and their reach.
    highest
        Order of the highest derivative.

    Returns
    -------
    list of complex
        From the first derivative on.
    """
    series = chebyshev.chebfit(chebyshev.chebpts1(NODES), values, NODES - 1)
    return [
        complex(chebyshev.chebval(0.0, chebyshev.chebder(series, order, scl=1 / reach)))
        for order in range(1, highest + 1)
    ]
