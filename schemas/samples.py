"""What a request says of samples: what may be left on them, and where they are not served."""

from typing import Any

from design.errors import InvalidInputError
from design.sampling.on_grid import SampleGrid
from design.sampling.sampled_design import SAMPLE_TOLERANCE
from schemas.shaper_request import ShaperRequest


def grid_tolerance(shaper: ShaperRequest) -> float | None:
    """Return what a shaper may leave on samples before impulses are added.

    None adds none.
    """
    if getattr(shaper, "settle", False):
        return None
    return SAMPLE_TOLERANCE if shaper.sample_tolerance is None else shaper.sample_tolerance


def grid_of(shaper: ShaperRequest) -> SampleGrid | None:
    """Return the samples that a shaper is asked for on; None between samples."""
    if shaper.sample_time_s is None:
        return None
    return SampleGrid(sample_time_s=shaper.sample_time_s, sample_tolerance=grid_tolerance(shaper))


def continuous_options(shaper: ShaperRequest, reason: str) -> Any:  # noqa: ANN401
    """Build the record of parameters where no sample grid is served.

    Parameters
    ----------
    shaper
        The shaper on the wire.
    reason
        Why not, to be read after "left out: ".

    Returns
    -------
    Any
        The kind's own options.

    Raises
    ------
    InvalidInputError
        If a sample time is given, or a parameter breaks its rule.
    """
    if shaper.sample_time_s is not None:
        refuse_samples(shaper.sample_time_s, reason)
    return shaper.options()


def refuse_samples(sample_time_s: float, reason: str) -> None:
    """Refuse a sample time where no sample grid is served.

    Parameters
    ----------
    sample_time_s
        As given [s].
    reason
        Why not, to be read after "left out: ".

    Raises
    ------
    InvalidInputError
        Always.
    """
    raise InvalidInputError(
        "sample_time_s", sample_time_s, f"left out: {reason}", code="kind_not_sampled"
    )
