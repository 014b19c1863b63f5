"""The one judge of what is sent to a drive: claims, for whom they hold, and what to know besides.

Designs, moves, shapers on samples, programs, shaped simulations and table rows all come here. A
claim is certified for the actuator that is given. Where it fails there, it is certified for the
actuator that the shaper was designed for, an ideal one, and a warning says what remains.
"""

from dataclasses import dataclass

from design.analysis.certificate import Certificate, certify_modes
from design.analysis.claims_found import claims_in_words
from design.analysis.residual import residual_vibration
from design.analysis.warnings import DesignWarning, actuator_ignored
from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing
from design.model.plants.large_swing import SwingFigures
from design.model.plants.mode import Mode


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """What a command does, held against what is claimed of it."""

    certificate: Certificate  # The claims, recomputed: for the actuator given if all hold there
    for_ideal: bool  # Whether it is for the actuator designed for, an ideal one, not that given
    residuals: tuple[float, ...]  # Residual vibration of each mode with the actuator given [-]
    warnings: tuple[DesignWarning, ...]  # One for claims that do not hold with the one given
    large_swing: SwingFigures | None = None  # Of a shaper for swings that are not small

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
        The steps that are sent, and the modes of the plant.
    actuator, designed_for
        The drive that is given, and the one for which promises were made; the same if left out.
    promises, name
        What is promised of the command, and what the command is called in a warning.
    swing
        What the payload swings already at the first step.

    Returns
    -------
    Judgement
        Its certificate is not verified where a promise holds with neither actuator.
    """
    certificate = certify_modes(command, modes, actuator, promises, swing)
    failing = [claim for claim in certificate.claims if not claim.holds]
    warnings: tuple[DesignWarning, ...] = ()
    for_ideal = bool(failing) and designed_for is not None and designed_for != actuator
    if for_ideal and designed_for is not None:
        certificate = certify_modes(command, modes, designed_for, promises, swing)
        warnings = (actuator_ignored(name, claims_in_words(failing, len(modes))),)
    return Judgement(
        certificate=certificate,
        for_ideal=for_ideal,
        residuals=tuple(residual_vibration(command, mode, actuator, swing) for mode in modes),
        warnings=warnings,
    )
