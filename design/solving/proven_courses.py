"""Courses behind limits with what is proven of them: the first that a bound shows to be optimal."""

from collections.abc import Callable, Iterator
from typing import Protocol, TypeVar

from design.solvers.budget import Budget
from design.solving.bounded import SMALL_GAP
from design.trace import TraceStep


class Ended(Protocol):
    """An optimum of any search behind limits."""

    @property
    def end(self) -> float:
        """When its last ramp ends [rad]."""

    @property
    def seed(self) -> str:
        """Name of its start."""


Course = TypeVar("Course", bound=Ended)


def proven(
    candidates: Iterator[Course],
    excluded_rad: Callable[[Course], float],
    natural_frequency_rad_s: float,
    budget: Budget,
) -> Iterator[tuple[Course, float]]:
    """Yield optima that their bound proves; the best at last, if none is.

    Parameters
    ----------
    candidates
        Courses that may be optimal.
    excluded_rad
        An end before which a candidate proves that there is none [rad].
    natural_frequency_rad_s
        Turns phases into times [rad/s].
    budget
        That of the search, which notes the proofs.

    Yields
    ------
    tuple of Course and float
        An optimum, and an end before which there is none [rad].
    """
    best: Course | None = None
    bound = 0.0  # each proof is about the problem, whatever the course that led to it
    for found in candidates:
        bound = max(bound, excluded_rad(found))
        budget.note(
            TraceStep(
                stage="bound",
                method="proof",
                start=found.seed,
                outcome="proved",
                duration_s=bound / natural_frequency_rad_s,
                detail="no reference within the limits ends as early",
            )
        )
        if best is None or found.end < best.end:
            best = found
        if bound >= (1 - SMALL_GAP) * best.end:
            yield best, bound
            best = None
    if best is not None:
        yield best, bound
