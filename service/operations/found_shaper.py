"""The shaper of a request, designed and on samples where they are asked for."""

from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.pipeline import Design, design
from design.sampling.on_grid import SampleGrid, brought_to_grid, require_served
from design.sampling.sampled import Sampled
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
    kind, options = shaper.shaper_kind(), shaper.options()
    grid = SampleGrid(sample_time_s=sample_time_s, sample_tolerance=grid_tolerance(shaper))
    with name_field("shaper"):
        return brought_to_grid(found, plant, actuator, kind, options, grid)


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
    if shaper.sample_time_s is not None:
        with name_field("shaper"):
            kind, options = shaper.shaper_kind(), shaper.options()
            require_served(plant.modes, kind, options, shaper.sample_time_s)
