"""The branch of a closed form: how many whole periods each impulse is late."""

import math

import numpy as np

from design.errors import InvalidInputError
from design.formulations.gaps import PERIOD_RAD
from design.formulations.lag_parameters import decel_over_accel
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.shapers.registry import SHAPERS
from design.types import FloatArray

WHOLE_TURN_MARGIN = 1e-6
"""How near to whole the turns of a closed form must come: its rounding, with room to spare [-]."""

BRANCHED = " or ".join(sorted(kind.name for kind in SHAPERS.values() if kind.has_branches))
"""Names of the kinds whose closed form has branches, in words."""


def closed_form_branch(impulses: Impulses, plant: Plant, actuator: Actuator) -> FloatArray:
    """Return which branch of the closed form a three-impulse shaper is on.

    ``w t2 = sign acos(alpha / 2) - beta + 2 pi n``, ``w t3 = sign 2 acos(alpha / 2) + 2 pi m``
    (Kim 2011, 3.34-3.35, which has the sign + only).

    Parameters
    ----------
    impulses
        A shaper of unity magnitude.
    plant, actuator
        An undamped plant of one mode, and a drive of superposed steps.

    Returns
    -------
    FloatArray
        n, m and the sign, shape (3,).

    Raises
    ------
    InvalidInputError
        If the times are on no branch.
    """
    ratio = decel_over_accel(plant.mode, actuator)
    alpha, beta = abs(ratio), -math.atan2(ratio.imag, ratio.real)
    phases = plant.mode.natural_frequency_rad_s * impulses.times_s
    if impulses.times_s.size == 3 and alpha <= 2:  # noqa: PLR2004 - of the closed form
        for sign in (1.0, -1.0):
            half = sign * math.acos(alpha / 2)
            turns = (phases[1:] - [half - beta, 2 * half]) / PERIOD_RAD
            whole = np.round(turns)
            if np.abs(turns - whole).max() < WHOLE_TURN_MARGIN:
                return np.array([*whole, sign])
    raise InvalidInputError(
        "quantity",
        "branch",
        f"asked of {BRANCHED}, of an undamped plant behind superposed steps",
        code="branch_not_served",
    )
