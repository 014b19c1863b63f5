"""Shapers behind limits and two lags against many random starts: none may end earlier.

``python -m tests.acceptance.random_ramps 60 200`` tries 60 drives from 200 starts each; a third
number is that of the first drive.
"""

import math
import sys
from dataclasses import dataclass

import numpy as np

from design.analysis.residual import residual_vectors
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.types import FloatArray

SEED = 4_100

GAIN = 1e-4
"""Share of the end by which a random start may end earlier [-]."""

MISS = 1e-7
"""Most that SLSQP may leave of any equation where it counts as solved [-]."""

NODES = np.exp(2j * np.pi * np.arange(8) / 8)
"""Where an analytic function is taken for its derivative, by Cauchy's formula [-]."""

TURN_RAD = 0.3
"""Turn of the phase at the end on the way to them: the error is its eighth power over 8! [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """What is shaped for."""

    mode: Mode
    limited: RateLimited
    kind: str


def random_then(rng: np.random.Generator, w: float) -> Unlimited:
    """Draw two different lags, of poles 4 to 20 w, either model."""
    model: Model = "switched" if rng.random() < 0.5 else "superposed"
    poles = w * rng.uniform(4.0, 20.0, 2)
    if rng.random() < 0.5:
        first, second = (1 / poles).tolist()
        return FirstOrder(accel_time_constant_s=first, decel_time_constant_s=second, model=model)
    accel, decel = (
        SecondOrderSet(natural_frequency_rad_s=pole, damping_ratio=damping)
        for pole, damping in zip(poles.tolist(), rng.uniform(0.4, 1.6, 2).tolist(), strict=True)
    )
    return SecondOrder(accel=accel, decel=decel, model=model)


def random_drive(number: int) -> Drive:
    """Draw ramps of a twentieth of a period to three periods, and the rest."""
    rng = np.random.default_rng([SEED, number])
    mode = Mode(
        natural_frequency_rad_s=float(rng.uniform(0.5, 20)),
        damping_ratio=float(rng.choice([0, rng.uniform(0, 0.1), rng.uniform(0, 0.3)])),
    )
    up, down = mode.period_s * np.exp(rng.uniform(math.log(0.05), math.log(3), 2))
    limited = RateLimited(
        accel_limit_m_s2=1 / up,
        decel_limit_m_s2=1 / down,
        speed_m_s=1.0,
        then=random_then(rng, mode.natural_frequency_rad_s),
    )
    return Drive(mode=mode, limited=limited, kind=str(rng.choice(["numzv", "numzvd"])))


def end_s(times_s: FloatArray, limited: RateLimited) -> float:
    """Return when the reference comes to rest, by the slopes between the steps [s]."""
    up, down = (limit / limited.speed_m_s for limit in _limits(limited))
    level = end = 0.0
    following = [*times_s[1:].tolist(), math.inf]
    for number, (start, stop) in enumerate(zip(times_s.tolist(), following, strict=True)):
        goal = 1.0 - number % 2
        end = start + (goal - level) / (up if goal else -down)
        level = goal if end <= stop else level + (up if goal else -down) * (stop - start)
    return end


def _limits(limited: RateLimited) -> tuple[float, float]:
    return limited.accel_limit_m_s2, limited.decel_limit_m_s2


def misses(times_s: FloatArray, drive: Drive) -> FloatArray:
    """Return what is left and, of ``numzvd``, its slope, seen at the end [-]."""
    steps = np.where(np.arange(times_s.size) % 2 == 0, 1.0, -1.0)
    command = Impulses(times_s=times_s, amplitudes=steps)
    pole, end = drive.mode.pole_rad_s, end_s(times_s, drive.limited)
    radius = TURN_RAD / (abs(pole) * max(end, drive.mode.period_s))
    poles = pole * (1 + radius * NODES)
    lag = drive.limited.accel_lag
    over_accel = residual_vectors(command, poles, drive.limited)
    at_first = over_accel * np.exp(-(poles - pole) * end) / lag.denominator(poles)
    unit = lag.denominator(pole)
    left = [unit * at_first.mean()]
    if drive.kind == "numzvd":
        left.append(unit * (at_first / NODES).mean() / radius)
    return np.array([part for one in left for part in (one.real, one.imag)])


def from_start(times_s: FloatArray, drive: Drive) -> float:
    """Return when the command ends to which SLSQP comes; infinity where it solves nothing [s]."""
    from scipy.optimize import minimize

    period = drive.mode.period_s

    def times(gaps: FloatArray) -> FloatArray:
        return np.append(0.0, np.cumsum(np.maximum(gaps, 1e-9))) * period

    found = minimize(
        lambda gaps: end_s(times(gaps), drive.limited) / period,
        np.diff(times_s) / period,
        method="SLSQP",
        bounds=[(1e-6, 8.0)] * (times_s.size - 1),
        constraints=[{"type": "eq", "fun": lambda gaps: misses(times(gaps), drive)}],
        options={"maxiter": 30, "ftol": 1e-10, "eps": 1e-8},
    )
    solved = np.abs(misses(times(found.x), drive)).max() < MISS
    return end_s(times(found.x), drive.limited) if solved else math.inf


def tried(number: int, starts: int) -> tuple[float, int]:
    """Design for a drive and try random starts.

    Half of them are anywhere, half around the design: few of the first are solved where the
    equations are as many as the unknowns.

    Parameters
    ----------
    number
        Number of the drive.
    starts
        How many starts.

    Returns
    -------
    tuple of float and int
        Share of the end by which the best ends earlier, and how many are solved.
    """
    drive = random_drive(number)
    made = design(drive.mode, drive.limited, SHAPERS[drive.kind]).impulses.times_s
    end = end_s(made, drive.limited)
    rng = np.random.default_rng([SEED, number, starts])
    ends = []
    for start in range(starts):
        anywhere = rng.uniform(0, end, made.size)
        around = made + rng.uniform(0, 0.2) * end * rng.normal(size=made.size)
        times = np.sort(around if start % 2 else anywhere)
        ends.append(from_start(times - times[0], drive))
    solved = int(np.isfinite(ends).sum())
    return 1 - min(ends, default=math.inf) / end if solved else -math.inf, solved


def main(drives: int, starts: int, first: int = 0) -> int:
    """Try drives; return how many are beaten."""
    beaten = 0
    for number in range(first, first + drives):
        gain, solved = tried(number, starts)
        beaten += int(gain > GAIN)
        print(
            f"{number:3} {random_drive(number).kind:6} {solved:4} solved, gain {gain:.2g}",
            flush=True,
        )
    print(f"{beaten} of {drives} beaten")
    return beaten


if __name__ == "__main__":
    sys.exit(main(*(int(number) for number in sys.argv[1:4])) > 0)
