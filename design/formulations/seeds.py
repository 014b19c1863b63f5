"""Where a search starts, and what is unknown beside the gaps."""

import functools
from dataclasses import dataclass, field

import numpy as np

from design.types import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Seed:
    """Where to start."""

    name: str  # As reported with the answer
    gaps_rad: FloatArray  # Gaps between the impulses, shape (n - 1,) [rad]
    # Parameters of the family that they solve, shape (p,), to be followed from there to those
    # asked; None for a start from which a solver goes straight
    solves: FloatArray | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ratios:
    """Frequency ratios that are unknown beside the gaps: none if nothing is said."""

    # Their bounds, shape (r,) [-]
    lowest: FloatArray = field(default_factory=functools.partial(np.zeros, 0))
    highest: FloatArray = field(default_factory=functools.partial(np.zeros, 0))
    # Where every start has them, shape (r,) [-]
    usual: FloatArray = field(default_factory=functools.partial(np.zeros, 0))
