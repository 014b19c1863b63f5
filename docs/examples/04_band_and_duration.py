"""Guaranteed band against duration, for every kind of shaper in the catalogue, printed and drawn.

The crane and actuator of the thesis (Kim 2011), superposed steps. The guaranteed band is the
largest half width h such that the residual is at most 5 % wherever the true frequency is within
1 - h and 1 + h of the nominal one. The name of a file (.png or .svg) draws it:

    python docs/examples/04_band_and_duration.py band.png
"""

import math
import sys

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt

from design.analysis.insensitivity import insensitivity
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.pendulum import Pendulum
from design.pipeline import design
from design.shapers.numsi import UnityBandOptions
from design.shapers.registry import SHAPERS

TOLERANCE = 0.05
CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
ACTUATOR = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
)
HALF_WIDTHS = [0.01, 0.02, 0.028, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14, 0.16, 0.18, 0.186]
HALF_WIDTHS += [0.2, 0.22, 0.25, 0.28, 0.31, 0.335, 0.35, 0.38, 0.41, 0.44]


def guaranteed_half_width(shaper: Impulses) -> float:
    """Return the half width of the centred band within the tolerance, 0 if there is none [-]."""
    found = insensitivity(shaper, CRANE.mode, ACTUATOR, TOLERANCE)
    if found is None:
        return 0.0
    below = 1.0 if found.lower_ratio is None else 1 - found.lower_ratio
    above = math.inf if found.upper_ratio is None else found.upper_ratio - 1
    return min(below, above)


figure, panel = plt.subplots(figsize=(9.0, 6.0), layout="constrained")
sys.stdout.write("shaper         impulses  duration [s]  guaranteed band\n")
points: dict[tuple[float, float], list[str]] = {}
for name, kind in SHAPERS.items():
    if name == "num_si" or ACTUATOR.kind not in kind.actuators:
        continue
    shaper = design(CRANE, ACTUATOR, kind).impulses
    band = guaranteed_half_width(shaper)
    sys.stdout.write(
        f"{name:<16} {shaper.times_s.size:>6} {shaper.duration_s:>13.4f}   +- {100 * band:5.2f} %\n"
    )
    points.setdefault((round(shaper.duration_s, 2), round(100 * band, 1)), []).append(name)
for at, names in points.items():
    panel.plot(*at, "o", color="tab:gray")
    panel.annotate(", ".join(names), at, (4, 4), textcoords="offset points", rotation=40)
curves: dict[int, list[tuple[float, float]]] = {}
for half_width in HALF_WIDTHS:
    options = UnityBandOptions(half_width=half_width, tolerance=TOLERANCE)
    shaper = design(CRANE, ACTUATOR, SHAPERS["num_si"], options).impulses
    band = guaranteed_half_width(shaper)
    count = shaper.times_s.size
    curves.setdefault(count, []).append((shaper.duration_s, 100 * band))
    sys.stdout.write(
        f"{'num_si':<16} {count:>6} {shaper.duration_s:>13.4f}   +- {100 * band:5.2f} %\n"
    )
for count, curve in curves.items():
    panel.plot(*zip(*curve, strict=True), ".-", label=f"num_si, {count} impulses")
panel.set_xlabel("duration [s]")
panel.set_ylabel("guaranteed band [± % of the frequency]")
panel.set_title("residual of at most 5 % over the band: crane and actuator of Kim (2011)")
panel.set_ylim(-1, 56)
panel.margins(x=0.1)
panel.grid(alpha=0.3)
panel.legend(loc="upper left")
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=120)
