"""A drive superposes its steps, or has one state: a shaper for one swings the other.

Kim (2011) designs by the first (3.23-3.26) and simulates by the second (4.23-4.28).
"""

import sys
from dataclasses import replace

from design.analysis.residual import residual_vibration
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.pendulum import Pendulum
from design.pipeline import design
from design.shapers.registry import SHAPERS

CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
SUPERPOSED = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
)
SWITCHED = replace(SUPERPOSED, model="switched")

sys.stdout.write("shaper  designed for  leaves: superposed      switched\n")
for kind, actuator in (("umzvd", SUPERPOSED), ("numzvd", SUPERPOSED), ("numzvd", SWITCHED)):
    shaper = design(CRANE, actuator, SHAPERS[kind]).impulses
    made_for = "ideal" if kind == "umzvd" else actuator.model
    left = [residual_vibration(shaper, CRANE.mode, drive) for drive in (SUPERPOSED, SWITCHED)]
    sys.stdout.write(f"{kind:<7} {made_for:<13} {left[0]:18.2e} {left[1]:13.2e}\n")
