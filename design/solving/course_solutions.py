"""A course behind limits as the command that it follows, with the bound of its end."""

from typing import Protocol

import numpy as np

from design.model.impulses import Impulses
from design.solvers.solution import Solution, SolverReport
from design.solving.distinct_steps import distinct_steps
from design.types import FloatArray


class Switched(Protocol):
    """A course that an on-off command makes."""

    @property
    def switches(self) -> FloatArray:
        """Changes of the command, up first, ascending from 0, shape (n,) [rad]."""


class Optimum(Protocol):
    """A course that a search found, and how."""

    @property
    def course(self) -> Switched:
        """The course."""

    @property
    def end(self) -> float:
        """When its last ramp ends [rad]."""

    @property
    def iterations(self) -> int:
        """Steps of Newton's method."""

    @property
    def programs(self) -> int:
        """Programs over a grid until then."""

    @property
    def seed(self) -> str:
        """Name of its start."""


def solution_of(
    found: Optimum, natural_frequency_rad_s: float, name: str, bound_rad: float | None = None
) -> Solution:
    """Return a course as the command that it follows.

    Parameters
    ----------
    found
        The course.
    natural_frequency_rad_s
        Turns phases into times [rad/s].
    name
        What solved its programs.
    bound_rad
        An end before which there is none [rad]; None where none is proven.

    Returns
    -------
    Solution
        Steps up and down in turn.
    """
    w, switches = natural_frequency_rad_s, found.course.switches
    steps = np.where(np.arange(switches.size) % 2 == 0, 1.0, -1.0)
    return Solution(
        impulses=distinct_steps(Impulses(times_s=switches / w, amplitudes=steps)),
        solver=SolverReport(
            name=name,
            status="solve_succeeded",
            iterations=found.iterations,
            seed=found.seed,
            starts=found.programs,
            lower_bound_s=None if bound_rad is None else bound_rad / w,
            gap=None if bound_rad is None else 1 - bound_rad / found.end,
        ),
    )
