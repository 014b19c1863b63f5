"""The use cases: one function each, request in, response out. Routes and commands hold no logic."""

import functools
import importlib.metadata
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any, Literal, Protocol

import numpy as np

from design.analysis.judge import DesignWarning, sum_warnings
from design.analysis.residual import residual_vibration
from design.analysis.sensitivity import (
    Sensitivity,
    SensitivityRange,
    sensitivity,
    worst_of,
)
from design.analysis.workable import require_workable
from design.curve_fit.fit import fit
from design.curve_fit.fit_range import plants_at_ends
from design.errors import DesignError, InvalidInputError
from design.fields import Axis
from design.maps.field_map import field_map
from design.maps.map_case import Map, MapCase
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.moves.maneuvers import maneuver
from design.moves.playback import motion
from design.moves.programs import program
from design.moves.shaped_commands import ShapedCommand, shaped_command
from design.pipeline import Design, design
from design.recommendations.recommendation import recommend
from design.sampling.sampled import Sampled
from design.sampling.sampled_design import claims_on_samples, sampled_design
from design.shapers.registry import SHAPERS
from design.solvers.budget import Budget
from design.trace import TraceStep
from design.types import SMALLEST
from schemas.actuators import ActuatorIn
from schemas.base import named
from schemas.catalogue import Catalogue, CatalogueEntry
from schemas.designs import DesignRequest, DesignResponse, RangeOut, SampledOut
from schemas.fits import FitDesign, FitIn, FitOut, FitRequest
from schemas.maneuvers import ManeuverRequest, ManeuverResponse
from schemas.maps import MapRequest, MapResponse
from schemas.plants import PlantIn
from schemas.recommendations import RecommendationRequest, RecommendationResponse
from schemas.sensitivity import ModeOut, SensitivityOut, SensitivityRequest, SensitivityResponse
from schemas.shapers import MODELS, ShaperIn
from schemas.simulations import ImpulsesCommand, SimulationRequest, SimulationResponse
from schemas.trace import TraceStepOut
from schemas.warnings import WarningOut

THESIS_CRANE = {
    "plant": {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81},
    "actuator": {
        "kind": "second_order",
        "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
        "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
    },
}
"""The crane of Kim 2011: the example of the catalogue and of the demo."""

TWO_MODES = {
    "kind": "modes",
    "modes": [
        {"natural_frequency_rad_s": 3.5, "damping_ratio": 0.0},
        {"natural_frequency_rad_s": 9.4, "damping_ratio": 0.02},
    ],
}
"""The example of shapers for several modes."""

EXAMPLE_ACTUATORS = {
    "ideal": {"kind": "ideal"},
    "first_order": {
        "kind": "first_order",
        "accel_time_constant_s": 0.1,
        "decel_time_constant_s": 0.05,
    },
    "second_order": THESIS_CRANE["actuator"],
    "rate_limited": {
        "kind": "rate_limited",
        "accel_limit_m_s2": 30.0,
        "decel_limit_m_s2": 5e4,
        "speed_m_s": 0.2,
        "then": THESIS_CRANE["actuator"],
    },
}

AFTERMATH_PERIODS = 3.0
"""How long a simulation goes on after the last step if no end is given [-]."""

NO_FIT_ON_SAMPLES = "a fit is over times that change smoothly, which whole samples do not"
NO_MOVE_ON_SAMPLES = (
    "a move's distance is met exactly by times between the samples; the field beside shaper gives "
    "its program on samples"
)

PLANTS = ["mode", "modes", "pendulum", "spring_mass", "scheduled"]


@functools.cache
def version() -> str:
    """Return the version of the installed product."""
    return importlib.metadata.version("shapersmith")


def design_shaper(request: DesignRequest) -> DesignResponse:
    """Design one shaper, prove it, and add its curve and its coefficients where asked."""
    done = _designed(request)
    fitted = None
    if request.fit is not None:
        subject = FitDesign(plant=request.plant, actuator=request.actuator, shaper=request.shaper)
        fitted = _fitted(subject, request.fit)
    trace = [TraceStepOut.from_design(step) for step in done.trace]
    return DesignResponse.from_design(
        request.shaper.kind,
        done.design,
        done.sampled,
        SensitivityOut.from_design(worst_of(done.curves)) if done.curves else None,
        _of_modes(done.plant.modes, done.design.residuals, done.curves),
        RangeOut.from_design(done.plant, done.design),
        fitted,
        trace if request.trace else None,
        version(),
    )


