"""Times of the steps of a move while the cable is hoisted."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp

import numpy as np

from design.analysis.certificate import STEP_PHASE_RAD
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting, LengthCourse
from design.response.closed_form import travel
from design.response.hoisting_kernel import HoistingKernel, hoisting_kernel
from design.response.hoisting_vibration import hoisting_vibration
from design.solvers.budget import Budget
from design.solvers.continuation import follow
from design.solvers.least_squares import least_squares
from design.types import FloatArray

MAX_ITERATIONS = 15
"""Of Newton's method, which converges in four to eight."""

MET = 1e-14, 1e-10, 1e-13
"""What counts as met of the vibration [-], of its slope, by differences [-], and of the way [rad].
Newton's method goes on below it as long as it gains."""

NEARLY_MET = 100.0
"""Of `MET`, up to which rounding may have stopped it; the certificate has the last word [-]."""

MAX_IDLE = 2
"""Iterations without a gain after which it ends."""

DIFFERENCE_RAD = 1e-6
"""Of the phases, for the derivatives by differences [rad]."""

LONGEST_STEP_RAD = 0.4
"""Of the phases in one iteration: farther on, it is another branch [rad]."""

VIBRATION_WORK = 800
"""Work of one vibration vector [units of `design.solvers.budget`]."""

