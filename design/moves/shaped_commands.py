"""A command played through a shaper: every step of it is replaced by the shaper's steps.

The shaper is designed for a start from rest. Through a linear drive any command is shaped as well
as the start. Where a step that brakes is answered by another set than one that accelerates, the
stop has a residual that the start has not.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from design.analysis.certificate import TOLERANCE_MARGIN, Claim
from design.analysis.judge import judge
from design.analysis.warnings import DesignWarning
from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.model.commands import convolve
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import Design


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShapedCommand:
    """What is sent to the drive, judged.

    Attributes
    ----------
    impulses
        The command as it is played.
    warnings
        One where more remains than the shaper claims for each step of the command.
    """

    impulses: Impulses
    warnings: tuple[DesignWarning, ...]


def shaped_command(
    command: Impulses,
    found: Design,
    modes: tuple[Mode, ...],
    actuator: Actuator,
    claims: tuple[Claim, ...] | None = None,
) -> ShapedCommand:
    """Return a command through a shaper, held against the shaper's claims.

    Each step of the command may leave its height times what the shaper claims of a unit step; where
    all of them together leave more, a warning has the figure.

    Parameters
    ----------
    command
        Steps as shares of full speed.
    found
        The shaper, designed for this plant and actuator.
    modes, actuator
        The modes of the plant and its drive.
    claims
        What the shaper claims, where that is not what its certificate says: on samples it proves
        the residual that is left, whatever that is.

    Returns
    -------
    ShapedCommand
        The steps that are sent, with a warning where they break a claim.

    Raises
    ------
    InvalidInputError
        If all steps of the shaped command cancel.
    """
    claims = found.certificate.claims if claims is None else claims
    played = convolve(command, found.impulses)
    heights = float(np.abs(command.amplitudes).sum())
    promises = tuple(
        replace(promise, limit=heights * promise.limit) for promise in _of_one_step(claims)
    )
    judged = judge(played, modes, actuator, promises, name="the shaped command")
    by_itself = any(
        residual > promise.limit * (1 + TOLERANCE_MARGIN)
        for residual, promise in zip(found.residuals, _of_one_step(claims), strict=True)
    )
    warnings: tuple[DesignWarning, ...] = ()
    if not judged.certificate.verified:
        warnings = (_residual_warning(command, found, judged.residual, by_itself=by_itself),)
    return ShapedCommand(impulses=played, warnings=warnings)


def _of_one_step(claims: tuple[Claim, ...]) -> Iterator[Promise]:
    """Yield what a shaper claims of the residual at the nominal frequency of each mode."""
    for mode in sorted({claim.mode for claim in claims}):
        limits = [
            claim.limit
            for claim in claims
            if claim.mode == mode and claim.quantity in {"residual", "band"}
        ]
        yield Promise(quantity="residual", limit=min(limits), mode=mode)


def _residual_warning(
    command: Impulses, found: Design, residual: float, *, by_itself: bool
) -> DesignWarning:
    """Return why more remains than is claimed; ``by_itself``: the shaper of a step does so too."""
    remains = f"{100 * residual:.4g} % of an unshaped step remains after the last step"
    braking = int((~command.accelerates).sum())
    if found.for_ideal:
        return DesignWarning(
            code="actuator_ignored",
            detail="the shaper is made for an actuator that follows its command; "
            f"played with the one given, {remains}",
        )
    if by_itself:
        return DesignWarning(
            code="tolerance_not_kept",
            detail=f"on samples the shaper does not keep what it claims: {remains}",
        )
    if braking:
        return DesignWarning(
            code="stop_not_designed",
            detail="the shaper is designed for a start, and the drive brakes in another way than "
            f"it accelerates: the stop is not designed (steps that brake: {braking}), and "
            f"{remains}; a maneuver designs start and stop",
        )
    return DesignWarning(
        code="steps_not_designed",
        detail="the shaper is designed for one step from rest, and the steps of this command "
        f"act on each other in the drive: {remains}",
    )
