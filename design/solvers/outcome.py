"""What a solver says of its run."""

from dataclasses import dataclass
from enum import StrEnum

from design.types import FloatArray


class Status(StrEnum):
    """How a run ended; every vendor's words are translated to these."""

    SOLVE_SUCCEEDED = "solve_succeeded"
    INFEASIBLE = "infeasible"
    TIME_LIMIT = "time_limit"
    FAILED = "failed"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outcome:
    """The end of one run.

    Attributes
    ----------
    status
        How it ended.
    unknowns
        Where, shape (n,); an answer only if the status says so.
    iterations
        Iterations taken.
    misses
        By how much the equations were off, iteration by iteration, where the solver reports it.
    """

    status: Status
    unknowns: FloatArray
    iterations: int
    misses: tuple[float, ...] = ()
