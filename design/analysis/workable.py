"""Whether an actuator is in proportion to the plant, so that a residual means something."""

from design.analysis.workable_ramps import require_workable_ramps
from design.errors import InvalidInputError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode

SLOWEST = 100.0
"""Largest time constant of a set times the plant's natural frequency [-]."""

RESONANCE = 1e-6
"""Below this ``|1/G|`` at the plant's pole, a set of the actuator rings with the plant [-]."""


def require_workable(mode: Mode, actuator: Actuator) -> None:
    """Check that the sets of an actuator are in proportion to the plant.

    A set with its own pole at the plant's rings with it, and a residual over the unshaped step
    means nothing; one a hundred times slower passes so little on that it drowns in rounding.

    Parameters
    ----------
    mode, actuator
        The plant's mode and its drive, limits included.

    Raises
    ------
    InvalidInputError
        If a set is over 100 times slower than the mode or has its pole, or the ramps of limits are
        not workable, see `require_workable_ramps`.
    """
    start, drive = "", actuator
    if isinstance(actuator, RateLimited):
        start, drive = "then.", actuator.then
    end = "_time_constant_s" if isinstance(drive, FirstOrder) else ""
    sets = (("accel", drive.accel_lag), ("decel", drive.decel_lag))
    for name, lag in ((f"{start}{one}{end}", lag) for one, lag in sets):
        slowness = mode.natural_frequency_rad_s * max(lag.first_s, lag.second_s2**0.5)
        if slowness > SLOWEST:
            raise InvalidInputError(
                f"actuator.{name}",
                float(f"{slowness:.3g}"),
                f"at most {SLOWEST:g} times slower than the plant",
                code="actuator_too_slow",
            )
        distance = abs(lag.denominator(mode.pole_rad_s))
        if distance < RESONANCE:
            raise InvalidInputError(
                f"actuator.{name}",
                f"1/G = {distance:.1e} there",
                "without a pole at the plant's pole, where the two resonate",
                code="actuator_resonant",
            )
    if isinstance(actuator, RateLimited):
        require_workable_ramps(mode, actuator)
