"""How long a lag takes to settle after a step."""

import math

from design.model.lags import SETTLED_SHARE, Lag


def settling_time_s(lag: Lag, share: float = SETTLED_SHARE) -> float:
    """Return the last time at which the step response is outside a band [s].

    Exact: by the exponential for a first-order lag, by bisection between the last extremum
    outside the band and the next for an oscillating one, by bisection for a slow one.

    Parameters
    ----------
    lag
        The lag.
    share
        The band is ``1 ± (1 - share)``, ``0 < share < 1`` [-].

    Returns
    -------
    float
        From the step on [s]; 0 for an ideal lag.

    Examples
    --------
    >>> round(settling_time_s(Lag(first_s=0.1), 0.98), 4)
    0.3912
    """
    band = 1 - share
    if lag.second_s2 == 0.0:
        return -lag.first_s * math.log(band)
    frequency = 1 / math.sqrt(lag.second_s2)
    damping = lag.first_s * frequency / 2
    if damping < 1:
        # Extrema of the error are at k half periods, exp(-z w t) high.
        half_period = math.pi / (frequency * math.sqrt(1 - damping**2))
        extrema = math.ceil(-math.log(band) / (damping * frequency * half_period)) - 1
        low, high = extrema * half_period, (extrema + 1) * half_period
    else:
        low, high = 0.0, 1 / frequency
        while abs(lag.step_error(high)) > band:
            low, high = high, 2 * high
    while high - low > 1e-12 * high:
        middle = (low + high) / 2
        if abs(lag.step_error(middle)) > band:
            low = middle
        else:
            high = middle
    return high
