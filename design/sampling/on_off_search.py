"""The shortest command of level 0 or 1 within a tolerance on samples, or of least residual.

Searched are commands of more and more samples, each number of them completely where the budget of
counted work allows it; the outcome says up to where, and what the residual there is at least.
"""

import itertools
from dataclasses import dataclass, replace

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.sampling.every_command import (
    COMPARED_ONE_BY_ONE,
    MAX_LISTED_SAMPLES,
    all_levels,
    is_listed_exactly,
    left_of_levels,
    samples_of,
)
from design.sampling.left import TIE
from design.sampling.on_off_lists import Steps, commands_within, steps_of
from design.sampling.sample_grid import AnyIntArray
from design.solvers.budget import Budget
from design.types import FloatArray

MAX_SEARCHED_SAMPLES = 400
"""Longest command that is searched; on finer grids a shaper's own impulses leave little [-]."""

WORK_PER_SEARCH, WORK_PER_LISTS = 1_200_000, 400_000
"""Work of one search, about a second, and of one behind a drive whose steps do not add, which
`more_impulses` may follow [units of `design.solvers.budget`]."""

MAX_UNPRUNED_SAMPLES = 36
"""Samples up to which all halves can be listed [-]."""

FIRST_NET, WIDER = 1e-4, 4.0
"""Finest net cast for commands, and how much wider the next is [-]."""

WORK_PER_STEPS = {False: 30.0, True: 250.0}
"""Work per sample of the reach of steps, without and with the slope."""

WORK_PER_LISTED, WORK_PER_RAMP, WORK_ONE_BY_ONE = 1.0, 0.35, 800.0
"""Work per sample of each command whose sum of steps has no halves, switched or of ramps, and of
one by itself."""

COARSE_POSITIONS, LIKELY, LIKELY_NET = 10, 100, 0.05
"""On more samples all commands on so many positions are compared, and so many that would leave at
most that if steps added [-]."""

BEGUN, WORTH_MOVING = 2, 3.0
"""The best of those are moved, so many of them, that leave at most so much more than is known."""

