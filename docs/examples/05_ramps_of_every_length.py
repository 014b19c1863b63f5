"""No cliff: when the last ramp of `numzvd` ends, over the time of a ramp to full speed.

Longer ramps never let it end earlier. Branches meet without a jump, where ramps begin to turn, are
turned more often, or last whole periods; the curve may be steep there.
"""

import math
import sys

import numpy as np
from matplotlib.figure import Figure

from design.analysis.ramp_figures import end_of_reference
from design.model.actuators.rate_limited import RateLimited
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS

RATIOS = {"equal limits": 1.0, "deceleration four times acceleration": 0.25}
DAMPINGS = (0.0, 0.05, 0.2)
RAMPS = np.concatenate(([0.01, 0.05], np.linspace(0.1, 3.0, 30)))


def end_periods(rise: float, ratio: float, damping: float) -> float:
    """Return when the last ramp ends; all times are in undamped periods."""
    mode = Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=damping)
    drive = RateLimited(
        accel_limit_m_s2=1 / rise, decel_limit_m_s2=1 / (ratio * rise), speed_m_s=1.0
    )
    return end_of_reference(design(mode, drive, SHAPERS["numzvd"]).impulses, drive)


figure = Figure(figsize=(10, 4.6))
panels = figure.subplots(1, 2, sharey=True)
sys.stdout.write("ratio  damping  end at a ramp of 0.01, 0.5, 1, 2, 3 periods [periods]\n")
for panel, (name, ratio) in zip(panels, RATIOS.items(), strict=True):
    for damping in DAMPINGS:
        ends = [end_periods(rise, ratio, damping) for rise in RAMPS.tolist()]
        panel.plot(RAMPS, ends, label=f"damping ratio {damping:g}")
        shown = np.interp([0.01, 0.5, 1.0, 2.0, 3.0], RAMPS, ends)
        figures = "".join(f"{end:8.4f}" for end in shown)
        sys.stdout.write(f"{ratio:5.2f} {damping:8.2f} {figures}\n")
    panel.plot(RAMPS, RAMPS, ":", color="tab:gray", label="the ramp alone")
    panel.set_title(name)
    panel.set_xlabel("ramp to full speed [periods]")
    panel.grid(alpha=0.3)
panels[0].set_ylabel("last ramp ends [periods]")
panels[0].legend(loc="upper left")
figure.suptitle("numzvd behind limits: the fastest course, over ramps of every length")
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=120)
