"""Every operation: a row is its route, its command and their documentation.

One more: write its module beside this one, with an ``OPERATION``, then add its row. Rows name their
modules, and import none of them: the command line reads this table before it prints its help.
"""

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from service.operations.operation import Operation


class Row(NamedTuple):
    """One operation, by the name of its module; no dataclass, as in `design.export.formats`.

    Attributes
    ----------
    path
        Its route.
    summary
        Summary of the route.
    command
        Its name on the command line.
    help
        Help of the command.
    drawn
        Whether its answer can be drawn.
    """

    path: str
    summary: str
    command: str
    help: str
    drawn: bool = False


TABLE: dict[str, Row] = {
    "design": Row(
        "/v1/designs",
        "Design one shaper, prove it, add its sensitivity curve and curve coefficients",
        "design",
        "design one shaper, prove it",
        drawn=True,
    ),
    "sensitivity": Row(
        "/v1/sensitivity",
        "Sensitivity curve and insensitivity of any impulses",
        "sensitivity",
        "sensitivity curve of any impulses",
    ),
    "fit": Row(
        "/v1/fits",
        "Curve coefficients of a shaper over one field, and the residual of the fitted times",
        "fit",
        "curve coefficients over a field of the plant",
    ),
    "maneuver": Row(
        "/v1/maneuvers",
        "A whole move from rest to rest over an exact distance, proven as a whole",
        "maneuver",
        "a whole move from rest to rest",
        drawn=True,
    ),
    "simulation": Row(
        "/v1/simulations",
        "Response of plant and actuator to a command, shaped or not, exact at each time",
        "simulate",
        "response to a command over time",
    ),
    "map": Row(
        "/v1/maps",
        "Residual, times or gains of a shaper or a whole move over one or two fields",
        "map",
        "residual, times or gains over one or two fields",
        drawn=True,
    ),
    "recommendation": Row(
        "/v1/recommendations",
        "The fastest shaper that meets what is required, with the runners-up and reasons",
        "recommend",
        "the fastest shaper that meets what is required",
    ),
}


@cache
def load(name: str) -> "Operation":
    """Return an operation; its module is imported at first use."""
    found: Operation = import_module(f"service.operations.{name}").OPERATION
    return found
