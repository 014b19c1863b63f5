"""One design as a file, a table of one row."""

from typing import TYPE_CHECKING

from design.curve_fit.fit import fit
from schemas.design_request import DesignRequest
from schemas.samples import grid_of
from service.operations.requested_design import requested_design
from service.version import version

if TYPE_CHECKING:
    from design.tables.rows import Real


def design_file(request: DesignRequest, format_name: str, real: "Real" = "LREAL") -> bytes:
    """Design one shaper and return it as a file, a table of one row.

    Parameters
    ----------
    request
        The plant, the actuator and the shaper.
    format_name
        Name of a format that a single design can be written in.
    real
        Type of numbers in Structured Text.

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

    done = requested_design(request)
    plant, found = done.plant, done.design
    actuator, kind, options, grid = (
        request.actuator.to_design(),
        request.shaper.shaper_kind(),
        request.shaper.options(),
        grid_of(request.shaper),
    )
    polynomials = None
    if request.fit is not None:
        polynomials = fit(plant, actuator, kind, request.fit.to_design(request.plant.kind), options)
    head, rows = single_table(
        found,
        Designed(plant=plant, actuator=actuator, kind=kind, options=options, grid=grid),
        request_json=request.canonical(),
        version=version(),
        fit=polynomials,
        real=real,
    )
    export = EXPORTS[format_name]
    export.checks(head)
    return b"".join(export.write(head, [rows]))
