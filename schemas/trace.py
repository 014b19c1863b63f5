"""Wire form of a search that was watched."""

from typing import Annotated, Literal, Self

from pydantic import Field

from design.trace import TraceStep
from schemas.base import Wire


class TraceStepOut(Wire):
    """One step of the search."""

    stage: Annotated[
        Literal["seed", "solve", "bound", "certify"],
        Field(
            description="seed: looked for a start; solve: solved from a start; bound: proved a "
            "duration that no shaper reaches; certify: held a solution against its "
            "promises."
        ),
    ]
    method: Annotated[
        str, Field(description="Method of the step, such as newton, ipopt, certificate.")
    ]
    start: Annotated[str, Field(description="Name of the seed or other start.")]
    outcome: Annotated[
        str, Field(description="Outcome of the step, such as solve_succeeded, verified, rejected.")
    ]
    iterations: Annotated[int, Field(description="Iterations of the step.")]
    duration_s: Annotated[
        float | None,
        Field(description="Duration of the command found; null where none was [s]."),
    ]
    misses: Annotated[
        list[float],
        Field(description="By how much the equations were off, iteration by iteration."),
    ]
    detail: Annotated[str, Field(description="The step in words.")]

    @classmethod
    def from_design(cls, step: TraceStep) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            stage=step.stage,
            method=step.method,
            start=step.start,
            outcome=step.outcome,
            iterations=step.iterations,
            duration_s=step.duration_s,
            misses=list(step.misses),
            detail=step.detail,
        )
