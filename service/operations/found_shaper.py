"""The shaper of a request, designed and on samples where they are asked for."""

from dataclasses import replace

from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.pipeline import Design, design
from design.ranges import worst_over
from design.sampling.sampled import MAX_DURATION_PERIODS, Sampled
from design.sampling.sampled_design import require_one_mode, sampled_design
from design.sampling.sampled_free import may_be_between_levels
from design.shapers.options import ShaperOptions
from schemas.base import name_field
from schemas.samples import grid_tolerance
from schemas.shapers import ShaperIn

UNITY_OF_SEVERAL = ("multi_umzv", "umzv", "umzvd")
"""Kinds, or what is convolved, whose impulses are of unity magnitude for several modes."""


def found_shaper(
    plant: Plant,
    actuator: Actuator,
    shaper: ShaperIn,
    options: ShaperOptions | None,
) -> Design:
    """Return a designed shaper, on samples where asked.

    Parameters
    ----------
    plant
        The plant.
    actuator
        The actuator.
    shaper
        The shaper on the wire, with its sample time if any.
    options
        The parameters of its kind.

    Returns
    -------
    Design
        The shaper with its certificate.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    InfeasibleDesignError
        If no such shaper was found.
    SolverFailedError
        If none of the solutions found was verified.
    TimeLimitError
        If a solver ran past its time.
    """
    found = design(plant, actuator, shaper.shaper_kind(), options)
    if shaper.sample_time_s is None:
        return found
    return on_samples(found, plant, actuator, shaper, shaper.sample_time_s)[0]


def on_samples(
    found: Design, plant: Plant, actuator: Actuator, shaper: ShaperIn, sample_time_s: float
) -> tuple[Design, Sampled]:
    """Return a design brought to a sample grid, and what that cost.

    Parameters
    ----------
    found
        The design between the samples.
    plant
        The plant, of one mode or several, or over a range.
    actuator
        The actuator.
    shaper
        The shaper on the wire, with its tolerance on samples.
    sample_time_s
        Sample time of the controller [s].

    Returns
    -------
    tuple of Design and Sampled
        The design on samples, and how it came there.

    Raises
    ------
    InvalidInputError
        If the sample time does not suit the shaper.
    InfeasibleDesignError
        If no amplitudes on samples keep what the shaper claims.
    SolverFailedError
        If simulation does not confirm the residual on samples.
    """
    with name_field("shaper"):
        designed, sampled = sampled_design(
            found,
            plant.modes,
            actuator,
            sample_time_s,
            tolerance=grid_tolerance(shaper),
            claimed=shaper.sample_tolerance,
            between_levels=may_be_between_levels(shaper.shaper_kind()),
            max_duration_periods=getattr(shaper, "max_duration_periods", MAX_DURATION_PERIODS),
        )
    if isinstance(plant, Scheduled):
        worst = worst_over(plant, designed.impulses, actuator)
        designed = replace(designed, worst_in_range=worst)
    return designed, sampled


def require_sampled(plant: Plant, shaper: ShaperIn) -> None:
    """Check that the modes can be shaped on samples, where asked.

    Parameters
    ----------
    plant, shaper
        What moves, and the shaper on the wire.

    Raises
    ------
    InvalidInputError
        If unity magnitude is to leave nothing in several modes.
    """
    base = getattr(shaper, "base", shaper.kind)
    if shaper.sample_time_s is not None and base in UNITY_OF_SEVERAL:
        with name_field("shaper"):
            require_one_mode(plant.modes, shaper.sample_time_s)
