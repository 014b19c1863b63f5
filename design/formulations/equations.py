"""Equations in the gaps between impulses, to be solved in least time."""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.types import BoolArray, FloatArray, Symbolic


@dataclass(frozen=True, slots=True, kw_only=True)
class Expressions:
    """CasADi expressions of a problem, all dimensionless.

    Attributes
    ----------
    unknowns
        Gaps between the impulses times the plant's natural frequency, shape (n - 1,) [rad], then
        ratios of frequencies, if any are unknown too, shape (r,) [-].
    parameters
        What differs from one design to the next, shape (p,).
    objective
        To be minimised: the duration [rad].
    equations
        To be zero, as many as unknowns.
    """

    unknowns: Symbolic
    parameters: Symbolic
    objective: Symbolic
    equations: Symbolic


class Model(Protocol):
    """A family of problems that differ in parameters only. Hashable: solvers build each once."""

    def __hash__(self) -> int:
        """Models are keys of the solvers' caches."""

    def expressions(self) -> Expressions:
        """Build the expressions."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Seed:
    """Where to start.

    Attributes
    ----------
    name
        As reported with the answer.
    gaps_rad
        Gaps between the impulses, shape (n - 1,) [rad].
    solves
        Parameters of the family that they solve, shape (p,), to be followed from there to those
        asked; None for a start from which a solver goes straight.
    """

    name: str
    gaps_rad: FloatArray
    solves: FloatArray | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ratios:
    """Frequency ratios that are unknown beside the gaps: none if nothing is said.

    Attributes
    ----------
    lowest, highest
        Their bounds, shape (r,) [-].
    usual
        Where every start has them, shape (r,) [-].
    """

    lowest: FloatArray = field(default_factory=lambda: np.zeros(0))
    highest: FloatArray = field(default_factory=lambda: np.zeros(0))
    usual: FloatArray = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GapProblem:
    """A minimum-time problem over the gaps between impulses.

    Attributes
    ----------
    model
        The family.
    parameters
        Its parameters, shape (p,).
    amplitudes
        Amplitudes of the impulses, shape (n,) [-].
    natural_frequency_rad_s
        Turns the gaps into times [rad/s].
    shortest_gaps_rad
        Lower bounds of the gaps, shape (n - 1,), > 0: the impulses keep their order [rad].
    horizon_rad
        Longest duration [rad].
    seeds
        Starts in order of preference.
    designed_for
        The actuator of the claims: an ideal one for shapers that know no actuator.
    claims
        What the impulses keep; none stands for the claims of the kind, each at its zero.
    ratios
        What is unknown beside the gaps: where the curve has its zeros and peaks.
    """

    model: Model
    parameters: FloatArray
    amplitudes: FloatArray
    natural_frequency_rad_s: float
    shortest_gaps_rad: FloatArray
    horizon_rad: float
    seeds: tuple[Seed, ...]
    designed_for: Actuator
    claims: tuple[Promise, ...] = ()
    ratios: Ratios = field(default_factory=Ratios)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest values of all unknowns, shape (n - 1 + r,) each."""
        latest = np.full(self.shortest_gaps_rad.size, self.horizon_rad)
        return (
            np.concatenate((self.shortest_gaps_rad, self.ratios.lowest)),
            np.concatenate((latest, self.ratios.highest)),
        )

    def split(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the gaps and the ratios of unknowns.

        Parameters
        ----------
        unknowns
            Shape (..., n - 1 + r) [rad], [-].

        Returns
        -------
        FloatArray
            Gaps, shape (..., n - 1) [rad].
        FloatArray
            Ratios, shape (..., r) [-].
        """
        count = self.shortest_gaps_rad.size
        return unknowns[..., :count], unknowns[..., count:]

    def start(self, gaps_rad: FloatArray) -> FloatArray:
        """Return unknowns to start from: gaps, and the usual ratios.

        Parameters
        ----------
        gaps_rad
            Shape (..., n - 1) [rad].

        Returns
        -------
        FloatArray
            Shape (..., n - 1 + r) [rad], [-].
        """
        usual = np.broadcast_to(self.ratios.usual, (*gaps_rad.shape[:-1], self.ratios.usual.size))
        return np.concatenate((gaps_rad, usual), axis=-1)

    def allows(self, unknowns: FloatArray) -> BoolArray:
        """Return whether unknowns are within bounds and horizon.

        Parameters
        ----------
        unknowns
            Shape (..., n - 1 + r) [rad], [-].

        Returns
        -------
        BoolArray
            Shape (...).
        """
        lowest, highest = self.bounds
        within = ((unknowns >= lowest) & (unknowns <= highest)).all(axis=-1)
        # Of what ran away the sum may be none.
        gaps, _ = self.split(np.clip(unknowns, lowest, highest))
        allowed: BoolArray = within & (gaps.sum(axis=-1) <= self.horizon_rad)
        return allowed
