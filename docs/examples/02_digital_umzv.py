"""A digital UMZV beside the analog one (Kim 2011, appendix C, figure 5), printed and drawn.

Samples of 20 ms, taken to be with the crane of the thesis, and a case that rounding spoils; ideal
actuator. The name of a file (.png or .svg) draws the payload's swing after a step to full speed:

    python docs/examples/02_digital_umzv.py digital.png
"""

import sys

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from design.analysis.residual import residual_vibration
from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.pipeline import design
from design.response.closed_form import history
from design.sampling.sample_grid import nearest, round_with_carry
from design.sampling.sampled import sample
from design.shapers.registry import SHAPERS

SAMPLE_S = 0.02
CASES: dict[str, tuple[Mode, float]] = {
    "crane of the thesis, 3.5 rad/s": (
        Pendulum(cable_length_m=0.8, gravity_m_s2=9.81).mode,
        SAMPLE_S,
    ),
    "7.3 Hz, damping ratio .05": (
        Mode(natural_frequency_rad_s=2 * np.pi * 7.3, damping_ratio=0.05),
        0.01,
    ),
}

figure, panels = plt.subplots(2, 1, figsize=(7.5, 7.0), layout="constrained")
sys.stdout.write(
    "case                              UMZV                 leaves   times [samples]\n"
)
for panel, (case, (mode, sample_s)) in zip(panels, CASES.items(), strict=True):
    analog = design(mode, Ideal(), SHAPERS["umzv"]).impulses
    searched = sample(analog, mode, Ideal(), sample_s, SHAPERS["umzv"].claims, tolerance=0.01)
    shapers = {
        "analog": analog,
        "nearest samples": nearest(analog, sample_s),
        "equations 7 and 8": round_with_carry(analog, sample_s),
        "searched, within 1 %": searched.impulses,
    }
    times = np.linspace(0.0, max(s.duration_s for s in shapers.values()) + 2 * mode.period_s, 1000)
    styles = ("-", "--", ":", "-.")
    for (name, shaper), style in zip(shapers.items(), styles, strict=True):
        left = residual_vibration(shaper, mode, Ideal())
        samples = " ".join(f"{time:.4g}" for time in shaper.times_s / sample_s)
        sys.stdout.write(f"{case:<33} {name:<20} {100 * left:6.2f} %   {samples}\n")
        swing = mode.unit_pole.imag * history(shaper, mode, Ideal(), times).deflection
        panel.plot(times, swing, style, label=f"{name}: leaves {100 * left:.2f} %")
    panel.set_title(f"{case}, a sample every {1000 * sample_s:g} ms")
    panel.set_xlabel("time [s]")
    panel.set_ylabel("deflection, of unshaped amplitude [-]")
    panel.legend(fontsize=8, loc="lower right")
if sys.argv[1:]:
    figure.savefig(sys.argv[1], dpi=110)
