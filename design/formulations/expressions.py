"""Families of problems: their CasADi expressions, built once for each solver."""

from dataclasses import dataclass
from typing import Protocol

from design.types import Symbolic


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
        To be zero, as many as unknowns or fewer.
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
