"""One design as a picture."""

from typing import TYPE_CHECKING

from design.analysis.large_swing_sensitivity import large_swing_sensitivity
from design.analysis.sensitivity import SensitivityRange, sensitivity
from schemas.design_request import DesignRequest
from service.operations.requested_design import requested_design
from service.version import version

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def design_picture(request: DesignRequest) -> "Figure":
    """Draw one design, or the search for it where its trace is asked for.

    Parameters
    ----------
    request
        The plant, the actuator and the shaper.

    Returns
    -------
    Figure
        The sheet of the design, or of its search.

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
    from design.pictures.design_sheet import design_sheet  # noqa: PLC0415 - matplotlib takes a second
    from design.pictures.trace_sheet import trace_sheet  # noqa: PLC0415

    done = requested_design(request)
    if request.trace:
        return trace_sheet(request.shaper.kind, done.trace)
    curves = done.curves
    if not curves:
        usual, impulses, swing = SensitivityRange(), done.design.impulses, done.design.large_swing
        curves = (
            [sensitivity(impulses, mode, done.actuator, usual) for mode in done.plant.modes]
            if swing is None
            else [large_swing_sensitivity(impulses, swing.swing, done.actuator, usual)]
        )
    return design_sheet(
        request.shaper.kind, done.plant, done.actuator, done.design, curves, version()
    )
