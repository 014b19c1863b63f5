"""What to fit over, and how well."""

import math
from dataclasses import dataclass
from typing import Literal

from design.checks import require_between
from design.errors import InvalidInputError
from design.fields import vary
from design.model.plants.registry import Plant

Field = Literal["natural_frequency_rad_s", "cable_length_m", "damping_ratio"]

Form = Literal["dimensionless", "time_in_frequency"]

MAX_DEGREE = 20
"""Beyond it the power basis itself loses the digits that a degree adds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FitRange:
    """What to fit over, and how well.

    Attributes
    ----------
    over
        The plant's field.
    start, stop
        Its range, in its own unit.
    degree
        Degree of the polynomials, 0 to 20; or None,
    max_residual
        and the lowest degree is taken whose times leave at most this [-].
    form
        ``dimensionless``, or ``time_in_frequency``: the thesis's, for comparison.
    """

    over: Field
    start: float
    stop: float
    degree: int | None = None
    max_residual: float | None = None
    form: Form = "dimensionless"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.stop) and self.stop > self.start):
            raise InvalidInputError(
                "to",
                self.stop,
                f"finite and greater than from, {self.start!r}",
                code="range_not_finite",
            )
        if (self.degree is None) == (self.max_residual is None):
            raise InvalidInputError(
                "degree",
                "neither" if self.degree is None else "both",
                "given alone, or left out for max_residual: give one of degree and max_residual",
                code="degree_or_residual",
            )
        if self.degree is not None:
            require_between("degree", self.degree, 0, MAX_DEGREE)
        if self.max_residual is not None and not 0 < self.max_residual < 1:
            raise InvalidInputError(
                "max_residual",
                self.max_residual,
                "between 0 and 1, both excluded",
                code="out_of_range",
            )
        if self.form == "time_in_frequency" and self.over != "natural_frequency_rad_s":
            raise InvalidInputError(
                "form",
                self.form,
                "'dimensionless' over any but the frequency",
                code="form_not_served",
            )


def plants_at_ends(plant: Plant, wanted: FitRange) -> tuple[Plant, Plant]:
    """Return the plant at either end of the range.

    Parameters
    ----------
    plant
        The plant of the request.
    wanted
        Range of one of its fields.

    Returns
    -------
    tuple of Plant
        At the start and at the end of the range.

    Raises
    ------
    InvalidInputError
        If the plant has no such field, or an end breaks its rule.
    """
    if not hasattr(plant, wanted.over):
        raise InvalidInputError(
            "over", wanted.over, "a field of the plant", code="not_a_plant_field"
        )
    ends = []
    for name, value in (("from", wanted.start), ("to", wanted.stop)):
        try:
            ends.append(vary(plant, (wanted.over,), value))
        except InvalidInputError as error:
            raise error.at(name, value) from None
    return ends[0], ends[1]
