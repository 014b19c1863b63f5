"""What use cases share: the plant and the drive of a request, and its shaper on samples."""

from collections.abc import Iterable
from itertools import zip_longest
from typing import Protocol

from design.analysis.sensitivity import (
    Sensitivity,
)
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.pipeline import Design, design
from design.sampling.sampled import Sampled
from design.sampling.sampled_design import sampled_design
from design.shapers.options import ShaperOptions
from schemas.actuators import ActuatorIn
from schemas.base import name_field
from schemas.plants import PlantIn
from schemas.sensitivity import ModeOut
from schemas.shapers import ShaperIn

NO_FIT_ON_SAMPLES = "a fit is over times that change smoothly, which whole samples do not"


class Subject(Protocol):
    """A request about a plant and its actuator."""

    @property
    def plant(self) -> PlantIn:
        """What moves."""

    @property
    def actuator(self) -> ActuatorIn:
        """What drives it."""


def subject_of(request: Subject) -> tuple[Plant, Actuator]:
    """Return the plant and the actuator of a request.

    Parameters
    ----------
    request
        The request.

    Returns
    -------
    tuple of Plant and Actuator
        As the mathematics has them.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule: names the field from the request inward.
    """
    with name_field("plant"):
        plant = request.plant.to_design()
    with name_field("actuator"):
        actuator = request.actuator.to_design()
    return plant, actuator


def of_modes(
    modes: tuple[Mode, ...], residuals: Iterable[float], curves: list[Sensitivity]
) -> list[ModeOut] | None:
    """Return the residual vibration in each of several modes.

    Parameters
    ----------
    modes
        The modes of the plant.
    residuals
        Residual vibration in each of them [-].
    curves
        Sensitivity curve of each mode; empty where none was asked for.

    Returns
    -------
    list of ModeOut or None
        An entry for each mode; None for a plant of one mode, where the rest of the answer says it.
    """
    if len(modes) == 1:
        return None
    each = zip_longest(modes, residuals, curves)
    return [ModeOut.from_design(mode, residual, curve) for mode, residual, curve in each]


def design_shaper(
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
            found, plant.mode, actuator, sample_time_s, tolerance=shaper.grid_tolerance()
        )
