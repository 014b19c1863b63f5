"""Times of a shaper at any value of the field that its curves were fitted over."""

import numpy as np

from design.curve_fit.fit_range import FitRange
from design.curve_fit.variable import axis_of_fit
from design.errors import InvalidInputError
from design.fields import vary
from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.types import FloatArray


def times_by_curves(
    plant: Plant, actuator: Actuator, wanted: FitRange, coefficients: FloatArray, value: float
) -> FloatArray:
    """Return the times that fitted curves give at one value of the field.

    Parameters
    ----------
    plant, actuator, wanted
        What was fitted, and over which field.
    coefficients
        A row for each impulse, ascending powers of x, shape (n, degree + 1).
    value
        Of the field, in its own unit.

    Returns
    -------
    FloatArray
        Shape (n,) [s].

    Raises
    ------
    InvalidInputError
        If the value is outside the range of the fit: the residual there is not known.
    """
    if not wanted.start <= value <= wanted.stop:
        raise InvalidInputError(
            wanted.over,
            value,
            f"between {wanted.start:g} and {wanted.stop:g}, which the curves were fitted over",
            code="out_of_range",
        )
    axis = axis_of_fit(plant, actuator, wanted)
    there: Plant = vary(plant, (wanted.over,), value)
    frequency_rad_s = there.modes[0].natural_frequency_rad_s
    unit = axis.frequency_unit_rad_s
    x = value if unit is None else frequency_rad_s / unit
    fitted: FloatArray = coefficients @ x ** np.arange(coefficients.shape[1])
    return fitted / (frequency_rad_s if axis.in_phases else 1.0)
