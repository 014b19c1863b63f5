"""Short shapers on samples against all there is: a dense cone program, and every command.

``python -m tests.acceptance.random_small_samples 300`` draws designs as
`tests.acceptance.random_answers` does, until so many of at most 14 samples were compared. Of free
amplitudes a cone program (CVXPY) on 201 frequencies must need as many samples, and leave as much
on as many. Of unity magnitude all commands as long are listed.
"""

import json
import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from design.model.actuators.rate_limited import RateLimited
from design.types import FloatArray
from service.dispatch import respond
from service.problems import Problem
from tests.acceptance.random_answers import generator
from tests.acceptance.random_samples import drawn_on_samples, without_samples
from tests.acceptance.sample_judges import SAMPLE_TOLERANCE, OnSamples
from tests.acceptance.sample_proofs import Wanted, least_of_level_0_or_1, missed, rows_of

MOST_SAMPLES = 14

RATIOS = 201

LESS = 1e-3
"""Share by which a rival may leave less: what is told is a peak, and below it by rounding [-]."""

ZERO = 1e-12
"""What keeps zeros and limits: weighed by its order, a third derivative counts from 2e-10 on, which
a cone program alone does not reach [-]."""

ABSENT = (0.0, 1e-7, 1e-5, 1e-3)
"""Amplitudes that are left as a cone program has them, where the nearest zeros are sought [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """Which way a case was compared; empty if none is known. ``beaten`` says by what."""

    way: str = ""
    beaten: str = ""


def amplitudes_by_cones(
    wanted: list[Wanted], samples: int, sample_time_s: float, levels: tuple[float, float] | None
) -> FloatArray | None:
    """Return amplitudes on all samples that miss least; between levels, or positive if None."""
    import cvxpy

    steps = cvxpy.Variable(samples)
    left = cvxpy.Variable()
    constraints = [cvxpy.sum(steps) == 1]
    for one in wanted:
        rows = rows_of(one, samples, sample_time_s, RATIOS) / one.limit
        parts = cvxpy.vstack([rows.real @ steps, rows.imag @ steps])
        constraints.append(cvxpy.norm(parts, axis=0) <= left)
    if levels is None:
        constraints.append(steps >= 0)
    else:
        sums = np.tril(np.ones((samples, samples))) @ steps
        constraints += [sums >= levels[0], sums <= levels[1]]
    cvxpy.Problem(cvxpy.Minimize(left), constraints).solve(solver=cvxpy.CLARABEL)
    return None if steps.value is None else np.array(steps.value)


def drawn(number: int) -> OnSamples | None:
    """Return a case with its answers, on samples and between; None where there is none."""
    _, request, plant, actuator, shaper = drawn_on_samples(generator("samples", number))
    answer = respond("design", json.dumps(request).encode())
    between = without_samples(request)
    if isinstance(answer, Problem) or isinstance(between, Problem):
        return None
    told, before = (json.loads(one.model_dump_json(by_alias=True)) for one in (answer, between))
    return OnSamples(told, before, plant, actuator, shaper)


def compared(judge: OnSamples | None) -> Compared:
    """Compare one case."""
    if judge is None or judge.answer["sampled"]["samples"][-1] + 1 > MOST_SAMPLES:
        return Compared()
    if judge.is_free:
        wanted = judge.wanted()
        return Compared() if wanted is None else _by_cones(judge, wanted)
    return _by_listing(judge)


def _by_cones(judge: OnSamples, wanted: list[Wanted]) -> Compared:
    promised = judge.between["certificate"]["claims"]
    tolerance = max(one["limit"] for one in promised)
    over_band = tolerance > 1e-4
    sample_time_s = judge.shaper["sample_time_s"]
    count = judge.answer["sampled"]["samples"][-1] + 1
    told = []

    def left_on(samples: int) -> float:
        best = amplitudes_by_cones(wanted, samples, sample_time_s, judge.levels)
        return np.inf if best is None else missed(wanted, best, sample_time_s)

    if over_band:
        # One sample less misses the tolerance; on as many, no amplitudes leave less.
        less, as_many = left_on(count - 1) if count > 1 else np.inf, left_on(count)
        if less < 1 - LESS:
            told.append(f"{count} samples, {less:.9g} of the tolerance is left on one less")
        claims = judge.answer["certificate"]["claims"]
        worst = max(one["value"] for one in claims) / tolerance
        if len(judge.plant.modes) == 1 and worst > as_many * (1 + LESS):
            told.append(f"leaves {worst:.9g} of the tolerance, another command {as_many:.9g}")
    elif count > 1 + _samples_between(judge):
        rival = amplitudes_by_cones(wanted, count - 1, sample_time_s, judge.levels)
        if rival is not None and _keeps_zeros(wanted, rival, sample_time_s, judge.levels):
            told.append(f"{count} samples, zeros are kept on one less")
    return Compared(way="cone program", beaten="; ".join(told))


def _keeps_zeros(
    wanted: list[Wanted],
    near: FloatArray,
    sample_time_s: float,
    levels: tuple[float, float] | None,
) -> bool:
    """Return whether the zeros nearest to amplitudes are within their limits."""
    rows = np.concatenate([rows_of(one, near.size, sample_time_s) for one in wanted])
    equations = np.concatenate((rows.real, rows.imag, np.ones((1, near.size))))
    sides = np.append(np.zeros(2 * len(rows)), 1.0)
    low, high = (0.0, 1.0) if levels is None else levels
    for least in ABSENT:
        found = np.where(np.abs(near) > least, near, 0.0)
        kept = found != 0
        missing = sides - equations @ found
        found[kept] += np.linalg.lstsq(equations[:, kept], missing, rcond=None)[0]
        values = found if levels is None else np.cumsum(found)
        if (
            np.abs(equations @ found - sides).max() < ZERO
            and values.min() > low - ZERO
            and values.max() < high + ZERO
        ):
            return True
    return False


def _samples_between(judge: OnSamples) -> int:
    """Return how many samples the shaper between them takes: of zeros alone no fewer are sought."""
    duration_s = float(judge.between["shaper"]["duration_s"])
    return math.ceil(duration_s / float(judge.shaper["sample_time_s"]) - 1e-9)


def _by_listing(judge: OnSamples) -> Compared:
    drive, sampled = judge.actuator, judge.answer["sampled"]  # the residual is with that
    claims = judge.between["certificate"]["claims"]
    if isinstance(drive, RateLimited) or drive.model == "switched" or len(judge.plant.modes) > 1:
        return Compared()
    if any("band" in one for one in claims) or not sampled["tried"]:
        return Compared()
    count = sampled["samples"][-1]
    slope = "slope" in {one["quantity"] for one in claims}
    tolerance = judge.shaper.get("sample_tolerance", SAMPLE_TOLERANCE)
    reached = min(one["compared"] for one in sampled["tried"])

    def least(last: int) -> float:
        mode, sample_time_s = judge.plant.modes[0], judge.shaper["sample_time_s"]
        return least_of_level_0_or_1(mode, drive, sample_time_s, last, slope=slope)

    if reached <= tolerance and count > 2 and least(count - 1) <= tolerance * (1 - LESS):
        return Compared(way="listing", beaten=f"keeps {tolerance:g} on less than {count} samples")
    if reached > tolerance and least(count) < reached * (1 - LESS):
        return Compared(way="listing", beaten=f"{reached:.9g}, {least(count):.9g} is possible")
    return Compared(way="listing")


def beaten(numbers: Iterator[int], wanted: int) -> tuple[dict[str, int], list[str]]:
    """Compare until so many were; return how many in each way, and what is beaten."""
    ways: dict[str, int] = {}
    found = []
    while sum(ways.values()) < wanted:
        number = next(numbers)
        one = compared(drawn(number))
        if one.way:
            ways[one.way] = ways.get(one.way, 0) + 1
        if one.beaten:
            found.append(f"case {number}, {one.way}: {one.beaten}")
            print(found[-1], flush=True)
    return ways, found


if __name__ == "__main__":
    from itertools import count as endless

    counted, lost = beaten(endless(10_000), int(sys.argv[1]))
    print(f"compared: {counted}, beaten: {len(lost)}")
    sys.exit(bool(lost))
