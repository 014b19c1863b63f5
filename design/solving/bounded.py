"""An optimum with its bound: a command, and a proof of how short none of its class is.

The command is its solver's. The bound is proved apart from it, for all times.
"""

from dataclasses import dataclass

from design.model.impulses import Impulses
from design.solvers.solution import Solution, SolverReport
from design.solving.distinct_steps import distinct_steps
from design.types import FloatArray

SMALL_GAP = 1e-4
"""Gap at which the search ends: far below what a controller's clock can tell [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bounded:
    """A command, and how much faster one could be at most.

    Attributes
    ----------
    times_rad
        Times of its impulses, shape (n,) [rad].
    amplitudes
        Their amplitudes, shape (n,) [-].
    lower_bound_rad
        No command of its class is as short as this or shorter [rad].
    gap
        How far its duration may be above the shortest, over itself [-].
    iterations
        Steps of Newton's method.
    programs
        Cone or linear programs that led to it.
    """

    times_rad: FloatArray
    amplitudes: FloatArray
    lower_bound_rad: float
    gap: float
    iterations: int
    programs: int

    def solution(self, natural_frequency_rad_s: float, *, name: str, seed: str) -> Solution:
        """Return it in seconds.

        Parameters
        ----------
        natural_frequency_rad_s
            Turns phases into times [rad/s].
        name
            What solved the programs.
        seed
            Name of its start.

        Returns
        -------
        Solution
            With its lower bound in seconds.
        """
        return Solution(
            impulses=distinct_steps(
                Impulses(
                    times_s=self.times_rad / natural_frequency_rad_s, amplitudes=self.amplitudes
                )
            ),
            solver=SolverReport(
                name=name,
                status="solve_succeeded",
                iterations=self.iterations,
                seed=seed,
                starts=self.programs,
                lower_bound_s=self.lower_bound_rad / natural_frequency_rad_s,
                gap=self.gap,
            ),
        )