def design_file(request: DesignRequest, format_name: str) -> bytes:
    """Design one shaper and return it as a file of a format of tables, a table of one row."""
    from design.export.registry import EXPORTS  # noqa: PLC0415 - answers need none
    from design.export.single import single_table  # noqa: PLC0415
    from design.tables.rows import Subject as Designed  # noqa: PLC0415

    done = _designed(request)
    plant, found = done.plant, done.design
    actuator, kind, options = (
        request.actuator.to_design(),
        request.shaper.registered(),
        request.shaper.options(),
    )
    polynomials = None
    if request.fit is not None:
        polynomials = fit(plant, actuator, kind, request.fit.to_design(request.plant.kind), options)
    head, rows = single_table(
        found,
        Designed(plant=plant, actuator=actuator, kind=kind, options=options),
        request_json=request.canonical(),
        version=version(),
        fit=polynomials,
    )
    export = EXPORTS[format_name]
    export.checks(head)
    return b"".join(export.write(head, [rows]))


def design_picture(request: DesignRequest, image_format: Literal["png", "svg"]) -> bytes:
    """Draw one design, or the search for it where its trace is asked for."""
    from design.pictures.design_sheet import (  # noqa: PLC0415 - matplotlib takes a second
        design_sheet,
        figure_bytes,
    )
    from design.pictures.trace_sheet import trace_sheet  # noqa: PLC0415

    done = _designed(request)
    if request.trace:
        return figure_bytes(trace_sheet(request.shaper.kind, done.trace), image_format)
    modes, actuator, curves = done.plant.modes, request.actuator.to_design(), done.curves
    if not curves:
        usual = SensitivityRange()
        curves = [sensitivity(done.design.impulses, mode, actuator, usual) for mode in modes]
    sheet = design_sheet(request.shaper.kind, modes, actuator, done.design, worst_of(curves))
    return figure_bytes(sheet, image_format)


class Subject(Protocol):
    """A request about a plant and its actuator."""

    @property
    def plant(self) -> PlantIn:
        """What moves."""

    @property
    def actuator(self) -> ActuatorIn:
        """What drives it."""


def _subject(request: Subject) -> tuple[Plant, Actuator]:
    with named("plant"):
        plant = request.plant.to_design()
    with named("actuator"):
        actuator = request.actuator.to_design()
    return plant, actuator


@dataclass(frozen=True, slots=True)
class _Designed:
    """A design with all that was asked of it."""

    plant: Plant
    design: Design
    curves: list[Sensitivity]
    sampled: SampledOut | None
    trace: list[TraceStep]


def _designed(request: DesignRequest) -> _Designed:
    plant, actuator = _subject(request)
    with named("shaper"):
        options = request.shaper.options()
    curve_range = None
    # Every fault of the request is found before the first computation.
    if request.sensitivity is not None:
        with named("sensitivity"):
            curve_range = request.sensitivity.to_design()
    if request.fit is not None:
        with named("shaper"):
            request.shaper.continuous_options(NO_FIT_ON_SAMPLES)
        with named("fit"):
            plants_at_ends(plant, request.fit.to_design(request.plant.kind))
    kind = request.shaper.registered()
    sample_time_s = request.shaper.sample_time_s
    if sample_time_s is not None and isinstance(plant, Modes | Scheduled):
        raise InvalidInputError(
            "shaper.sample_time_s",
            sample_time_s,
            "left out for a plant of several modes or of a range",
        )
    trace: list[TraceStep] = []
    budget = Budget(trace=trace if request.trace else None)
    try:
        found, told = design(plant, actuator, kind, options, budget), None
    except DesignError as error:
        error.trace = tuple(trace)
        raise
    if sample_time_s is not None:
        continuous = found.impulses
        found, sampled = _on_samples(found, plant, actuator, request.shaper, sample_time_s)
        told = SampledOut.from_design(sampled, continuous)
    curves = []
    if curve_range is not None:
        curves = [sensitivity(found.impulses, mode, actuator, curve_range) for mode in plant.modes]
    return _Designed(plant, found, curves, told, trace)


