"""In what the phases of a table's rows are smooth: a coordinate for each field."""

from typing import Literal

import numpy as np

from design.types import FloatArray

SLOWING = ("plant.cable_length_m", "plant.mass_kg")
QUICKENING = ("plant.gravity_m_s2", "plant.stiffness_n_m")
"""Fields under the root of the plant's frequency, as its divisor and over it."""

INVERTED = (".natural_frequency_rad_s", "_limit_m_s2")
"""Ends of the actuator's fields whose inverses the phases are smooth in."""

Coordinate = Literal["inverse_root", "root", "inverse", "itself"]
"""What a coordinate is of the value of its field."""


def coordinate_of(name: str) -> Coordinate:
    """Return in what the phases are smooth over a field, up to a factor.

    The plant's frequency goes as the root of gravity over length, or of stiffness over mass. It is
    measured against the actuator's, and a ramp lasts the inverse of its limit: hence the inverses
    of those.
    """
    if name in SLOWING:
        return "inverse_root"
    if name in QUICKENING:
        return "root"
    if name.startswith("actuator.") and name.endswith(INVERTED):
        return "inverse"
    return "itself"


def scales_with_frequency(name: str) -> bool:
    """Return whether a coordinate is the plant's frequency times a number."""
    return name in {*SLOWING, *QUICKENING, "plant.natural_frequency_rad_s"}


def coordinates(name: str, values: FloatArray) -> FloatArray:
    """Return the coordinates of values of a field.

    Parameters
    ----------
    name
        The field, as ``plant.cable_length_m``.
    values
        Its values, in its unit.

    Returns
    -------
    FloatArray
        Of the same shape.
    """
    kind = coordinate_of(name)
    if kind == "inverse_root":
        return values**-0.5
    if kind == "root":
        return np.sqrt(values)
    return 1 / values if kind == "inverse" else values


def values_at(name: str, at: FloatArray) -> FloatArray:
    """Return the values of a field: the inverse of `coordinates`.

    Parameters
    ----------
    name
        The field.
    at
        Coordinates.

    Returns
    -------
    FloatArray
        Values in the field's unit, of the same shape.
    """
    kind = coordinate_of(name)
    if kind == "inverse_root":
        return at**-2
    if kind == "root":
        return at**2
    return 1 / at if kind == "inverse" else at
