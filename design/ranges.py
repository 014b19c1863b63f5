"""Plants whose frequency is anywhere in a range: what a design promises over it."""

import math
from dataclasses import fields

from design.analysis.certificate import Certificate, certify
from design.claims import Promise, within
from design.errors import InfeasibleDesignError, InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.scheduled import Scheduled
from design.shapers.kind import Options


def options_over(plant: Scheduled, options: Options) -> Options:
    """Return options whose band is the plant's range.

    Parameters
    ----------
    plant
        The plant.
    options
        Those of the request; of a kind that takes no band they stay as they are.

    Returns
    -------
    Options
        Of the same kind.

    Raises
    ------
    InvalidInputError
        If a band is given besides, or the range is wider than the kind serves.
    """
    if not options.BAND_FIELDS:
        return options
    for option in fields(options):
        given = getattr(options, option.name)
        if option.name in options.BAND_FIELDS and given != option.default:
            raise InvalidInputError(
                f"shaper.{option.name}",
                given,
                "left out for a scheduled plant, whose range of frequencies is the band",
                code="band_of_scheduled_plant",
            )
    try:
        return options.with_band(plant.band[1] - 1)
    except InvalidInputError as error:
        raise InvalidInputError(
            "plant.to",
            f"{error.value:g} of it",
            f"such that the range's frequencies reach to either side of their middle {error.rule}",
            code="range_one_sided",
        ) from None


def promises_over(plant: Scheduled, promises: tuple[Promise, ...]) -> tuple[Promise, ...]:
    """Return promises with that over the plant's range last.

    It is of the kind's largest tolerance. A kind that promises nothing over a band promises nothing
    over the range.

    Parameters
    ----------
    plant
        The plant.
    promises
        Those of the kind.

    Returns
    -------
    tuple of Promise
        At most one more.
    """
    limits = [promise.limit for promise in promises if promise.quantity == "band"]
    return (*promises, *(within(limit, plant.band) for limit in sorted(limits)[-1:]))


def require_over(plant: Scheduled, name: str, certificate: Certificate) -> None:
    """Check that the tolerance over the range is not all that fails.

    Parameters
    ----------
    plant
        What moves.
    name
        Kind of the shaper.
    certificate
        Its claims, that over the range last, see `promises_over`.

    Raises
    ------
    InfeasibleDesignError
        If every other claim holds, and that over the range does not.
    """
    *own, over_range = certificate.claims
    fails = over_range.band is not None and not over_range.holds
    if not fails or not all(claim.holds for claim in own):
        return
    low, high = plant.band
    raise InfeasibleDesignError(
        f"the residual of {name} is {over_range.value:.4g} within the range of frequencies, "
        f"{low:.4g} to {high:.4g} of its middle, above its tolerance {over_range.limit:g}: "
        "narrow the range, raise the tolerance, or take a kind with more humps",
        code="range_above_tolerance",
    )


def worst_over(plant: Scheduled, impulses: Impulses, actuator: Actuator) -> float:
    """Return the largest residual at any frequency of the range [-].

    Parameters
    ----------
    plant
        What moves.
    impulses
        The shaper.
    actuator
        The drive that is given.

    Returns
    -------
    float
        Share of an unshaped step [-].
    """
    asked = within(math.inf, plant.band)
    return certify(impulses, plant.middle, actuator, (asked,)).claims[0].value