def _of_modes(
    modes: tuple[Mode, ...], residuals: Iterable[float], curves: list[Sensitivity]
) -> list[ModeOut] | None:
    """Return what is left in each of several modes; None for one, of which all else tells."""
    if len(modes) == 1:
        return None
    each = zip_longest(modes, residuals, curves)
    return [ModeOut.from_design(mode, residual, curve) for mode, residual, curve in each]


def sensitivity_curve(request: SensitivityRequest) -> SensitivityResponse:
    """Return the sensitivity curve of any impulses."""
    plant, actuator = _subject(request)
    wanted = request.to_design()
    with named("impulses"):
        impulses = request.impulses.to_design()
    for mode in plant.modes:
        require_workable(mode, actuator)
    curves = [sensitivity(impulses, mode, actuator, wanted) for mode in plant.modes]
    residuals = [residual_vibration(impulses, mode, actuator) for mode in plant.modes]
    return SensitivityResponse(
        sensitivity=SensitivityOut.from_design(worst_of(curves)),
        residual=max(residuals),
        modes=_of_modes(plant.modes, residuals, curves),
        warnings=[WarningOut.from_design(one) for one in sum_warnings(impulses)],
    )


def fit_curves(request: FitRequest) -> FitOut:
    """Return curve coefficients of a shaper over one field of the plant."""
    subject = FitDesign(plant=request.plant, actuator=request.actuator, shaper=request.shaper)
    return _fitted(subject, request.fit)


def _fitted(subject: FitDesign, fit_in: FitIn) -> FitOut:
    plant, actuator = _subject(subject)
    with named("shaper"):
        options = subject.shaper.continuous_options(NO_FIT_ON_SAMPLES)
    with named("fit"):
        wanted = fit_in.to_design(subject.plant.kind)
        ends = plants_at_ends(plant, wanted)
    kind = subject.shaper.registered()
    found = fit(plant, actuator, kind, wanted, options)
    # Polynomials are no better than what they were fitted to.
    ignored = [
        warning
        for end in ends
        for warning in design(end, actuator, kind, options).warnings
        if warning.code == "actuator_ignored"
    ]
    return FitOut.from_design(found, subject, ignored[-1:])


def simulate(request: SimulationRequest) -> SimulationResponse:
    """Play a command, shaped if a shaper is given, and return what happens over time."""
    plant, actuator = _subject(request)
    with named("command"):
        played = request.command.to_design(request.speed_m_s)
    warnings: list[DesignWarning] = []
    if isinstance(request.command, ImpulsesCommand):
        warnings += sum_warnings(played)
    if request.shaper is not None:
        with named("shaper"):
            options = request.shaper.options()
        shaped = _shaped(played, plant, actuator, request.shaper, options)
        played, warnings = shaped.impulses, [*warnings, *shaped.warnings]
    end = request.until_s
    if end is None:
        end = (
            float(played.times_s[-1])
            + actuator.dead_time_s
            + AFTERMATH_PERIODS * plant.mode.period_s
        )
    first = min(0.0, float(played.times_s[0]))
    times = np.linspace(first, max(end, first + SMALLEST), request.points)
    return SimulationResponse.from_design(
        motion(plant, actuator, played, request.speed_m_s, times), played, warnings
    )


def _shaped(
    command: Impulses,
    plant: Plant,
    actuator: Actuator,
    shaper: ShaperIn,
    options: Any,  # noqa: ANN401 - each kind has a record of its own
) -> ShapedCommand:
    found, claims = design(plant, actuator, shaper.registered(), options), None
    if shaper.sample_time_s is not None:
        claims = claims_on_samples(found, shaper.grid_tolerance())
        found, _ = _on_samples(found, plant, actuator, shaper, shaper.sample_time_s)
    return shaped_command(command, found, plant.modes, actuator, claims)


