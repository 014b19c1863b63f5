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

    A switch is early before the last has settled, a set slow below twice the plant's frequency.

    Parameters
    ----------
    command, modes, actuator
        The steps that are sent, the modes, of which the fastest asks most, and the drive.

    Yields
    ------
    DesignWarning
        Of code ``actuator_not_settled`` or ``actuator_slow``, one a set.
    """
    gaps = command.times_s[1:] - command.times_s[:-1]
    steps = list(zip(gaps.tolist(), command.accelerates.tolist(), strict=False))
    lags, ramps_s = (actuator.accel_lag, actuator.decel_lag), unit_ramps_s(actuator)
    for name, lag, ramp_s in zip(("accel", "decel"), lags, ramps_s, strict=True):
        made = {  # a ramp turned midway is part of the model, and no step is made
            number: 1 - lag.step_error(gap - ramp_s)
            for number, (gap, rising) in enumerate(steps, start=1)
            if rising == (name == "accel") and gap >= ramp_s
        }
        early = [one for one in made if abs(1 - made[one]) > 1 - SETTLED_SHARE + SETTLED_MARGIN]
        if early:
            least = max(early, key=lambda one: abs(1 - made[one]))
            others = f"; {len(early) - 1} more of its switches are early" if early[1:] else ""
            yield DesignWarning(
                code="actuator_not_settled",
                detail=f"the {name} set has made {100 * made[least]:.3g} % of switch {least} when "
                f"the next one follows, {gaps[least - 1]:.4g} s after it{others}; the design "
                "counts on it, and is right where the model of the drive is",
            )
    fastest = max(mode.natural_frequency_rad_s for mode in modes)
    for name, corner in actuator.corner_frequencies_rad_s.items():
        if corner < SLOW_ACTUATOR * fastest:
            yield DesignWarning(
                code="actuator_slow",
                detail=f"the {name} set's corner frequency, {corner:.4g} rad/s, is below twice the "
                f"plant's natural frequency, {fastest:.4g} rad/s",
            )
