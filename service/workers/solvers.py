"""The solvers of every shaper, built once: in the fork server, which workers are born of."""

import functools
import warnings

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.solving.by_formulation import SOLVERS, solver_of
from service.workers.memory import settle


@functools.cache
def warm_solvers() -> None:
    """Import every solver; build those of every shaper by one design of each."""
    for formulation in SOLVERS:
        solver_of(formulation)
    # Results are checked to be finite; a warning on the way would break the log of JSON lines.
    warnings.simplefilter("ignore", RuntimeWarning)
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.05)
    one = SecondOrderSet(natural_frequency_rad_s=10.0, damping_ratio=0.8)
    for actuator in (
        Ideal(),
        FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1, model="switched"),
        SecondOrder(accel=one, decel=one, model="switched"),
    ):
        for kind in SHAPERS.values():
            if actuator.kind in kind.actuators and not kind.large_swings:
                design(mode, actuator, kind)
    settle()
