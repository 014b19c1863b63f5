"""The shaper of a request, designed and on samples where they are asked for."""

from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.plants.modes import Modes
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.pipeline import Design, design
from design.sampling.sampled import MAX_DURATION_PERIODS, Sampled
from design.sampling.sampled_design import sampled_design
from design.shapers.options import ShaperOptions
from schemas.base import name_field
from schemas.samples import grid_tolerance
from schemas.shapers import ShaperIn


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
        The plant, of one mode.
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
    SolverFailedError
        If simulation does not confirm the residual on samples.
    """
    with name_field("shaper"):
        return sampled_design(
            found,
            plant.mode,
            actuator,
            sample_time_s,
            tolerance=grid_tolerance(shaper),
            max_duration_periods=getattr(shaper, "max_duration_periods", MAX_DURATION_PERIODS),
        )


def require_one_mode(plant: Plant, sample_time_s: float) -> None:
    """Check that a plant has one mode of one frequency, as samples need.

    Parameters
    ----------
    plant, sample_time_s
        What moves, and the sample time of the controller [s].

    Raises
    ------
    InvalidInputError
        If the plant has several modes, or one over a range.
    """
    if isinstance(plant, Modes | Scheduled):
        raise InvalidInputError(
            "shaper.sample_time_s",
            sample_time_s,
            "left out for a plant of several modes or of a range",
            code="samples_of_one_mode",
        )
