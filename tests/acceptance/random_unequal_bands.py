"""Bands behind limits and two lags: served, kept by another route, not beaten by random starts.

``python -m tests.acceptance.random_unequal_bands 100 10 30`` designs for 100 drives, and tries 30
random starts for each of the first ten.
"""

import math
import statistics
import sys
import time
from dataclasses import dataclass

import numpy as np

from design.analysis.residuals_of_many import residual_curve
from design.errors import InfeasibleDesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import Design, design
from design.shapers.numsi import NUM_SI, UnityBandOptions
from design.types import FloatArray
from tests import expm_route

SEED = 7_300

GAIN = 1e-4
"""Share of the end by which a random start may end earlier [-]."""

FINE = 401
"""Ratios at which a command of a random start is judged."""

FAR = 2.0
"""Share of the tolerance that is left where a start leads nowhere [-]."""

MISS = 1e-6
"""Share of the tolerance by which it may be above there [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """What is shaped for."""

    mode: Mode
    limited: RateLimited
    options: UnityBandOptions


def random_then(rng: np.random.Generator, w: float, model: Model) -> Unlimited:
    """Draw two lags: the first of 4 to 20 w, the other a third to three times as fast."""
    pole = w * float(rng.uniform(4, 20))
    poles = (pole, pole * float(np.exp(rng.uniform(-math.log(3), math.log(3)))))
    if rng.random() < 0.5:
        first, second = (1 / one for one in poles)
        return FirstOrder(accel_time_constant_s=first, decel_time_constant_s=second, model=model)
    accel, decel = (
        SecondOrderSet(natural_frequency_rad_s=one, damping_ratio=damping)
        for one, damping in zip(poles, rng.uniform(0.4, 1.6, 2).tolist(), strict=True)
    )
    return SecondOrder(accel=accel, decel=decel, model=model)


def random_band(number: int) -> Case:
    """Draw ramps of a twentieth of a period to three periods, a band, and the rest."""
    rng = np.random.default_rng([SEED, number])
    mode = Mode(
        natural_frequency_rad_s=float(rng.uniform(0.5, 20)),
        damping_ratio=float(rng.choice([0, rng.uniform(0, 0.1), rng.uniform(0, 0.3)])),
    )
    up, down = mode.period_s * np.exp(rng.uniform(math.log(0.05), math.log(3), 2))
    model: Model = "switched" if number % 2 else "superposed"
    limited = RateLimited(
        accel_limit_m_s2=float(1 / up),
        decel_limit_m_s2=float(1 / down),
        speed_m_s=1.0,
        then=random_then(rng, mode.natural_frequency_rad_s, model),
    )
    options = UnityBandOptions(
        half_width=float(rng.uniform(0.05, 0.2)),
        tolerance=float(np.exp(rng.uniform(math.log(0.02), math.log(0.1)))),
        max_duration_periods=8.0,
    )
    return Case(mode=mode, limited=limited, options=options)


def designed(case: Case) -> Design:
    """Design for a case."""
    return design(case.mode, case.limited, NUM_SI, case.options)


def largest_left(command: Impulses, case: Case, ratios: int = 21) -> float:
    """Return the largest residual over even ratios of the band, by another route [-]."""
    half_width, mode = case.options.half_width, case.mode
    modes = [
        Mode(
            natural_frequency_rad_s=ratio * mode.natural_frequency_rad_s,
            damping_ratio=mode.damping_ratio,
        )
        for ratio in np.linspace(1 - half_width, 1 + half_width, ratios).tolist()
    ]
    return max(expm_route.outcome(command, one, case.limited).residual for one in modes)


def command_of(times_s: FloatArray) -> Impulses:
    """Return steps up and down in turn."""
    steps = np.where(np.arange(times_s.size) % 2 == 0, 1.0, -1.0)
    return Impulses(times_s=times_s, amplitudes=steps)


def from_start(times_s: FloatArray, case: Case) -> float:
    """Return when the command ends to which SLSQP comes; infinity where it keeps no band [s].

    Its slopes are quotients. The highest of a fine grid of ratios are exchanged in.
    """
    from scipy.optimize import minimize

    mode, limited, period = case.mode, case.limited, case.mode.period_s
    half_width, tolerance = case.options.half_width, case.options.tolerance
    fine = np.linspace(1 - half_width, 1 + half_width, FINE)
    ratios = fine[:: FINE // 20]

    def command(gaps: FloatArray) -> Impulses:
        return command_of(np.append(0.0, np.cumsum(np.maximum(gaps, 1e-9))) * period)

    def end(gaps: FloatArray) -> float:
        return expm_route.end_s(command(gaps), limited) / period

    def room(gaps: FloatArray) -> FloatArray:
        left = residual_curve(command(gaps), mode, limited, ratios) / tolerance
        return (1 - left**2) / 2

    gaps = np.diff(times_s) / period
    for _ in range(4):
        found = minimize(
            end,
            gaps,
            method="SLSQP",
            bounds=[(1e-6, 8.0)] * gaps.size,
            constraints=[{"type": "ineq", "fun": room}],
            options={"maxiter": 60, "ftol": 1e-10, "eps": 1e-8},
        )
        gaps = found.x
        left = residual_curve(command(gaps), mode, limited, fine) / tolerance
        if left.max() < 1 + MISS:
            return end(gaps) * period
        if left.max() > FAR:
            break
        tops = np.flatnonzero((left[1:-1] > left[:-2]) & (left[1:-1] > left[2:])) + 1
        ratios = np.union1d(ratios, fine[tops])
    return math.inf


def tried(case: Case, made: Impulses, starts: int) -> tuple[float, int]:
    """Try random starts, half of them anywhere, half around the design.

    Parameters
    ----------
    case
        What is shaped for.
    made
        The design.
    starts
        How many starts.

    Returns
    -------
    tuple of float and int
        Share of the end by which the best ends earlier, and how many keep the band.
    """
    times, end = made.times_s, expm_route.end_s(made, case.limited)
    rng = np.random.default_rng([SEED, starts])
    ends = []
    for start in range(starts):
        anywhere = rng.uniform(0, end, times.size)
        around = times + rng.uniform(0, 0.2) * end * rng.normal(size=times.size)
        begun = np.sort(around if start % 2 else anywhere)
        ends.append(from_start(begun - begun[0], case))
    solved = int(np.isfinite(ends).sum())
    return 1 - min(ends, default=math.inf) / end if solved else -math.inf, solved


def main(cases: int, beaten_of: int, starts: int) -> int:
    """Design for cases and try random starts for some; return how many fail."""
    refused, above, beaten, took = 0, 0, 0, []
    for number in range(cases):
        case = random_band(number)
        begun = time.process_time()
        try:
            made = designed(case)
        except InfeasibleDesignError as error:
            refused += 1
            print(f"{number:3} refused: {error}", flush=True)
            continue
        finally:
            took.append(time.process_time() - begun)
        left = largest_left(made.impulses, case, 81) / case.options.tolerance
        above += left > 1 + 1e-9
        said = (
            f"{number:3} {took[-1]:5.2f} s, {made.impulses.times_s.size} switches, left {left:.9f}"
        )
        if number < beaten_of and made.impulses.times_s.size > 1:
            gain, solved = tried(case, made.impulses, starts)
            beaten += gain > GAIN
            said += f", {solved} starts solved, gain {gain:.2g}"
        print(said, flush=True)
    print(f"{cases - refused} of {cases} served, {above} above, {beaten} beaten")
    print(f"median {statistics.median(took):.2f} s, longest {max(took):.2f} s")
    return refused + above + beaten


if __name__ == "__main__":
    sys.exit(main(*(int(number) for number in sys.argv[1:4])) > 0)
