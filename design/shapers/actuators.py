"""Kinds of actuators that kinds of shapers serve."""

from typing import get_args

from design.model.actuators.rate_limited import Unlimited
from design.model.actuators.registry import Actuator

UNLIMITED_ACTUATORS = tuple(one.kind for one in get_args(Unlimited))
"""Kinds of actuators without limits to the rate of the command."""

EVERY_ACTUATOR = tuple(one.kind for one in get_args(Actuator))
"""Kinds of actuators, the one that asks most of a shaper last: the catalogue's example has it."""

EVERY_ACTUATOR_BY_ITS_LAG = tuple(
    sorted(EVERY_ACTUATOR, key=lambda name: name not in {"ideal", "rate_limited"})
)
"""The same for shapers that only use the acceleration set, of which a lag asks most."""
