"""What remains on a controller's samples, over the sample time: ours beside four usual ways.

Damping ratio .05. Of `zv`, `umzv` and `numzvd` the residual at the nominal frequency is printed,
of `ei` and `si` the largest within 18 %. `numzvd` is behind a drive of two different lags, the
others are behind none. Grey lines are the tolerances. The name of a file (.png or .svg) draws all:

    python docs/examples/06_residual_on_samples.py samples.png
"""

import contextlib
import sys
from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from design.analysis.band import largest_in_band
from design.analysis.residual import residual_vibration
from design.errors import DesignError
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import Design, design
from design.sampling.sample_grid import nearest, round_with_carry, share_on_samples, split
from design.sampling.sampled_design import SAMPLE_TOLERANCE, sampled_design
from design.shapers.options import ShaperOptions
from design.shapers.registry import SHAPERS
from design.shapers.specified_insensitivity import BandOptions
from design.types import FloatArray

MODE = Mode(natural_frequency_rad_s=2 * np.pi, damping_ratio=0.05)
DRIVE = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=30, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=75, damping_ratio=1.5),
)
BAND = (0.82, 1.18)
CASES: dict[str, tuple[Actuator, ShaperOptions | None, bool]] = {  # and whether over the band
    "zv": (Ideal(), None, False),
    "ei": (Ideal(), None, True),
    "si": (Ideal(), BandOptions(half_width=0.18), True),
    "umzv": (Ideal(), None, False),
    "numzvd": (DRIVE, None, False),
}
SAMPLES_PERIODS = np.geomspace(1 / 250, 0.5, 60)
SHOWN = (0.01, 0.03, 0.1, 0.3)
Way = Callable[[Design, Actuator, float], Impulses]
"""Brings a shaper behind a drive to samples of some length [s]."""

FLOOR = 1e-8
"""Less is drawn here: it is rounding [-]."""


def split_by_swing(shaper: Impulses, sample_s: float) -> Impulses:
    """Split each step so that its two parts swing as it does (Murphy and Watanabe)."""
    numbers, shares = share_on_samples(shaper, sample_s, reach=1)
    shares = np.zeros(numbers.size)
    for time, amplitude in zip(shaper.times_s, shaper.amplitudes, strict=True):
        first = int(np.searchsorted(numbers, np.floor(time / sample_s + 1e-9)))
        pair = numbers[first : first + 2]
        turns = np.exp(-MODE.pole_rad_s * sample_s * pair)
        wanted = amplitude * np.exp(-MODE.pole_rad_s * time)
        if pair.size == 1:
            shares[first] += amplitude  # the last, on a sample
            continue
        shares[first : first + 2] += np.linalg.solve(
            [turns.real, turns.imag], [wanted.real, wanted.imag]
        )
    return Impulses(times_s=numbers * sample_s, amplitudes=shares / shares.sum())


def remaining(shaper: Impulses, actuator: Actuator, *, over_band: bool) -> float:
    """Return what a shaper has at the nominal frequency, or at most over the band."""
    if over_band:
        return largest_in_band(shaper, MODE, actuator, BAND)
    return residual_vibration(shaper, MODE, actuator)


def ours(shaper: Design, actuator: Actuator, sample_s: float) -> Impulses:
    """Return the shaper on samples as the service designs it."""
    found, _ = sampled_design(shaper, MODE, actuator, sample_s, tolerance=SAMPLE_TOLERANCE)
    return found.impulses


def moved(way: Callable[[Impulses, float], Impulses]) -> Way:
    """Return a way that needs the impulses alone."""
    return lambda shaper, _, sample_s: way(shaper.impulses, sample_s)


WAYS: dict[str, Way] = {
    "shapersmith": ours,
    "nearest samples": moved(nearest),
    "linear split": moved(split),
    "rounding error carried on": moved(round_with_carry),
    "split by swing (Murphy, Watanabe)": moved(split_by_swing),
}


def curve(way: Way, shaper: Design, actuator: Actuator, *, over_band: bool) -> FloatArray:
    """Return the residual over the sample times; nan where a way has no shaper."""
    residuals = np.full(SAMPLES_PERIODS.size, np.nan)
    for number, sample_s in enumerate((SAMPLES_PERIODS * MODE.period_s).tolist()):
        with contextlib.suppress(DesignError):
            on_samples = way(shaper, actuator, sample_s)
            residuals[number] = remaining(on_samples, actuator, over_band=over_band)
    return residuals


figure = Figure(figsize=(9, 13), layout="constrained")
panels = figure.subplots(len(CASES), 1, sharex=True)
shown = [int(np.argmin(np.abs(SAMPLES_PERIODS - one))) for one in SHOWN]
sys.stdout.write(f"residual in percent; samples of {', '.join(map(str, SHOWN))} periods\n")
for panel, (kind, (actuator, options, over_band)) in zip(panels, CASES.items(), strict=True):
    continuous = design(MODE, actuator, SHAPERS[kind], options)
    for name, way in WAYS.items():
        residuals = curve(way, continuous, actuator, over_band=over_band)
        sys.stdout.write(f"{kind:<8} {name:<34}")
        sys.stdout.write("".join(f"{100 * residuals[one]:9.3f}" for one in shown) + "\n")
        thick = 2.2 if name == "shapersmith" else 1.2
        unity = "split" not in name or kind in {"zv", "ei", "si"}
        panel.loglog(
            SAMPLES_PERIODS,
            np.maximum(residuals, FLOOR),
            "-" if unity else ":",
            linewidth=thick,
            label=name,
        )
    panel.axhline(0.05 if over_band else SAMPLE_TOLERANCE, color="tab:gray", linewidth=0.8)
    panel.set_title(
        kind if kind in {"zv", "ei", "si"} else f"{kind}; dotted: not of unity magnitude"
    )
    panel.set_ylabel("largest within 18 % [-]" if over_band else "residual [-]")
    panel.grid(alpha=0.3)
panels[-1].set_xlabel("sample time [periods]")
panels[0].legend(loc="lower right", fontsize=8)
if sys.argv[1:]:
    figure.savefig(sys.argv[1], dpi=110)
