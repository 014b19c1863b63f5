"""A design on the samples of a controller: what is asked of them, and the design brought there."""

from dataclasses import dataclass, replace

from design.checks import require_between, require_scale
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.pipeline import Design, design
from design.ranges import worst_over
from design.sampling.sampled import MAX_DURATION_PERIODS, Sampled
from design.sampling.sampled_design import (
    SAMPLE_TOLERANCE,
    require_one_mode,
    sampled_design,
)
from design.sampling.sampled_free import may_be_between_levels
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.shapers.refusals import require_small_swings

UNITY_OF_SEVERAL = ("umzv", "umzvd")
"""What is convolved of unity magnitude for several modes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleGrid:
    """The samples that impulses lie on, and what unity magnitude may leave there.

    Attributes
    ----------
    sample_time_s
        Sample time of the controller, > 0 [s].
    sample_tolerance
        What a shaper of unity magnitude may leave before impulses are added, 0 to 1 [-]; None adds
        none.
    claimed
        What it then claims to leave at most, 0 to 1 [-]; the sample tolerance if None.

    Raises
    ------
    InvalidInputError
        If one of them breaks its rule.
    """

    sample_time_s: float
    sample_tolerance: float | None = SAMPLE_TOLERANCE
    claimed: float | None = None

    def __post_init__(self) -> None:
        require_scale("sample_time_s", self.sample_time_s)
        if self.sample_tolerance is not None:
            require_between("sample_tolerance", self.sample_tolerance, 0.0, 1.0)


def design_on_grid(
    plant: Plant,
    actuator: Actuator,
    kind: ShaperKind,
    options: ShaperOptions | None,
    grid: SampleGrid | None,
) -> Design:
    """Design a shaper, on samples where asked.

    Parameters
    ----------
    plant, actuator, kind, options
        As for `design.pipeline.design`.
    grid
        The samples; None between samples.

    Returns
    -------
    Design
        The shaper, with a certificate of what is sent.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the sample time does not suit the shaper.
    InfeasibleDesignError
        If no such shaper was found, or none on samples.
    SolverFailedError
        If a certificate verified nothing that was found.
    """
    found = design(plant, actuator, kind, options)
    if grid is None:
        return found
    return brought_to_grid(found, plant, actuator, kind, options, grid)[0]


def brought_to_grid(
    found: Design,
    plant: Plant,
    actuator: Actuator,
    kind: ShaperKind,
    options: ShaperOptions | None,
    grid: SampleGrid,
) -> tuple[Design, Sampled]:
    """Return a design brought to samples, and what that cost.

    Parameters
    ----------
    found
        The design between the samples.
    plant, actuator, kind, options
        What it is a design of: one mode or several, or a range.
    grid
        The samples.

    Returns
    -------
    Design
        The shaper on samples.
    Sampled
        How it came there.

    Raises
    ------
    InvalidInputError
        If the sample time does not suit the shaper.
    InfeasibleDesignError
        If no amplitudes on samples keep what the shaper claims.
    SolverFailedError
        If simulation does not confirm the residual on samples.
    """
    require_small_swings(kind, "shapers on samples", "kind")
    designed, sampled = sampled_design(
        found,
        plant.modes,
        actuator,
        grid.sample_time_s,
        tolerance=grid.sample_tolerance,
        claimed=grid.claimed,
        between_levels=may_be_between_levels(kind, plant.modes),
        max_duration_periods=getattr(options, "max_duration_periods", MAX_DURATION_PERIODS),
    )
    if isinstance(plant, Scheduled):
        worst = worst_over(plant, designed.impulses, actuator)
        designed = replace(designed, worst_in_range=worst)
    return designed, sampled


def require_served(
    modes: tuple[Mode, ...],
    kind: ShaperKind,
    options: ShaperOptions | None,
    sample_time_s: float,
) -> None:
    """Check that a kind of shaper is served on samples.

    Parameters
    ----------
    modes
        Of the plant.
    kind, options
        Kind of the shaper, and its parameters.
    sample_time_s
        Sample time [s].

    Raises
    ------
    InvalidInputError
        If unity magnitude is to leave nothing in several modes, or the kind is for large swings.
    """
    require_small_swings(kind, "shapers on samples", "kind")
    if getattr(options, "base", kind.name) in UNITY_OF_SEVERAL:
        require_one_mode(modes, sample_time_s)
