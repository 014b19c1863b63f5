"""What a search did, step by step, for those who want to watch it."""

from dataclasses import dataclass
from typing import Literal

Stage = Literal["seed", "solve", "bound", "certify"]
"""``seed`` looks for a start, ``solve`` solves from one, ``bound`` proves how short none is,
``certify`` holds a solution against its promises."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TraceStep:
    """One step of a search.

    Attributes
    ----------
    stage
        What the step was for.
    method
        What did it: ``newton``, ``ipopt``, ``clarabel``, ``highs``, ``closed_form``,
        ``certificate`` and the like.
    start
        Name of the seed or of what else it began with.
    outcome
        How it ended, in a word: ``solve_succeeded``, ``verified``, ``rejected`` and the like.
    iterations
        Iterations that it took.
    duration_s
        Duration of the command that it ended with, or that it tried; None without one [s].
    misses
        By how much the equations were off, iteration by iteration, where the solver reports it.
    detail
        What else is to be known: why a solution was rejected.
    """

    stage: Stage
    method: str
    start: str
    outcome: str
    iterations: int = 0
    duration_s: float | None = None
    misses: tuple[float, ...] = ()
    detail: str = ""
