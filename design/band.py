"""A band of frequencies around the nominal one: by its half width or by its ends."""

from typing import Protocol

from design.errors import InvalidInputError

USUAL_HALF_WIDTH = 0.15
"""Half width of a band that is not given: the I = 0.3 of the literature [-]."""


class Band(Protocol):
    """Parameters that say a band.

    Attributes
    ----------
    half_width
        The band is ``1 - half_width`` to ``1 + half_width`` [-]; None if its ends are given, or
        nothing is.
    lower_ratio, upper_ratio
        Its ends, true frequency over the nominal one [-]; None with ``half_width``.
    """

    @property
    def half_width(self) -> float | None:
        """Half of the band's width [-]."""

    @property
    def lower_ratio(self) -> float | None:
        """The lower end [-]."""

    @property
    def upper_ratio(self) -> float | None:
        """The upper end [-]."""


def require_said_once(band: Band) -> None:
    """Raise InvalidInputError where a band is said twice, or by one end."""
    if band.half_width is not None:
        for name in ("lower_ratio", "upper_ratio"):
            if getattr(band, name) is not None:
                raise said_twice(name, getattr(band, name), "half_width")
    elif (band.lower_ratio is None) != (band.upper_ratio is None):
        missing = "lower_ratio" if band.lower_ratio is None else "upper_ratio"
        raise half_said(missing)


def said_twice(field: str, value: object, first: str) -> InvalidInputError:
    """Return the refusal of a band that is said in a second way.

    Parameters
    ----------
    field, value, first
        The second way, what it is, and the field of the first.

    Returns
    -------
    InvalidInputError
        With the field to leave out.
    """
    return InvalidInputError(
        field, value, f"left out where {first} is given", code="band_said_twice"
    )


def half_said(missing: str) -> InvalidInputError:
    """Return the refusal of a band with one end, by the field of the other."""
    return InvalidInputError(
        missing, None, "given where the other end of the band is", code="band_half_said"
    )


def ends_of(band: Band) -> tuple[float, float]:
    """Return the ends of a band.

    Returns
    -------
    lower, upper
        Ratios of the nominal frequency; those of `USUAL_HALF_WIDTH` where no band is given [-].

    Examples
    --------
    >>> from design.shapers.specified_insensitivity import BandOptions
    >>> ends_of(BandOptions(lower_ratio=0.9, upper_ratio=1.3))
    (0.9, 1.3)
    """
    if band.lower_ratio is not None and band.upper_ratio is not None:
        return band.lower_ratio, band.upper_ratio
    half = USUAL_HALF_WIDTH if band.half_width is None else band.half_width
    return 1 - half, 1 + half
