"""A second opinion on what a shaper claims, by simulation and apart from what the solver saw."""

from dataclasses import dataclass

import numpy as np

from design.actuators import Actuator
from design.exponential import exponentials
from design.impulses import Impulses
from design.plants import Mode
from design.shapers.kind import Quantity
from design.simulation import ringing_after
from design.swings import FreeSwing
from design.types import FloatArray

LIMITS: dict[Quantity, float] = {"residual": 1e-9, "slope": 1e-7}
"""Largest value that counts as zero: far below anything measurable, above rounding [-]."""

STEP_PHASE_RAD = 2e-5
"""Turn of the last impulse's phase over a step of the slope's central difference [rad].

Truncation is ``step^2 phase^3 / 6``, rounding 1e-16 / step: both stay below half the limit of the
slope up to a hundred periods.
"""

METHOD = (
    "state of actuator and mode carried from step to step by matrix exponential; "
    "slope by differencing that in frequency"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """One promise of a shaper, with the value found for it.

    Attributes
    ----------
    quantity
        ``residual`` [-], or ``slope``: its vector's change per relative change of frequency [-].
    value
        As recomputed [-].
    limit
        The claim holds if ``value <= limit`` [-].
    """

    quantity: Quantity
    value: float
    limit: float

    @property
    def holds(self) -> bool:
        """Whether the value is within the limit (not a number is not)."""
        return self.value <= self.limit


@dataclass(frozen=True, slots=True, kw_only=True)
class Certificate:
    """Every claim of a shaper, recomputed."""

    claims: tuple[Claim, ...]
    method: str = METHOD

    @property
    def verified(self) -> bool:
        """Whether every claim holds."""
        return all(claim.holds for claim in self.claims)


def certify(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    quantities: tuple[Quantity, ...],
    swing: FreeSwing | None = None,
) -> Certificate:
    """Recompute the claims of a shaper for the actuator that it was designed for.

    Parameters
    ----------
    impulses
        The shaper.
    mode, actuator
        What it was designed for.
    quantities
        What it claims to be zero.
    swing
        What the payload swings already at the first step.
    """
    offsets = np.array([0.0, -1.0, 1.0]) if "slope" in quantities else np.zeros(1)
    lasting_s = impulses.duration_s + (0.0 if swing is None else swing.delay_s)
    step = STEP_PHASE_RAD / max(1.0, mode.natural_frequency_rad_s * lasting_s)
    ratios = 1 + step * offsets
    frequencies = mode.natural_frequency_rad_s * ratios
    initial = None if swing is None else _initial_state(swing, mode, ratios)
    ringing, unit = ringing_after(impulses, actuator, frequencies, mode.damping_ratio, initial)
    unshaped = abs(unit[0])
    values = {"residual": abs(ringing[0]) / unshaped}
    if "slope" in quantities:
        # From the modal coordinate at the last step back to V(w), whose origin is the first step.
        vectors = ringing[1:] * np.exp(-(mode.pole_rad_s * (ratios[1:] - 1)) * impulses.duration_s)
        values["slope"] = abs(vectors[1] - vectors[0]) / (2 * step) / unshaped
    return Certificate(
        claims=tuple(
            Claim(quantity=name, value=float(values[name]), limit=LIMITS[name])
            for name in quantities
        )
    )


def _initial_state(swing: FreeSwing, mode: Mode, ratios: FloatArray) -> FloatArray:
    """Return ``q, q'/w`` of the mode at each ratio of frequencies, shape (f, 2).

    The deflection is ``-q'/w^2``, and its rate ``q - v + 2 z q'/w``, at v = 0. During the dead time
    of the actuator it moves freely.
    """
    z, w = mode.damping_ratio, mode.natural_frequency_rad_s * ratios
    deflection, rate = np.multiply.outer(
        (swing.deflection_s, swing.rate), ratios**swing.frequency_power
    )
    turned = -w * deflection
    state = np.column_stack((rate - 2 * z * turned, turned))
    free = np.array([[0.0, 1.0], [-1.0, -2 * z]])
    freely: FloatArray = exponentials(swing.delay_s * w[:, None, None] * free)
    moved: FloatArray = (freely @ state[..., None])[..., 0]
    return moved
