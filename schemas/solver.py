"""Wire form of how impulses were found."""

from typing import Annotated

from pydantic import Field

from design.solvers.solution import SolverReport
from schemas.base import OutOf


class SolverOut(OutOf[SolverReport]):
    """How the impulses were found."""

    name: str
    status: str
    iterations: int
    seed: str
    starts: int
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