def _found(
    plant: Plant,
    actuator: Actuator,
    shaper: ShaperIn,
    options: Any,  # noqa: ANN401 - each kind has a record of its own
) -> Design:
    """Return a designed shaper, on samples where asked."""
    found = design(plant, actuator, shaper.registered(), options)
    if shaper.sample_time_s is None:
        return found
    return _on_samples(found, plant, actuator, shaper, shaper.sample_time_s)[0]


def _on_samples(
    found: Design, plant: Plant, actuator: Actuator, shaper: ShaperIn, sample_time_s: float
) -> tuple[Design, Sampled]:
    with named("shaper"):
        return sampled_design(
            found, plant.mode, actuator, sample_time_s, tolerance=shaper.grid_tolerance()
        )


def whole_move(request: ManeuverRequest) -> ManeuverResponse:
    """Design a move from rest to rest, and its program where asked."""
    plant, actuator = _subject(request)
    with named("shaper"):
        options = request.shaper.continuous_options(NO_MOVE_ON_SAMPLES)
    initial = None
    if request.initial is not None:
        with named("initial"):
            initial = request.initial.to_design()
    move = maneuver(
        plant,
        actuator,
        request.shaper.registered(),
        speed_m_s=request.speed_m_s,
        pulse_s=request.pulse_s,
        distance_m=request.distance_m,
        initial=initial,
        joint=request.joint,
        options=options,
    )
    played = None
    if request.sample_time_s is not None:
        signed = move.direction * move.speed_m_s
        played = program(
            move.command, plant.mode, actuator, signed, request.sample_time_s, move.swing
        )
    return ManeuverResponse.from_design(request.shaper.kind, move, played, version())


def map_over_fields(request: MapRequest) -> MapResponse:
    """Return what a shaper leaves, or what it is, over one or two fields."""
    case, x, y, found = _mapped(request)
    warnings = sum_warnings(case.shaper) if isinstance(case.shaper, Impulses) else ()
    return MapResponse.from_design(request, x, y, found, warnings)


def map_picture(request: MapRequest, image_format: Literal["png", "svg"]) -> bytes:
    """Draw what a shaper leaves, or what it is, over one or two fields."""
    from design.pictures.design_sheet import figure_bytes  # noqa: PLC0415
    from design.pictures.map_sheet import map_sheet  # noqa: PLC0415

    case, x, y, found = _mapped(request)
    return figure_bytes(map_sheet(case, x, y, found), image_format)


def _mapped(request: MapRequest) -> tuple[MapCase, Axis, Axis | None, Map]:
    plant, actuator = _subject(request)
    with named("x"):
        x = request.x.to_design()
    y = None
    if request.y is not None:
        with named("y"):
            y = request.y.to_design()
    held = None
    shaper = request.shaper
    if shaper is not None and shaper.sample_time_s is not None and request.plainly_held:
        with named("shaper"):
            options = shaper.options()
        held = _found(plant, actuator, shaper, options).impulses
    case = request.to_design(plant, actuator, held)
    return case, x, y, field_map(case, x, y)


def recommend_shaper(request: RecommendationRequest) -> RecommendationResponse:
    """Return the fastest shaper that meets what is asked, its runners-up, and why."""
    plant, actuator = _subject(request)
    found = recommend(plant, actuator, request.to_design())
    return RecommendationResponse.from_design(found, version())


def _richest(kinds: tuple[str, ...]) -> str:
    """Return the last of the actuator kinds that there is an example of."""
    return [kind for kind in kinds if kind in EXAMPLE_ACTUATORS][-1]


def shaper_catalogue() -> Catalogue:
    """Return every kind of shaper, with parameters, example and source."""
    return Catalogue(
        shapers=[
            CatalogueEntry(
                kind=kind.name,
                summary=kind.summary,
                source=kind.source,
                claims=list(kind.claims),
                plants=PLANTS,
                most_modes=kind.most_modes,
                actuators=list(kind.actuators),
                parameters=MODELS[kind.name].model_json_schema(),
                example={
                    "plant": TWO_MODES if kind.serves_several else THESIS_CRANE["plant"],
                    "actuator": EXAMPLE_ACTUATORS[_richest(kind.actuators)],
                    "shaper": {"kind": kind.name},
                },
            )
            for kind in SHAPERS.values()
        ],
        version=version(),
    )
