"""Wire form of how impulses were found."""

from typing import Annotated

from pydantic import Field

from design.solvers.solution import SolverReport
from schemas.base import OutOf


class SolverOut(OutOf[SolverReport]):
    """How the impulses were found."""

    name: Annotated[str, Field(description="Name of the solver, or of the formula.")]
    status: Annotated[str, Field(description="Outcome, in the solver's own words.")]
    iterations: Annotated[int, Field(description="Iterations of the solver.")]
    seed: Annotated[str, Field(description="Start from which the solution was found.")]
    starts: Annotated[int, Field(description="Number of starts that were tried.")]
    lower_bound_s: Annotated[
        float | None,
        Field(
            description="No shaper of its class is as short as this; behind limits, none ends its "
            "last ramp as early; null where nothing is proven [s]."
        ),
    ]
    gap: Annotated[
        float | None,
        Field(description="(duration - lower bound) / duration; null where nothing is proven [-]."),
    ]
