"""Amplitudes on samples, where they are free: on the fewest samples, the best.

For a number of samples the least violation of all that a shaper claims is a cone program: zeros are
equations, tolerances bound the vectors at ratios of a band, to which peaks above are added until
there are none.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from design.claims import Promise
from design.errors import InfeasibleDesignError, InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.asked import Drive, asked_of
from design.sampling.claims_on_samples import (
    MET,
    POLISHED,
    ClaimsOnSamples,
    Found,
    NearestZero,
    polished,
)
from design.sampling.freedom import Freedom, candidates, samples_of
from design.sampling.sample_grid import ON_SAMPLE, on_samples
from design.solvers.budget import Budget
from design.types import FloatArray

MORE_PERIODS = 10.0
"""How much longer than between the samples a shaper is sought, at most, and at most twice as long
and three periods more [periods]."""

FOR_EXACT = 2
"""Samples by which a shaper may take longer for zeros that hold to rounding."""

FEW_PATTERNS = 20
"""Ways to part samples that are tried on more samples than that, where any of many serves, and
behind a drive that passes its state on, where each takes milliseconds."""

MAX_UNKNOWNS = 2000
"""Samples that may have a step, at most: a program of so many takes two seconds, and its memory
grows with their square."""

PROVEN = 1e-6
"""Least bound that refuses zeros: above what counts as one, and the rounding of programs [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FreeAmplitudes:
    """Amplitudes on the fewest samples.

    Attributes
    ----------
    impulses
        The command.
    bound
        What no command on as many samples can go below in what is claimed: the largest residual
        over the bands, or where only zeros are claimed, 0; None where nothing is proven [-].
    shorter_bound
        The same of one sample less; where only zeros are claimed, of the largest Taylor term that
        is claimed to be zero, at 5 % of error in frequency: the residual, ``0.05 |dV/d ln w|`` ...
        [-].
    """

    impulses: Impulses
    bound: float | None
    shorter_bound: float | None


def free_on_samples(
    impulses: Impulses,
    promises: Sequence[Promise],
    modes: tuple[Mode, ...],
    actuator: Actuator,
    sample_time_s: float,
    budget: Budget | None = None,
) -> FreeAmplitudes:
    """Return amplitudes on the fewest samples that keep all promises.

    Of as many samples, those of the least residual over the bands; where only zeros are promised,
    those nearest to the linear split, on no fewer samples than that.

    Parameters
    ----------
    impulses
        The shaper between the samples.
    promises
        What it keeps there, over bands of given ends.
    modes, actuator
        The plant's modes, and the drive for which that is.
    sample_time_s
        Sample time, > 0, at most half the period of any mode [s].
    budget
        The work is counted in it.

    Returns
    -------
    FreeAmplitudes
        With what no other on as many samples, or on one less, can go below.

    Raises
    ------
    InvalidInputError
        If the shaper has too many impulses.
    InfeasibleDesignError
        If no number of samples up to the horizon keeps the promises.
    """
    problem = ClaimsOnSamples(
        impulses,
        asked_of(promises, modes),
        Drive(actuator, sample_time_s),
        Budget() if budget is None else budget,
    )
    first = max(samples_of(float(problem.positions[-1])), 1)
    period = max(mode.period_s for mode in modes) / sample_time_s
    most = first + math.ceil(min(first, MORE_PERIODS * period) + 3 * period)
    unknowns = candidates(problem.positions, most).size
    if unknowns > MAX_UNKNOWNS:
        raise InvalidInputError(
            "sample_time_s",
            sample_time_s,
            f"left out for {impulses.times_s.size} impulses, around which {unknowns} samples may "
            f"have a step; at most {MAX_UNKNOWNS} are solved for: bring a shaper of fewer modes to "
            "samples, or of fewer impulses for each",
            code="too_many_samples_to_solve",
        )
    if problem.largest_tolerance is not None:
        return _within_tolerance(problem, first, most, problem.largest_tolerance)
    return _of_zeros(problem, first, most)


def _within_tolerance(
    problem: ClaimsOnSamples, first: int, most: int, tolerance: float
) -> FreeAmplitudes:
    """Search the fewest samples from those of the shaper on, in steps that double."""
    known: dict[int, Found] = {}

    def least(last: int) -> Found:
        if last not in known:
            freedom = problem.freedoms(last)[0]
            known[last] = problem.least(freedom, decide=True)
        return known[last]

    def meets(last: int) -> bool:
        return last > 0 and least(last).value <= MET

    low, high, step = first - 1, first, 1
    if meets(first):
        while meets(low):
            low, high, step = max(low - 2 * step, 0), low, 2 * step
    else:
        low = first
        while not meets(high):
            if high == most:
                raise _none_within(problem, least(high), tolerance)
            low, high, step = high, min(high + step, most), 2 * step
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if meets(middle) else (middle, high)
    best = problem.least(problem.freedoms(high)[0])
    amplitudes = polished(
        best.program,
        best.freedom,
        best.outcome.unknowns,
        problem.zero_limits,
        best.value * (1 + POLISHED),
    )
    if amplitudes is None:  # equations that hold to the accuracy of the program
        amplitudes = best.freedom.base + best.freedom.matrix @ best.outcome.unknowns
    return FreeAmplitudes(
        impulses=_command(problem, best.freedom, amplitudes / amplitudes.sum()),
        bound=_bound(best, tolerance),
        shorter_bound=_bound(least(low), tolerance) if low > 0 else None,
    )


def _bound(found: Found, tolerance: float) -> float | None:
    """Return what no command on these samples can go below, of the largest tolerance [-]."""
    if not found.freedom.complete or not math.isfinite(found.outcome.bound):
        return None
    return max(found.outcome.bound, 0.0) * tolerance


def _none_within(problem: ClaimsOnSamples, found: Found, tolerance: float) -> InfeasibleDesignError:
    last, sample_time_s = int(found.freedom.samples[-1]), problem.drive.sample_time_s
    return InfeasibleDesignError(
        f"no amplitudes on up to {last + 1} samples of {sample_time_s:g} s, "
        f"{last * sample_time_s:.4g} s, keep the tolerance of {100 * tolerance:.4g} %; the least "
        f"residual that they can have is {100 * found.value * tolerance:.4g} %: take a shorter "
        "sample time, a narrower band or a larger tolerance",
        code="tolerance_not_on_samples",
    )


def _command(problem: ClaimsOnSamples, freedom: Freedom, amplitudes: FloatArray) -> Impulses:
    """Return amplitudes as a command that begins at the sample of the shaper's first impulse."""
    sample_time_s, impulses = problem.drive.sample_time_s, problem.impulses
    total = float(impulses.amplitudes.sum())
    begin = math.floor(float(impulses.times_s[0]) / sample_time_s + ON_SAMPLE)
    early = int(np.flatnonzero(amplitudes)[0])
    samples = freedom.samples - freedom.samples[early] + begin
    return on_samples(samples, total * amplitudes, sample_time_s)


def _of_zeros(problem: ClaimsOnSamples, first: int, most: int) -> FreeAmplitudes:
    """Search the fewest samples on which all zeros can be had, in steps that double.

    From those of the shaper on. Zeros that need a step too small to be one serve where one or two
    samples more do no better.

    Raises
    ------
    InfeasibleDesignError
        If no amplitudes make zero what is claimed to be.
    """
    nearly: NearestZero | None = None
    exact: NearestZero | None = None

    def found_on(last: int) -> bool:
        nonlocal nearly, exact
        usual = last <= first + FOR_EXACT and not problem.drive.passes_state_on
        for freedom in problem.freedoms(last)[: None if usual else FEW_PATTERNS]:
            found = problem.nearest_zero(freedom)
            if found is not None and found.is_exact:
                exact = found
                return True
            nearly = nearly or found
        return False

    low, high, step = first - 1, first, 1
    while not found_on(high) and high < most:
        if nearly is not None:
            most = min(most, int(nearly.freedom.samples[-1]) + FOR_EXACT)
        elif high == first:
            _require_some(problem, most)
        low, high = high, min(high + step, most)
        step *= 1 if high <= first + FOR_EXACT else 2
    while exact is not None and high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if found_on(middle) else (middle, high)
    best = exact or nearly
    if best is not None:
        return _zeros_on(problem, best.freedom, best.amplitudes)
    raise InfeasibleDesignError(
        f"no amplitudes within the limits of the shaper were found that on {first + 1} to "
        f"{most + 1} samples of {problem.drive.sample_time_s:g} s make zero what it claims to be",
        code="no_amplitudes_on_samples",
    )


def _require_some(problem: ClaimsOnSamples, most: int) -> None:
    """Check that it is not proven that no amplitudes keep the zeros.

    Raises
    ------
    InfeasibleDesignError
        If it is.
    """
    bound = _least_possible(problem, most)
    if bound is not None and bound > PROVEN:
        sample_time_s = problem.drive.sample_time_s
        raise InfeasibleDesignError(
            f"proven: no command on up to {most + 1} samples of {sample_time_s:g} s, "
            f"{most * sample_time_s:.4g} s, keeps the limits of the shaper and makes zero what it "
            f"claims to be; a Taylor term of what is left is {100 * bound:.4g} % or more at 5 % of "
            "error in frequency: take a shorter sample time",
            code="proven_none_on_samples",
        )


def _zeros_on(problem: ClaimsOnSamples, freedom: Freedom, amplitudes: FloatArray) -> FreeAmplitudes:
    """Return amplitudes of all zeros, with what one sample less has at least."""
    return FreeAmplitudes(
        impulses=_command(problem, freedom, amplitudes),
        bound=0.0,
        shorter_bound=_least_possible(problem, int(freedom.samples[-1]) - 1),
    )


def _least_possible(problem: ClaimsOnSamples, last: int) -> float | None:
    """Return what commands on so many samples cannot go below, where that is proven."""
    freedom = problem.all_freedom(last) if last > 0 else None
    if freedom is None:
        return None
    bound = problem.least(freedom).outcome.bound
    return max(bound, 0.0) if math.isfinite(bound) else None
