"""Shapers over a band against SLSQP on the same problem, as peers solve it."""

import functools
from collections.abc import Iterator

import numpy as np

from benchmarks.measure import Figure, alternating_medians, ratio
from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.shapers.specified_insensitivity import BandOptions
from design.types import FloatArray

HALF_WIDTH, TOLERANCE = 0.15, 0.05
PLANT = Mode(natural_frequency_rad_s=1.0)


def by_slsqp() -> FloatArray:
    """Return times and amplitudes of three impulses, least duration, 31 frequencies in the band."""
    from scipy.optimize import minimize

    ratios = np.linspace(1 - HALF_WIDTH, 1 + HALF_WIDTH, 31)

    def slack(x: FloatArray) -> FloatArray:
        turned = np.exp(1j * np.outer(ratios, np.append(0.0, x[:2])))
        left: FloatArray = TOLERANCE**2 - np.abs(turned @ x[2:]) ** 2
        return left

    found = minimize(
        lambda x: x[1],
        np.array([np.pi, 2 * np.pi, 0.25, 0.5, 0.25]),  # ZVD, which keeps the slope zero
        method="SLSQP",
        bounds=[(0, 10)] * 2 + [(0, 1)] * 3,
        constraints=[
            {"type": "ineq", "fun": slack},
            {"type": "eq", "fun": lambda x: x[2:].sum() - 1},
            {"type": "ineq", "fun": lambda x: x[1] - x[0]},
        ],
        options={"ftol": 1e-10, "maxiter": 500},
    )
    solution: FloatArray = found.x
    return solution


def figures() -> Iterator[Figure]:
    """Measure."""
    kind, options = SHAPERS["si"], BandOptions(half_width=HALF_WIDTH, tolerance=TOLERANCE)
    seconds = alternating_medians(
        {"si": lambda: design(PLANT, Ideal(), kind, options), "slsqp": by_slsqp}, rounds=7, calls=3
    )
    took = {name: 1e3 * float(np.median(values)) for name, values in seconds.items()}
    found = design(PLANT, Ideal(), kind, options).impulses.duration_s
    yield Figure(
        what="SI design, bound and certificate / SLSQP on 31 frequencies, nothing proven",
        value=f"{ratio(seconds, 'si', 'slsqp'):.2f} ({took['si']:.1f} / {took['slsqp']:.1f} ms, "
        f"duration {found:.6f} / {by_slsqp()[1]:.6f})",
        limit="",
        met=None,
        over_peer=ratio(seconds, "si", "slsqp"),
    )
    rng = np.random.default_rng(3)
    times, gaps = [], []
    for _ in range(60):
        plant = Mode(natural_frequency_rad_s=1.0, damping_ratio=rng.uniform(0, 0.2))
        wanted = BandOptions(half_width=rng.uniform(0.05, 0.5), tolerance=rng.uniform(0.02, 0.1))
        one = functools.partial(design, plant, Ideal(), kind, wanted)
        times.append(1e3 * min(alternating_medians({"one": one}, rounds=1, calls=1)["one"]))
        gaps.append(design(plant, Ideal(), kind, wanted).solver.gap or 0.0)
    middle, late = np.percentile(times, [50, 95])
    yield Figure(
        what="SI over 60 random bands, half width 0.05-0.5, z 0-0.2: median, 95 %",
        value=f"{middle:.1f}, {late:.1f} ms, largest gap {max(gaps):.1e}",
        limit="<= 30, 80 ms, 1e-4",
        met=bool(middle <= 30 and late <= 80 and max(gaps) <= 1e-4),
    )