PROBED = 8
"""Numbers of samples of which some commands are looked at when the budget is spent [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Searched:
    """What a search of commands on samples found.

    Attributes
    ----------
    samples
        Of the steps of the best command; None where none has less than was known.
    left
        Its residual, slope included where it counts [-].
    searched
        Every command of up to so many samples was searched.
    complete
        Whether those are all of as many samples as the best command has, where that is within the
        tolerance, else all that were to be searched.
    bound
        What commands of up to ``searched`` samples have at least, proven [-].
    """

    samples: AnyIntArray | None
    left: float
    searched: int
    complete: bool
    bound: float


def search_on_off(
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    longest: int,
    *,
    slope: bool,
    tolerance: float,
    known: float,
) -> Searched:
    """Return the shortest command within a tolerance, else the best.

    Of as many samples it is the one of least residual.

    Parameters
    ----------
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time [s].
    longest
        Samples of the longest command, >= 2.
    slope
        Whether the slope counts, as in `unity_on_grid`.
    tolerance
        What may be left, >= 0 [-].
    known
        Residual of a command that is known; more is of no interest [-].

    Returns
    -------
    Searched
        The command, and what the search proves.
    """
    adds = actuator.model == "superposed" and not isinstance(actuator, RateLimited)
    budget = Budget(most=WORK_PER_SEARCH if adds else WORK_PER_LISTS)
    plan = Plan(mode, actuator, sample_time_s, longest, slope, tolerance, min(known, 1.0))
    return _by_halves(plan, budget) if adds else _by_lists(plan, budget)


@dataclass(frozen=True, slots=True)
class Plan:
    """What is searched for."""

    mode: Mode
    actuator: Actuator
    sample_time_s: float
    longest: int
    slope: bool
    tolerance: float
    known: float

    def steps(self, samples: int, budget: Budget, *, shorter: bool = False) -> Steps:
        """Return what steps add up to after so many samples.

        Parameters
        ----------
        samples
            From the first step to the last [-].
        budget
            Work that is left; this spends from it.
        shorter
            Whether shorter commands count too.

        Returns
        -------
        Steps
            Of each sample.
        """
        budget.spend(WORK_PER_STEPS[self.slope] * samples)
        return steps_of(
            samples,
            self.mode,
            self.actuator,
            self.sample_time_s,
            slope=self.slope,
            shorter=shorter,
        )

    def shortest(self, net: float, budget: Budget) -> int:
        """Return a number of samples that all commands within a net have at least.

        The least residual of courses of levels from 0 to 1 falls with the samples that they may
        take.

        Parameters
        ----------
        net
            What commands may have at most [-].
        budget
            Work that is left; this spends from it.

        Returns
        -------
        int
            At most one more than are searched.
        """
        low = 1
        for slope in (False, True)[: 1 + self.slope]:
            of_these = replace(self, slope=slope)
            reach, high = low + 1, self.longest + 1
            while reach < high:
                if of_these.steps(reach, budget, shorter=True).least <= net:
                    high = reach
                else:
                    low, reach = reach, 2 * reach
            while high - low > 1:
                middle = (low + high) // 2
                if of_these.steps(middle, budget, shorter=True).least <= net:
                    high = middle
                else:
                    low = middle
        return low + 1


def _by_halves(plan: Plan, budget: Budget) -> Searched:
    asked, plan = plan.longest, replace(plan, longest=min(plan.longest, MAX_SEARCHED_SAMPLES))
    # Few samples have halves that can all be listed, whatever the net.
    net = plan.known if asked <= MAX_UNPRUNED_SAMPLES else min(FIRST_NET, plan.known)
    least = plan.steps(plan.longest, budget, shorter=True).least
    if least >= plan.known:
        whole = asked == plan.longest
        return Searched(None, plan.known, plan.longest, whole, plan.known)
    net = max(net, least)
    while True:
        net = max(net, min(plan.tolerance, plan.known))
        found = _within(plan, net, budget)
        if found.samples is not None or not found.complete or net >= plan.known:
            break
        net = min(WIDER * net, plan.known)
    if found.samples is None and not found.complete:
        found = _probed(plan, found, budget)
    within = found.samples is not None and found.left <= plan.tolerance
    return replace(found, complete=found.complete and (within or asked == plan.longest))


def _within(plan: Plan, net: float, budget: Budget) -> Searched:
    """Search commands of more and more samples within a net, which narrows to what is found."""
    best, least, bound, searched = None, plan.known, net, 0
    for samples in range(plan.shortest(net, budget), plan.longest + 1):
        if budget.spent:
            break
        steps = plan.steps(samples, budget)
        if steps.least <= net:
            listed = commands_within(steps, net, budget, wanted=1)
            if listed.samples and listed.left[0] < least - TIE:
                best, least = listed.samples[0], float(listed.left[0])
            if not listed.complete:
                searched = searched or samples - 1
            if not searched:
                bound = min(bound, least)
            net = max(plan.tolerance, min(net, least))
            if least <= plan.tolerance and best is not None:
                searched = searched or samples
                whole = searched == samples
                return Searched(best, least, searched, whole, bound)
    else:
        samples = plan.longest + 1
    searched = searched or samples - 1
    return Searched(best, least, searched, searched == plan.longest, bound)


def _probed(plan: Plan, found: Searched, budget: Budget) -> Searched:
    """Look at some commands of some numbers of samples; few halves are kept now."""
    budget = budget.part(0)
    best, least = None, plan.known
    numbers = np.unique(np.linspace(found.searched + 1, plan.longest, PROBED).astype(int))
    for samples in numbers.tolist():
        steps = plan.steps(samples, budget)
        listed = commands_within(steps, least, budget, wanted=1)
        if listed.samples and listed.left[0] < least - TIE:
            best, least = listed.samples[0], float(listed.left[0])
            if least <= plan.tolerance:
                break
    return replace(found, samples=best, left=least)


def _by_lists(plan: Plan, budget: Budget) -> Searched:
    """Search behind drives whose steps do not add: all commands of few samples, some of more."""
    best, least, bound, searched = None, plan.known, plan.known, 1
    exact = is_listed_exactly(plan.actuator)
    samples = 1
    while samples < plan.longest and not budget.spent:
        samples += 1
        if samples == MAX_LISTED_SAMPLES + 1:
            # Where steps nearly add, shorter ones have no chance.
            samples = max(samples, min(plan.shortest(LIKELY_NET, budget), plan.longest))
        every = samples <= MAX_LISTED_SAMPLES
        levels = all_levels(samples) if every else _likely_levels(plan, samples, budget)
        left = _left(plan, levels, budget)
        row = int(np.argmin(left))
        chosen, value = levels[row], float(left[row])
        if every and exact:
            searched, bound = samples, min(bound, value)
        else:
            chosen, value = _moved(plan, levels, left, WORTH_MOVING * least, budget)
        if value < least - TIE:
            best, least = samples_of(chosen), value
        if least <= plan.tolerance:
            break
    ended = samples if least <= plan.tolerance else plan.longest
    return Searched(best, least, searched, searched == ended, bound if searched > 1 else 0.0)


def _left(plan: Plan, levels: AnyIntArray, budget: Budget) -> FloatArray:
    per_sample = WORK_PER_RAMP if isinstance(plan.actuator, RateLimited) else WORK_PER_LISTED
    budget.spend(per_sample * levels.size)
    if not is_listed_exactly(plan.actuator):
        budget.spend(WORK_ONE_BY_ONE * min(len(levels), COMPARED_ONE_BY_ONE))
    return left_of_levels(levels, plan.mode, plan.actuator, plan.sample_time_s, slope=plan.slope)


def _likely_levels(plan: Plan, samples: int, budget: Budget) -> AnyIntArray:
    """Return commands that change at few samples, and those that would do if steps added."""
    stride = -(-samples // COARSE_POSITIONS)
    levels = np.repeat(all_levels(-(-samples // stride)), stride, axis=1)[:, :samples]
    levels[:, -1] = 0
    steps = plan.steps(samples, budget)
    listed = commands_within(steps, LIKELY_NET, budget, wanted=LIKELY)
    changes = np.zeros((len(listed.samples), samples + 1), dtype=int)
    for row, at in enumerate(listed.samples):
        changes[row, at] = 1
    return np.concatenate((levels, np.cumsum(changes, axis=1)[:, :-1] % 2))


def _moved(
    plan: Plan, levels: AnyIntArray, left: FloatArray, most: float, budget: Budget
) -> tuple[AnyIntArray, float]:
    """Return the best command after changes of one or two levels while these lower what is left."""
    order = np.argsort(left, kind="stable")[:BEGUN]
    best, least = levels[order[0]], float(left[order[0]])
    if len(levels) == 1:
        return best, least
    for begin in order[left[order] <= most].tolist():
        command, value = levels[begin], float(left[begin])
        while not budget.spent:
            others = command ^ _flips(command)
            changed = _left(plan, others, budget)
            if changed.min() >= value - TIE:
                break
            command, value = others[np.argmin(changed)], float(changed.min())
        if value < least:
            best, least = command, value
    return best, least


def _flips(command: AnyIntArray) -> AnyIntArray:
    """Return changes of one level, or of two that are each beside a step."""
    free = np.arange(1, command.size - 1)
    beside = free[(command[:-2] != command[1:-1]) | (command[1:-1] != command[2:])]
    pairs = [*((one, one) for one in free), *itertools.combinations(beside, 2)]
    flips = np.zeros((len(pairs), command.size), dtype=int)
    flips[np.arange(len(pairs))[:, None], np.array(pairs)] = 1
    return flips
