"""Equations in the gaps between impulses, to be solved in least time."""

from dataclasses import dataclass, field

import numpy as np

from design.claims import Promise
from design.formulations.expressions import Model
from design.formulations.seeds import Ratios, Seed
from design.model.actuators.registry import Actuator
from design.types import BoolArray, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GapProblem:
    """A minimum-time problem over the gaps between impulses."""

    model: Model  # The family
    parameters: FloatArray  # Its parameters, shape (p,)
    amplitudes: FloatArray  # Amplitudes of the impulses, shape (n,) [-]
    natural_frequency_rad_s: float  # Turns the gaps into times [rad/s]
    # Lower bounds of the gaps, shape (n - 1,), > 0: the impulses keep their order [rad]
    shortest_gaps_rad: FloatArray
    horizon_rad: float  # Longest duration [rad]
    seeds: tuple[Seed, ...]  # Starts in order of preference
    # The actuator of the claims: an ideal one for shapers that know no actuator
    designed_for: Actuator
    # What the impulses keep; none stands for the claims of the kind, each at its zero
    claims: tuple[Promise, ...] = ()
    # What is unknown beside the gaps: where the curve has its zeros and peaks
    ratios: Ratios = field(default_factory=Ratios)
    # The same with more steps, the fewest first: tried where this has no solution
    longer: tuple["GapProblem", ...] = ()

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest values of all unknowns, shape (n - 1 + r,) each."""
        latest = np.full(self.shortest_gaps_rad.size, self.horizon_rad)
        return (
            np.concatenate((self.shortest_gaps_rad, self.ratios.lowest)),
            np.concatenate((latest, self.ratios.highest)),
        )

    def split(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the gaps, shape (..., n - 1), and ratios, shape (..., r)."""
        count = self.shortest_gaps_rad.size
        return unknowns[..., :count], unknowns[..., count:]

    def start(self, gaps_rad: FloatArray) -> FloatArray:
        """Return unknowns to start from, shape (..., n - 1 + r)."""
        usual = np.broadcast_to(self.ratios.usual, (*gaps_rad.shape[:-1], self.ratios.usual.size))
        return np.concatenate((gaps_rad, usual), axis=-1)

    def allows(self, unknowns: FloatArray) -> BoolArray:
        """Return whether unknowns are within bounds and horizon, shape (...)."""
        lowest, highest = self.bounds
        within = ((unknowns >= lowest) & (unknowns <= highest)).all(axis=-1)
        # Of what ran away the sum may be none.
        gaps, _ = self.split(np.clip(unknowns, lowest, highest))
        allowed: BoolArray = within & (gaps.sum(axis=-1) <= self.horizon_rad)
        return allowed
