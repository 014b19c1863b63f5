"""Shapers and moves behind limits and any lag: certified by another route, near their bound.

``python -m tests.acceptance.random_drives 300 200`` designs for 300 drives and moves by 200.
"""

import math
import statistics
import sys
import time
from dataclasses import dataclass

import numpy as np

from design.errors import DesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.plants.mode import Mode
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.acceptance.random_ramps import random_then
from tests.expm_route import outcome

SEED = 5_200

RESIDUAL = 1e-9
"""Most that is left [-]."""

GAP = 1e-3
"""Most between a duration and its bound, over the duration [-]."""

DISTANCE = 1e-9
"""Most that a move may miss its distance by [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """A drive, and how far it goes."""

    mode: Mode
    limited: RateLimited
    kind: str
    distance_m: float
    joint: bool

    @property
    def proves(self) -> bool:
        """Whether a bound is promised: of one lag, or none, for both directions."""
        then = self.limited.then
        if isinstance(then, FirstOrder):
            return then.accel_time_constant_s == then.decel_time_constant_s
        return isinstance(then, Ideal)


def draw(number: int) -> Drawn:
    """Draw ramps of a twentieth of a period to three, behind no lag, one lag or two."""
    rng = np.random.default_rng([SEED, number])
    mode = Mode(
        natural_frequency_rad_s=float(rng.uniform(0.5, 20)),
        damping_ratio=float(rng.choice([0, rng.uniform(0, 0.1), rng.uniform(0, 0.3)])),
    )
    up, down = mode.period_s * np.exp(rng.uniform(math.log(0.05), math.log(3), 2))
    one_s = 1 / (mode.natural_frequency_rad_s * float(rng.uniform(4, 20)))
    thens: list[Unlimited] = [
        Ideal(),
        FirstOrder(accel_time_constant_s=one_s, decel_time_constant_s=one_s),
        random_then(rng, mode.natural_frequency_rad_s),
        random_then(rng, mode.natural_frequency_rad_s),
    ]
    limited = RateLimited(
        accel_limit_m_s2=1 / up,
        decel_limit_m_s2=1 / down,
        speed_m_s=1.0,
        then=thens[number % len(thens)],
    )
    return Drawn(
        mode=mode,
        limited=limited,
        kind=str(rng.choice(["numzv", "numzvd"])),
        distance_m=mode.period_s * math.exp(rng.uniform(math.log(0.01), math.log(5))),
        joint=bool(rng.random() < 0.2),
    )


def faults_of_design(drawn: Drawn) -> list[str]:
    """Return what is wrong with a design; empty if nothing is."""
    found = design(drawn.mode, drawn.limited, SHAPERS[drawn.kind])
    left = outcome(found.impulses, drawn.mode, drawn.limited).residual
    gap = found.solver.gap
    faults = [f"leaves {left:.2g}"] if not left <= RESIDUAL else []
    if not found.certificate.verified or found.for_ideal:
        faults.append("is not certified for its drive")
    if drawn.proves and (gap is None or gap > GAP):
        faults.append(f"has a gap of {gap} to its bound")
    return faults


def faults_of_move(drawn: Drawn) -> list[str]:
    """Return what is wrong with a move; empty if nothing is."""
    kind = SHAPERS[drawn.kind]
    move = maneuver(
        drawn.mode,
        drawn.limited,
        kind,
        speed_m_s=1.0,
        distance_m=drawn.distance_m,
        joint=drawn.joint,
    )
    played = outcome(move.command, drawn.mode, drawn.limited)
    faults = [f"leaves {played.residual:.2g}"] if not played.residual <= RESIDUAL else []
    off = abs(played.travel - drawn.distance_m)
    if not off <= DISTANCE:
        faults.append(f"is {off:.2g} m off")
    if not move.certificate.verified or move.for_ideal:
        faults.append("is not certified for its drive")
    return faults


def main(designs: int, moves: int) -> int:
    """Try both; return 1 if one is wrong or refused."""
    bad = 0
    for what, count, faults_of in (
        ("design", designs, faults_of_design),
        ("move", moves, faults_of_move),
    ):
        seconds = []
        for number in range(count):
            started = time.process_time()
            try:
                faults = faults_of(draw(number))
            except DesignError as error:
                faults = [f"is refused: {error}"]
            seconds.append(time.process_time() - started)
            bad += bool(faults)
            for fault in faults:
                print(f"{what} {number} {fault}", flush=True)
        if seconds:
            median, longest = 1e3 * statistics.median(seconds), 1e3 * max(seconds)
            print(f"{count} {what}s: median {median:.3g}, longest {longest:.3g} ms with the judge")
    print(f"{bad} wrong or refused")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main(*(int(number) for number in sys.argv[1:3])))