SHORTEST_SHARE = 1 / 512
"""Step of the share of the hoisting below which a path has ended [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class HoistingTask:
    """What the steps of a move have to do.

    Attributes
    ----------
    plant, drive, actuator
        The load on its cable; the drive that the shaper knows, and the one that makes the way.
    derivatives
        How many derivatives of the vibration vanish too, 0 or 1.
    amplitudes
        Of the steps, shape (n,) [-].
    start_steps
        How many of them, from the first on, must leave no vibration by themselves; 0 if only the
        whole must.
    travel_s
        Way of the whole over the speed; None where it follows from the times [s].
    budget
        What the search may do yet; each vibration vector is counted.
    """

    plant: Hoisting
    drive: Actuator
    actuator: Actuator
    derivatives: int
    amplitudes: FloatArray
    start_steps: int
    travel_s: float | None
    budget: Budget

    @cached_property
    def kernels(self) -> tuple[tuple[float, HoistingKernel], ...]:
        """Ratios of all frequencies, and their kernels: 1, then two beside it."""
        return tuple((ratio, hoisting_kernel(self.plant, ratio)) for ratio in self._ratios)

    @property
    def _step(self) -> float:
        return STEP_PHASE_RAD / max(1.0, self.plant.hoisting_turn_rad)

    @property
    def _ratios(self) -> tuple[float, ...]:
        return (1.0,) if not self.derivatives else (1.0, exp(self._step), exp(-self._step))

    @property
    def _parts(self) -> tuple[int, ...]:
        whole = self.amplitudes.size
        return (self.start_steps, whole) if self.start_steps else (whole,)

    @property
    def met(self) -> FloatArray:
        """What counts as met of each of the misses, shape as of `misses`."""
        vibration, slope, way = MET
        of_part = [vibration] * 2 + [slope] * 2 * self.derivatives
        return np.array([*of_part * len(self._parts), *([] if self.travel_s is None else [way])])

    def misses(self, times_s: FloatArray) -> FloatArray:
        """Return what the steps miss of the task, 0 each where they meet it.

        Parameters
        ----------
        times_s
            Of the steps, shape (n,) [s].

        Returns
        -------
        FloatArray
            Parts of the vibration vector and of its derivative, of the start and of the whole [-];
            the way, as a phase of the swing on the last cable [rad].
        """
        self.budget.spend(VIBRATION_WORK * len(self._parts) * len(self.kernels))
        found: list[float] = []
        for count in self._parts:
            command = Impulses(times_s=times_s[:count], amplitudes=self.amplitudes[:count])
            vectors = [
                hoisting_vibration(command, self.plant, self.drive, kernel)
                for _, kernel in self.kernels
            ]
            found += [vectors[0].real, vectors[0].imag]
            if self.derivatives:
                slope = (vectors[1] - vectors[2]) / (2 * self._step)
                found += [slope.real, slope.imag]
        if self.travel_s is not None:
            command = Impulses(times_s=times_s, amplitudes=self.amplitudes)
            w = self.plant.last.mode.natural_frequency_rad_s
            found.append(w * (travel(command, self.actuator) - self.travel_s))
        return np.array(found)

    def with_share(self, share: float, length_m: float) -> "HoistingTask":
        """Return the task with a share of the hoisting about a length.

        Parameters
        ----------
        share, length_m
            What is left of every change from the length [-], [m].

        Returns
        -------
        HoistingTask
            With another course, else the same.
        """
        course = self.plant.cable_length_m
        values = tuple(length_m + share * (one - length_m) for one in course.values)
        moved = LengthCourse(times_s=course.times_s, values=values)
        return replace(self, plant=replace(self.plant, cable_length_m=moved))


Place = Callable[[FloatArray], FloatArray]
"""From the unknown gaps, shape (m,), to the times of all steps, shape (n,) [s]."""


def solve_times(
    task: HoistingTask, gaps_s: FloatArray, place: Place, shortest_s: FloatArray
) -> FloatArray | None:
    """Return the gaps near a guess that meet a task, by Newton's method.

    Parameters
    ----------
    task
        What the steps have to do.
    gaps_s
        The guess, shape (m,) [s].
    place
        What makes times of gaps.
    shortest_s
        Shortest gaps of all steps, shape (n - 1,) [s].

    Returns
    -------
    FloatArray or None
        Shape (m,) [s]; None where the method ends elsewhere or nowhere.
    """
    w = task.plant.last.mode.natural_frequency_rad_s
    now, best, nearest, idle = gaps_s.copy(), gaps_s, np.inf, 0
    for _ in range(MAX_ITERATIONS):
        times_s = place(now)
        if task.budget.spent or not _ordered(times_s, 0 * shortest_s):
            break
        misses = task.misses(times_s)
        distance = float(np.abs(misses / task.met).max())
        idle = 0 if distance < nearest / 2 else idle + 1
        if distance < nearest:
            best, nearest = now, distance
        if nearest <= 1 or idle > MAX_IDLE:
            break
        slopes = np.empty((misses.size, now.size))
        for number in range(now.size):
            moved = now.copy()
            moved[number] += DIFFERENCE_RAD / w
            slopes[:, number] = (task.misses(place(moved)) - misses) / DIFFERENCE_RAD
        step = least_squares(slopes, -misses)
        now = now + step / w * min(1.0, LONGEST_STEP_RAD / max(float(np.abs(step).max()), 1e-300))
    return best if nearest <= NEARLY_MET and _ordered(place(best), shortest_s) else None


def _ordered(times_s: FloatArray, shortest_s: FloatArray) -> bool:
    return bool((np.diff(times_s) > shortest_s).all())


def follow_times(
    task: HoistingTask,
    gaps_s: FloatArray,
    place: Place,
    shortest_s: FloatArray,
    length_m: float,
) -> tuple[FloatArray | None, float]:
    """Follow gaps from a cable that stays to the one that is hoisted.

    Parameters
    ----------
    task, gaps_s, place, shortest_s
        As of `solve_times`; the guess for the cable that stays.
    length_m
        Length of that cable [m].

    Returns
    -------
    FloatArray or None
        Shape (m,) [s]; None where the path ends before.
    float
        Share of the hoisting that it was followed to [-].
    """
    w = task.plant.last.mode.natural_frequency_rad_s

    def solve(phases: FloatArray, share: float) -> FloatArray | None:
        part = task if share == 1 else task.with_share(share, length_m)
        found = solve_times(part, phases / w, place, shortest_s)
        return None if found is None else w * found

    at_first = solve(w * gaps_s, 0.0)
    if at_first is None:
        return None, 0.0
    path = follow(at_first, solve, SHORTEST_SHARE)
    return (path.unknowns / w if path.complete else None), path.share
