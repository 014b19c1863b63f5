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
    plant: Plant, actuator: Actuator, wanted: FitRange, coefficients: FloatArray, values: FloatArray
) -> FloatArray:
    """Return the times that fitted curves give at values of the field.

    Parameters
    ----------
    plant, actuator, wanted
        What was fitted, and over which field.
    coefficients
        A row for each impulse, ascending powers of x, shape (n, degree + 1).
    values
        Of the field, in its own unit, shape (m,).

    Returns
    -------
    FloatArray
        Shape (m, n) [s].

    Raises
    ------
    InvalidInputError
        If a value is outside the range of the fit: the residual there is not known.
    """
    outside = values[~((values >= wanted.start) & (values <= wanted.stop))]
    if outside.size:
        raise InvalidInputError(
            wanted.over,
            float(outside[0]),
            f"between {wanted.start:g} and {wanted.stop:g}, which the curves were fitted over",
            code="out_of_range",
        )
    axis = axis_of_fit(plant, actuator, wanted)
    there: list[Plant] = [vary(plant, (wanted.over,), value) for value in values.tolist()]
    frequencies_rad_s = np.array([one.modes[0].natural_frequency_rad_s for one in there])
    unit = axis.frequency_unit_rad_s
    x = values if unit is None else frequencies_rad_s / unit
    fitted: FloatArray = np.vander(x, coefficients.shape[1], increasing=True) @ coefficients.T
    return fitted / frequencies_rad_s[:, None] if axis.in_phases else fitted
