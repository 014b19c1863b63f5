"""Parameters of an actuator that brakes as it accelerates, from those of one that does not."""

from design.formulations.lag_parameters import LAG_PARAMETERS
from design.types import FloatArray

ACCEL_TO_DECEL = {1: 3, 2: 4, 5: 6, 7: 9, 8: 10}
"""Places in `lag_parameters` of the accelerating set's numbers and of the other's."""


def with_equal_sets(parameters: FloatArray) -> FloatArray:
    """Return `lag_parameters` of an actuator that brakes as it accelerates.

    What follows them stays.

    Parameters
    ----------
    parameters
        Of lags without limits and of at most one more number, or with limits, shape (p,).

    Returns
    -------
    FloatArray
        Shape (p,).
    """
    equal = parameters.copy()
    ramped = parameters.size >= LAG_PARAMETERS[True]
    for accel, decel in ACCEL_TO_DECEL.items():
        if ramped or decel < LAG_PARAMETERS[False]:
            equal[decel] = parameters[accel]
    return equal
