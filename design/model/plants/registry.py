"""All kinds of plants: what moves."""

from design.model.plants.double_pendulum import DoublePendulum
from design.model.plants.free_body import FreeBody
from design.model.plants.hoisting import Hoisting
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.scheduled import Scheduled
from design.model.plants.spring_mass import SpringMass

SeveralModes = Modes | DoublePendulum
"""Plants that have more than one mode."""

Plant = Mode | Pendulum | SpringMass | SeveralModes | Scheduled | Hoisting | FreeBody
