"""A design with all that its request asks of it: its curves, its samples, its trace."""

from dataclasses import dataclass

from design.analysis.drive_sensitivity import require_parameters
from design.analysis.large_swing_sensitivity import large_swing_sensitivity
from design.analysis.sensitivity import Sensitivity, sensitivity
from design.errors import DesignError
from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.pipeline import Design, design
from design.shapers.refusals import require_small_swings
from design.solvers.budget import Budget
from design.trace import TraceStep
from schemas.base import name_field
from schemas.design_request import DesignRequest
from schemas.sampled import SampledOut
from service.operations.fit import read_fit
from service.operations.found_shaper import on_samples, require_sampled
from service.operations.subject import subject_of


@dataclass(frozen=True, slots=True)
class RequestedDesign:
    """A design with all that was asked of it."""

    plant: Plant  # What moves
    actuator: Actuator  # What drives it
    design: Design  # The shaper that is sent: on samples where they were asked for
    curves: list[Sensitivity]  # Its sensitivity curve in each mode; empty where none was asked for
    sampled: SampledOut | None  # How it came to the samples; None where none were asked for
    trace: list[TraceStep]  # Steps of the search; empty where they were not asked for


def requested_design(request: DesignRequest) -> RequestedDesign:
    """Design what a request asks for, its curves too.

    Returns
    -------
    RequestedDesign
        The design and what was asked of it.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    DesignError
        If no such shaper was found; has the steps of the search, where they were asked for.
    """
    plant, actuator = subject_of(request)
    with name_field("shaper"):
        options = request.shaper.options()
    curve_range = None
    # Every fault of the request is found before the first computation.
    if request.sensitivity is not None:
        with name_field("sensitivity"):
            curve_range = request.sensitivity.to_design()
    if request.drive is not None:
        require_small_swings(request.shaper.shaper_kind(), "errors of the drive")
        require_parameters(actuator)
    if request.fit is not None:
        read_fit(request.shaper, request.fit, request.plant.kind, plant)
    kind = request.shaper.shaper_kind()
    sample_time_s = request.shaper.sample_time_s
    if sample_time_s is not None:
        require_sampled(plant, request.shaper)
    trace: list[TraceStep] = []
    budget = Budget(trace=trace if request.trace else None)
    try:
        found, told = design(plant, actuator, kind, options, budget), None
    except DesignError as error:
        error.trace = tuple(trace)
        raise
    if sample_time_s is not None:
        continuous = found.impulses
        found, sampled = on_samples(found, plant, actuator, request.shaper, sample_time_s)
        told = SampledOut.from_design(sampled, continuous)
    curves = []
    if curve_range is not None:
        sent, swing = found.impulses, found.large_swing
        curves = (
            [sensitivity(sent, mode, actuator, curve_range) for mode in plant.modes]
            if swing is None
            else [large_swing_sensitivity(sent, swing.swing, actuator, curve_range)]
        )
    return RequestedDesign(plant, actuator, found, curves, told, trace)
