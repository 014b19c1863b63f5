"""A drive on one line of plain text."""

from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator


def drive_line(actuator: Actuator) -> str:
    """Return a drive's kind, parameters and model, in ASCII.

    Parameters
    ----------
    actuator
        The drive.

    Returns
    -------
    str
        Its model, too, where it has lags.

    Examples
    --------
    >>> from design.model.actuators.first_order import FirstOrder
    >>> drive_line(FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05))
    'first order, accel time constant 0.1 s, decel time constant 0.05 s, superposed'
    """
    name, parameters = actuator.in_words
    parts = [name, *parameters.splitlines()]
    if has_sets(actuator):
        parts.append(actuator.model)
    if actuator.dead_time_s:
        parts.append(f"dead time {actuator.dead_time_s:g} s")
    return ", ".join(parts).replace("²", "^2").replace("³", "^3")


def has_sets(actuator: Actuator) -> bool:
    """Return whether a drive has lags, so that its model matters.

    Parameters
    ----------
    actuator
        The drive.

    Returns
    -------
    bool
        False of an ideal drive and of limits alone.
    """
    return not isinstance(actuator.then if isinstance(actuator, RateLimited) else actuator, Ideal)
