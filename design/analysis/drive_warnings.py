"""What to know of the drive: early switches and slow sets."""

from collections.abc import Iterator

from design.analysis.warnings import DesignWarning
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.lags import SETTLED_SHARE
from design.model.plants.mode import Mode

SLOW_ACTUATOR = 2.0
"""Corner frequency over the plant's below which the thesis advises against (eq. 3.41) [-]."""

SETTLED_MARGIN = 1e-6
"""A gap at its bound has settled: IPOPT relaxes bounds by 1e-8, times are rounded [-]."""


def drive_warnings(
    command: Impulses, modes: tuple[Mode, ...], actuator: Actuator
) -> Iterator[DesignWarning]:
    """Yield what to know of the drive: early switches and slow sets.

    A switch is early if the step before it has not settled; a set is slow if its corner frequency
    is below twice the plant's.

    Parameters
    ----------
    command, modes, actuator
        The steps that are sent, the modes, of which the fastest asks most, and the drive.

    Yields
    ------
    DesignWarning
        Of code ``actuator_not_settled``, one a switch, or ``actuator_slow``, one a set.
    """
    gaps = command.times_s[1:] - command.times_s[:-1]
    ramps_s = dict(zip(("accel", "decel"), unit_ramps_s(actuator), strict=True))
    steps = zip(gaps.tolist(), command.accelerates.tolist(), strict=False)
    for number, (gap, rising) in enumerate(steps, start=1):
        name, lag = ("accel", actuator.accel_lag) if rising else ("decel", actuator.decel_lag)
        if gap < ramps_s[name]:
            continue  # a ramp turned midway is part of the model, and no step is made
        error = lag.step_error(gap - ramps_s[name])
        if abs(error) > 1 - SETTLED_SHARE + SETTLED_MARGIN:
            yield DesignWarning(
                code="actuator_not_settled",
                detail=f"the {name} set has made {100 * (1 - error):.3g} % of switch {number} "
                f"when the next one follows, {gap:.4g} s after it",
            )
    fastest = max(mode.natural_frequency_rad_s for mode in modes)
    for name, corner in actuator.corner_frequencies_rad_s.items():
        if corner < SLOW_ACTUATOR * fastest:
            yield DesignWarning(
                code="actuator_slow",
                detail=f"the {name} set's corner frequency, {corner:.4g} rad/s, is below twice the "
                f"plant's natural frequency, {fastest:.4g} rad/s",
            )
