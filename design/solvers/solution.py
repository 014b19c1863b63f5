"""What every solver answers with: impulses, and how they were found."""

from dataclasses import dataclass, field

import numpy as np

from design.model.impulses import Impulses
from design.types import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverReport:
    """How the impulses were found.

    Attributes
    ----------
    name
        ``ipopt``, ``clarabel``, ``highs``, ``slsqp``, ``closed_form``, or ``newton``: from a
        closed form or from many starts.
    status
        How the run ended.
    iterations
        Iterations of the run that led to the design.
    seed
        Name of its start.
    starts
        Starts tried until then; cone or linear programs of ``clarabel`` and ``highs``.
    lower_bound_s
        No shaper of its class is as short, or behind limits ends its last ramp as early: proven for
        all times; None where nothing is proven [s].
    gap
        How far the duration may be above the shortest, over itself; None as above [-].
    """

    name: str
    status: str
    iterations: int
    seed: str
    starts: int
    lower_bound_s: float | None = None
    gap: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solution:
    """What solves a formulation, as reported by its solver: not yet certified.

    Attributes
    ----------
    impulses
        The shaper.
    solver
        How it was found.
    ratios
        Where its curve has zeros and peaks, if they were unknown too, shape (r,) [-].
    """

    impulses: Impulses
    solver: SolverReport
    ratios: FloatArray = field(default_factory=lambda: np.zeros(0))
