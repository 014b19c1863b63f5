"""The one judge of what is sent to a drive: claims, for whom they hold, and what to know besides.

Designs, moves, shapers on samples, programs, shaped simulations and table rows all come here. A
claim is certified for the actuator that is given. Where it fails there, it is certified for the
actuator that the shaper was designed for, an ideal one, and a warning says what remains.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from design.analysis.certificate import Certificate, Claim, certify_modes
from design.analysis.residual import residual_vibration
from design.claims import Promise
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.lags import SETTLED_SHARE
from design.model.plants.mode import Mode

SLOW_ACTUATOR = 2.0
"""Corner frequency over the plant's below which the thesis advises against (eq. 3.41) [-]."""

SETTLED_MARGIN = 1e-6
"""A gap at its bound has settled: IPOPT relaxes bounds by 1e-8, times are rounded [-]."""

SUM_ROUNDING = 1e-9
"""What a sum of amplitudes may be off by, over the sum of their sizes: printed digits [-]."""

IN_WORDS = {
    "residual": "the residual is {value}",
    "slope": "its slope over the frequency is {value} of a step",
    "second_derivative": "its second derivative is {value} of a step",
    "third_derivative": "its third derivative is {value} of a step",
    "band": "the residual is up to {value} from {low:.4g} to {high:.4g} of the frequency",
}
"""What a claim found, by its quantity."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignWarning:
    """Something a user should know of an answer that is right all the same.

    Attributes
    ----------
    code
        A name that programs can rely on.
    detail
        The same in words, with the figure.
    """

    code: str
    detail: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """What a command does, held against what is claimed of it.

    Attributes
    ----------
    certificate
        The claims, recomputed: for the actuator given if all of them hold there.
    for_ideal
        Whether the certificate is for the actuator that the command was designed for, an ideal one,
        in place of the one given.
    residuals
        Residual vibration of each mode with the actuator given [-].
    warnings
        One for the claims that do not hold with the actuator given, if there are any.
    """

    certificate: Certificate
    for_ideal: bool
    residuals: tuple[float, ...]
    warnings: tuple[DesignWarning, ...]

    @property
    def residual(self) -> float:
        """The largest residual of any mode with the actuator given [-]."""
        return max(self.residuals)


def judge(
    command: Impulses,
    modes: tuple[Mode, ...],
    actuator: Actuator,
    promises: tuple[Promise, ...],
    *,
    name: str,
    designed_for: Actuator | None = None,
    swing: FreeSwing | None = None,
) -> Judgement:
    """Hold what is sent to the drive against its promises.

    Parameters
    ----------
    command
        The steps that are sent: a shaper, a whole command, a program as it is played.
    modes
        The modes of the plant.
    actuator
        The drive that is given.
    promises
        What is promised of the command, each with a limit.
    name
        What the command is called in a warning.
    designed_for
        The actuator for which the promises were made; the one given if left out.
    swing
        What the payload swings already at the first step.

    Returns
    -------
    Judgement
        Its certificate is not verified where a promise holds with neither actuator.

    Examples
    --------
    >>> import numpy as np
    >>> from design.model.actuators.first_order import FirstOrder
    >>> from design.model.actuators.ideal import Ideal
    >>> from design.claims import zeros
    >>> mode = Mode(natural_frequency_rad_s=3.5)
    >>> phases = np.pi * np.array([0, 1 / 3, 2 / 3])
    >>> umzv = Impulses(times_s=phases / 3.5, amplitudes=np.array([1.0, -1.0, 1.0]))
    >>> drive = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.3)
    >>> found = judge(umzv, (mode,), drive, zeros(["residual"]), name="umzv", designed_for=Ideal())
    >>> found.certificate.verified, found.for_ideal, found.warnings[0].code
    (True, True, 'actuator_ignored')
    """
    certificate = certify_modes(command, modes, actuator, promises, swing)
    failing = [claim for claim in certificate.claims if not claim.holds]
    warnings: tuple[DesignWarning, ...] = ()
    for_ideal = bool(failing) and designed_for is not None and designed_for != actuator
    if for_ideal and designed_for is not None:
        certificate = certify_modes(command, modes, designed_for, promises, swing)
        warnings = (
            DesignWarning(
                code="actuator_ignored",
                detail=f"{name} is made, and its claims are proven, for an actuator that follows "
                f"its command; with the one given {claims_in_words(failing, len(modes))}",
            ),
        )
    return Judgement(
        certificate=certificate,
        for_ideal=for_ideal,
        residuals=tuple(residual_vibration(command, mode, actuator, swing) for mode in modes),
        warnings=warnings,
    )


def sum_warnings(impulses: Impulses) -> Iterator[DesignWarning]:
    """Yield a warning for amplitudes whose sum is neither 1 nor 0.

    A shaper has the sum 1 or -1, a whole move 0, to nine digits.
    """
    total = float(impulses.amplitudes.sum())
    rounding = SUM_ROUNDING * max(1.0, float(np.abs(impulses.amplitudes).sum()))
    if min(abs(abs(total) - 1), abs(total)) > rounding:
        yield DesignWarning(
            code="sum_not_one",
            detail=f"the amplitudes add up to {total:.9g}: those of a shaper add up to 1, those of "
            "a whole move to 0; the residual is a share of what an unshaped step of height 1 does",
        )


def claims_in_words(claims: list[Claim], modes: int) -> str:
    """Return what claims found, each with its figure and its limit.

    Parameters
    ----------
    claims
        One or more.
    modes
        How many modes the plant has: of several, each claim says which it is about, from 0.

    Returns
    -------
    str
        Shares in per cent, derivatives as they are; parted by commas.
    """
    return ", ".join(_in_words(claim, modes) for claim in claims)


def _in_words(claim: Claim, modes: int) -> str:
    low, high = claim.band or (1.0, 1.0)
    shares = claim.quantity in {"residual", "band"}
    value = f"{100 * claim.value:.4g} %" if shares else f"{claim.value:.3g}"
    found = IN_WORDS[claim.quantity].format(value=value, low=low, high=high)
    if modes > 1:
        found += f" in mode {claim.mode}"
    return found + ("" if claim.is_zero else f", above {100 * claim.limit:.4g} %")


def shortfall_of(certificate: Certificate | None) -> str:
    """Return what does not hold, in words."""
    claims = () if certificate is None else certificate.claims
    return ", ".join(
        f"the {claim.quantity} is {claim.value:.3g}, allowed {claim.limit:g}"
        for claim in claims
        if not claim.holds
    )


def drive_warnings(
    command: Impulses, modes: tuple[Mode, ...], actuator: Actuator
) -> Iterator[DesignWarning]:
    """Yield what to know of the drive: early switches and slow sets.

    A switch is early if the step before it has not settled; a set is slow if its corner frequency
    is below twice the plant's.

    Parameters
    ----------
    command
        The steps that are sent.
    modes
        The modes of the plant, of which the fastest asks most of the drive.
    actuator
        The drive that is given.

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
        error = lag.step_error(max(gap - ramps_s[name], 0.0))
        if abs(error) > 1 - SETTLED_SHARE + SETTLED_MARGIN:
            yield DesignWarning(
                code="actuator_not_settled",
                detail=f"the {name} set has made {100 * (1 - error):.3g} % of switch {number} "
                f"when the next comes, {gap:.4g} s after it",
            )
    fastest = max(mode.natural_frequency_rad_s for mode in modes)
    for name, corner in actuator.corner_frequencies_rad_s.items():
        if corner < SLOW_ACTUATOR * fastest:
            yield DesignWarning(
                code="actuator_slow",
                detail=f"the {name} set's corner frequency, {corner:.4g} rad/s, is below twice the "
                f"plant's natural frequency, {fastest:.4g} rad/s",
            )
