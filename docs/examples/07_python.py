"""The Python interface: which shaper for a crane whose cable changes, printed and drawn.

The crane of the thesis with its drive. The fastest shapers that keep 5 % for cables 10 % shorter or
longer are recommended, and each is mapped over the length. The name of a file (.png or .svg) draws
a move of 0.6 m:

    python docs/examples/07_python.py move.png
"""

import sys

import shapersmith

CRANE = shapersmith.Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
DRIVE = shapersmith.SecondOrder(
    accel=shapersmith.SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.8),
    decel=shapersmith.SecondOrderSet(natural_frequency_rad_s=50, damping_ratio=1.5),
)
LENGTHS_M = [0.72, 0.76, 0.8, 0.84, 0.88]

found = shapersmith.recommend(CRANE, DRIVE, half_width=0.055)
sys.stdout.write("shaper      duration   residual [%] with a cable of\n")
sys.stdout.write(
    f"                 [s]   {' '.join(f'{length_m:6.2f}' for length_m in LENGTHS_M)} m\n"
)
axis = shapersmith.Axis(field="/plant/cable_length_m", values=LENGTHS_M)
for candidate in [found.recommended, *found.runners_up][:4]:
    over_lengths = shapersmith.field_map(CRANE, DRIVE, axis, shaper=candidate.shaper)
    percents = " ".join(f"{100 * residual:6.2f}" for residual in over_lengths.values)
    sys.stdout.write(f"{candidate.name:<10} {candidate.duration_s:9.3f}   {percents}\n")

try:
    shapersmith.recommend(CRANE, DRIVE, half_width=0.055, max_duration_s=0.5)
except shapersmith.InfeasibleDesignError as error:
    sys.stdout.write(f"within 0.5 s: {error}\n")

if len(sys.argv) > 1:
    move = shapersmith.maneuver(CRANE, DRIVE, "numzvd", speed_m_s=0.2, distance_m=0.6)
    move.plot().savefig(sys.argv[1])
