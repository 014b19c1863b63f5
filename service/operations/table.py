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
    description
        What the route answers, for the documentation.
    tag
        Group of routes that it is in.
    command
        Its name on the command line, and the route's operation id.
    help
        Help of the command.
    """

    path: str
    summary: str
    description: str
    tag: str
    command: str
    help: str


TABLE: dict[str, Row] = {
    "design": Row(
        "/v1/designs",
        "Design one shaper, prove it, add its sensitivity curve and curve coefficients",
        "The shaper is solved for the plant and the actuator. Its certificate recomputes each "
        "promise without the solver. A design that breaks a promise is never returned. Equal "
        "requests get equal bytes.",
        "designs",
        "design",
        "design one shaper, prove it",
    ),
    "sensitivity": Row(
        "/v1/sensitivity",
        "Sensitivity curve and insensitivity of any impulses",
        "The residual is computed at each ratio of the true frequency to the plant's. The impulses "
        "may come from any source.",
        "analysis",
        "sensitivity",
        "sensitivity curve of any impulses",
    ),
    "fit": Row(
        "/v1/fits",
        "Curve coefficients of a shaper over one field, and the residual of the fitted times",
        "Polynomials give the times of the shaper over a range of one field. A controller that "
        "knows the field evaluates them in place of a solver. The residual of the fitted times is "
        "checked over the range.",
        "designs",
        "fit",
        "curve coefficients over a field of the plant",
    ),
    "maneuver": Row(
        "/v1/maneuvers",
        "A whole move from rest to rest over an exact distance, proven as a whole",
        "The move is given by its distance or by the time from its start to its stop. With "
        "sample_time_s, the answer has a program that a controller replays.",
        "moves",
        "maneuver",
        "a whole move from rest to rest",
    ),
    "simulation": Row(
        "/v1/simulations",
        "Response of plant and actuator to a command, shaped or not, exact at each time",
        "Each value is computed in closed form. No step size is involved.",
        "moves",
        "simulate",
        "response to a command over time",
    ),
    "run": Row(
        "/v1/runs",
        "The crane driven by events: presses, moves, hoists and played courses",
        "The crane is integrated through every event, with swings small or as large as they are. "
        "Strokes, limit switches and speeds are those of the machine. Commands go to the drives "
        "as they are, or through a shaper in a delay line.",
        "moves",
        "run",
        "the crane driven by events",
    ),
    "map": Row(
        "/v1/maps",
        "Residual, times or gains of a shaper or a whole move over one or two fields",
        "The shaper is held, or designed anew in each cell. A cell without a shaper is null.",
        "analysis",
        "map",
        "residual, times or gains over one or two fields",
    ),
    "recommendation": Row(
        "/v1/recommendations",
        "The fastest shaper that meets what is required, with the runners-up and reasons",
        "Every kind of shaper is designed with parameters that suit, and judged over the whole "
        "band. Where none meets all, the refusal names the nearest limits.",
        "designs",
        "recommend",
        "the fastest shaper that meets what is required",
    ),
}


@cache
def load(name: str) -> "Operation":
    """Return an operation; its module is imported at first use."""
    found: Operation = import_module(f"service.operations.{name}").OPERATION
    return found
