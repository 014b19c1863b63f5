"""Design one shaper, prove it, and add what is asked: its curve, its coefficients, its file."""

from dataclasses import dataclass
from typing import Literal

from design.analysis.sensitivity import (
    Sensitivity,
    SensitivityRange,
    sensitivity,
    worst_of,
)
from design.curve_fit.fit import fit
from design.curve_fit.fit_range import plants_at_ends
from design.errors import DesignError, InvalidInputError
from design.model.plants.modes import Modes
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.pipeline import Design, design
from design.solvers.budget import Budget
from design.trace import TraceStep
from schemas.base import name_field
from schemas.designs import DesignRequest, DesignResponse, RangeOut, SampledOut
from schemas.fits import FitDesign
from schemas.sensitivity import SensitivityOut
from schemas.trace import TraceStepOut
from service.operations.fit import fit_with_residual
from service.operations.operation import Operation
from service.operations.subject import (
    NO_FIT_ON_SAMPLES,
    of_modes,
    on_samples,
    subject_of,
)
from service.version import version


def design_shaper(request: DesignRequest) -> DesignResponse:
    """Design one shaper and prove it.

    Parameters
    ----------
    request
        The plant, the actuator and the shaper; whether its curve, coefficients and trace too.

    Returns
    -------
    DesignResponse
        The shaper with its certificate, and all that was asked for.

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
    done = _make_design(request)
    fits = None
    if request.fit is not None:
        subject = FitDesign(plant=request.plant, actuator=request.actuator, shaper=request.shaper)
        fits = fit_with_residual(subject, request.fit)
    trace = [TraceStepOut.from_design(step) for step in done.trace]
    return DesignResponse.from_design(
        request.shaper.kind,
        done.design,
        done.sampled,
        SensitivityOut.from_design(worst_of(done.curves)) if done.curves else None,
        of_modes(done.plant.modes, done.design.residuals, done.curves),
        RangeOut.from_design(done.plant, done.design),
        fits,
        trace if request.trace else None,
        version(),
    )


def design_file(request: DesignRequest, format_name: str) -> bytes:
    """Design one shaper and return it as a file, a table of one row.

    Parameters
    ----------
    request
        The plant, the actuator and the shaper.
    format_name
        Name of a format that a single design can be written in.

    Returns
    -------
    bytes
        The file.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the format does not take the shaper.
    InfeasibleDesignError
        If no such shaper was found.
    SolverFailedError
        If none of the solutions found was verified.
    TimeLimitError
        If a solver ran past its time.
    """
    from design.export.registry import EXPORTS  # noqa: PLC0415 - answers need none
    from design.export.single import single_table  # noqa: PLC0415
    from design.tables.rows import Subject as Designed  # noqa: PLC0415

    done = _make_design(request)
    plant, found = done.plant, done.design
    actuator, kind, options = (
        request.actuator.to_design(),
        request.shaper.shaper_kind(),
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
    """Draw one design, or the search for it where its trace is asked for.

    Parameters
    ----------
    request
        The plant, the actuator and the shaper.
    image_format
        Format of the picture.

    Returns
    -------
    bytes
        The picture.

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
    from design.pictures.design_sheet import (  # noqa: PLC0415 - matplotlib takes a second
        design_sheet,
        figure_bytes,
    )
    from design.pictures.trace_sheet import trace_sheet  # noqa: PLC0415

    done = _make_design(request)
    if request.trace:
        return figure_bytes(trace_sheet(request.shaper.kind, done.trace), image_format)
    modes, actuator, curves = done.plant.modes, request.actuator.to_design(), done.curves
    if not curves:
        usual = SensitivityRange()
        curves = [sensitivity(done.design.impulses, mode, actuator, usual) for mode in modes]
    sheet = design_sheet(request.shaper.kind, modes, actuator, done.design, worst_of(curves))
    return figure_bytes(sheet, image_format)


@dataclass(frozen=True, slots=True)
class _Designed:
    """A design with all that was asked of it."""

    plant: Plant
    design: Design
    curves: list[Sensitivity]
    sampled: SampledOut | None
    trace: list[TraceStep]


def _make_design(request: DesignRequest) -> _Designed:
    plant, actuator = subject_of(request)
    with name_field("shaper"):
        options = request.shaper.options()
    curve_range = None
    # Every fault of the request is found before the first computation.
    if request.sensitivity is not None:
        with name_field("sensitivity"):
            curve_range = request.sensitivity.to_design()
    if request.fit is not None:
        with name_field("shaper"):
            request.shaper.continuous_options(NO_FIT_ON_SAMPLES)
        with name_field("fit"):
            plants_at_ends(plant, request.fit.to_design(request.plant.kind))
    kind = request.shaper.shaper_kind()
    sample_time_s = request.shaper.sample_time_s
    if sample_time_s is not None and isinstance(plant, Modes | Scheduled):
        raise InvalidInputError(
            "shaper.sample_time_s",
            sample_time_s,
            "left out for a plant of several modes or of a range",
            code="samples_of_one_mode",
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
        found, sampled = on_samples(found, plant, actuator, request.shaper, sample_time_s)
        told = SampledOut.from_design(sampled, continuous)
    curves = []
    if curve_range is not None:
        curves = [sensitivity(found.impulses, mode, actuator, curve_range) for mode in plant.modes]
    return _Designed(plant, found, curves, told, trace)


OPERATION = Operation(
    request=DesignRequest, response=DesignResponse, run=design_shaper, draw=design_picture
)
