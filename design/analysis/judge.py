"""The one judge of what is sent to a drive: claims, for whom they hold, and what to know besides.

Designs, moves, shapers on samples, programs, shaped simulations and table rows all come here. A
claim is certified for the actuator that is given. Where it fails there, it is certified for the
actuator that the shaper was designed for, an ideal one, and a warning says what remains.
"""

from dataclasses import dataclass

from design.analysis.certificate import Certificate, certify_modes
from design.analysis.claims_in_words import claims_in_words
from design.analysis.residual import residual_vibration
from design.analysis.warnings import DesignWarning
from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.mode import Mode


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """What a command does, held against what is claimed of it."""

    # The claims, recomputed: for the actuator given if all of them hold there
    certificate: Certificate
    # Whether the certificate is for the actuator that the command was designed for, an ideal one,
    # in place of the one given
    for_ideal: bool
    residuals: tuple[float, ...]  # Residual vibration of each mode with the actuator given [-]
    # One for the claims that do not hold with the actuator given, if there are any
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
    command, modes
        The steps that are sent, a shaper, a whole command or a program as it is played; the modes
        of the plant.
    actuator, promises
        The drive that is given; what is promised of the command, each with a limit.
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
