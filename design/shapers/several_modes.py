"""Shapers for several modes at once: jointly in minimum time, or one shaper after another."""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from design.errors import InvalidInputError
from design.formulations.behind_limits import behind_limits
from design.formulations.equations import GapProblem
from design.formulations.formulation import ClosedForm, Convolution, Formulation, JointProblem
from design.formulations.ramped import RampedProblem
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.modes import MAX_MODES
from design.shapers.actuators import EVERY_ACTUATOR_BY_ITS_LAG
from design.shapers.damping import require_modes_damped
from design.shapers.ei import EI, THREE_HUMP_EI, TWO_HUMP_EI, ToleranceOptions
from design.shapers.kind import DesignCase, KindOf, ShaperKind
from design.shapers.options import MAX_TOLERANCE, MIN_TOLERANCE, NoOptions, ShaperOptions
from design.shapers.positive import MZV, ZV, ZVD, ZVDD, ZVDDD, exact_actuator
from design.shapers.umzv import UMZV, UMZVD

BASES: dict[str, ShaperKind] = {
    kind.name: kind
    for kind in (ZV, ZVD, ZVDD, ZVDDD, MZV, EI, TWO_HUMP_EI, THREE_HUMP_EI, UMZV, UMZVD)
}
"""What may be convolved: a zero stays one; a tolerance holds as positive shapers amplify nothing.

Steps of shapers for asymmetric actuators would change their sets.
"""


FREQUENCIES_PER_RADIAN = 10.0
"""Frequencies at which a band is simulated, a radian of the turn of the last impulse over it."""

MAX_DECAY_NEPERS = 24.0
"""Nepers that a mode may decay by within half a period of the slowest: 4e-11 of a swing is left.

By then what a joint shaper does early is in that mode below what counts as zero at its end, and no
search shows where it should be. Of random plants all are solved up to 8, none from here on [-].
"""

MAX_PERIODS_PER_MODE = 10.0
"""Longest command behind limits without its ramps, in periods of the slowest mode [-]."""

MAX_BAND_WORK = 4e6
"""Work of proving bands, at most: as much as a search may take [units]."""


def joint(
    modes: tuple[Mode, ...], actuator: Actuator, *, positive: bool
) -> JointProblem | RampedProblem | UnequalRampsProblem:
    """Formulate the fastest command without vibration in all modes.

    Positive steps share the acceleration set's G in each mode, so they are exact for every actuator
    that follows steps; steps up and down are for one that follows its command, or for limits that
    one lag follows.

    Parameters
    ----------
    modes
        The modes of the plant, one or more.
    actuator
        What is given; without limits where steps are positive.
    positive
        Whether all steps are above 0; else the command stays within 0 to 1.

    Returns
    -------
    JointProblem, RampedProblem or UnequalRampsProblem
        In phases of the slowest mode; the others of steps up and down behind limits.

    Raises
    ------
    InvalidInputError
        If one of several modes decays too fast beside the slowest.
    """
    w = min(mode.natural_frequency_rad_s for mode in modes)
    for number, mode in enumerate(modes):
        decay = math.pi * mode.damping_ratio * mode.natural_frequency_rad_s / w
        if len(modes) > 1 and decay > MAX_DECAY_NEPERS:
            raise InvalidInputError(
                f"plant.modes.{number}.damping_ratio",
                mode.damping_ratio,
                f"at most {MAX_DECAY_NEPERS * w / math.pi / mode.natural_frequency_rad_s:.4g} for "
                f"{'multi_zv' if positive else 'multi_umzv'}: beyond it the mode's swing decays by "
                f"more than {MAX_DECAY_NEPERS:g} nepers within half a period of the slowest mode; "
                "convolved serves such modes",
                code="mode_decays_too_fast",
            )
    if not positive and isinstance(actuator, RateLimited):
        return behind_limits(
            modes,
            actuator,
            derivatives=0,
            max_duration_periods=MAX_PERIODS_PER_MODE * len(modes),
        )
    return JointProblem(
        unit_poles=np.array([mode.pole_rad_s / w for mode in modes], dtype=np.complex128),
        natural_frequency_rad_s=w,
        positive=positive,
        designed_for=exact_actuator(actuator) if positive else Ideal(),
    )


def multi_zv(case: DesignCase[NoOptions]) -> Formulation:
    """Formulate positive impulses that leave nothing in any mode."""
    return joint(case.modes, case.actuator, positive=True)


def multi_umzv(case: DesignCase[NoOptions]) -> Formulation:
    """Formulate steps between 0 and 1 that leave nothing in any mode."""
    return joint(case.modes, case.actuator, positive=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvolvedOptions(ShaperOptions):
    """Which shapers are convolved.

    Attributes
    ----------
    base
        Kind of shaper of each mode.
    tolerance
        Its tolerance, if it takes one; 0.05 if not given [-].
    """

    base: Literal[
        "zv",
        "zvd",
        "zvdd",
        "zvddd",
        "mzv",
        "ei",
        "two_hump_ei",
        "three_hump_ei",
        "umzv",
        "umzvd",
    ] = field(default="zv", metadata={"description": "Kind of shaper of each mode."})
    tolerance: float | None = field(
        default=None,
        metadata={
            "description": "For the ei kinds: residual that each hump reaches, 0.05 if not given.",
            "ge": MIN_TOLERANCE,
            "le": MAX_TOLERANCE,
        },
    )

    def __post_init__(self) -> None:
        if self.base not in BASES:
            raise InvalidInputError(
                "base", self.base, f"one of {', '.join(BASES)}", code="base_not_served"
            )
        if self.tolerance is not None:
            if BASES[self.base].options is not ToleranceOptions:
                raise InvalidInputError(
                    "tolerance",
                    self.tolerance,
                    f"left out: {self.base} takes none",
                    code="base_takes_no_tolerance",
                )
            ToleranceOptions(tolerance=self.tolerance)


def impulses_of(parts: tuple[Formulation, ...]) -> int:
    """Return how many impulses convolved shapers have, before they are solved."""
    counts = [
        part.impulses.times_s.size if isinstance(part, ClosedForm) else part.amplitudes.size
        for part in parts
        if isinstance(part, ClosedForm | GapProblem)  # as all bases are
    ]
    return math.prod(counts)


def _require_provable(
    base: ShaperKind, parts: tuple[Formulation, ...], modes: tuple[Mode, ...], actuator: Actuator
) -> None:
    """Refuse impulses whose bands take too long to prove, at the frequencies that they need."""
    duration = sum(part.impulses.duration_s for part in parts if isinstance(part, ClosedForm))
    radians = sum(
        duration * mode.natural_frequency_rad_s * (claim.band[1] - claim.band[0])
        for mode, part in zip(modes, parts, strict=True)
        for claim in part.claims
        if claim.band is not None
    )
    impulses, frequencies = impulses_of(parts), FREQUENCIES_PER_RADIAN * radians
    each = actuator.PROOF_WORK
    if each * impulses * frequencies > MAX_BAND_WORK:
        raise InvalidInputError(
            "shaper.base",
            base.name,
            f"of fewer impulses for these {len(modes)} modes: convolved they are {impulses}, "
            f"which are simulated at some {frequencies:.0f} frequencies to prove their bands. "
            f"Behind an actuator of kind {actuator.kind} the product of the two is at most "
            f"{MAX_BAND_WORK / each:.2g}",
            code="too_many_convolved",
        )


def formulate_convolved(case: DesignCase[ConvolvedOptions]) -> Convolution:
    """Formulate a shaper for each mode, each shaping the one before.

    Returns
    -------
    Convolution
        A part for each mode.

    Raises
    ------
    InvalidInputError
        If a mode is damped more than the base serves, or too many impulses would have to be
        certified.
    """
    modes, actuator, options = case.modes, case.actuator, case.options
    base = BASES[options.base]
    require_modes_damped(base.name, base.damping, modes)
    own = base.options()
    if options.tolerance is not None:
        own = ToleranceOptions(tolerance=options.tolerance)
    parts = tuple(base.formulate(base.case((mode,), actuator, own)) for mode in modes)
    _require_provable(base, parts, modes, actuator)
    return Convolution(parts=parts, zeros_of_parts=base.claims, designed_for=parts[0].designed_for)


BANG_BANG = (
    'L. Y. Pao, "Minimum-time control characteristics of flexible structures", J. Guidance, '
    "Control, and Dynamics 19 (1996); bound: a dual function of time"
)

MULTI_ZV = KindOf(
    name="multi_zv",
    summary="Positive impulses, zero vibration in each of up to six modes, in minimum time.",
    source='W. Singhose, E. Crain, W. Seering, "Convolved and simultaneous two-mode input '
    'shapers", IEE Proc. Control Theory Appl. 144 (1997); bound: a dual function of time',
    claims=("residual",),
    options=NoOptions,
    actuators=EVERY_ACTUATOR_BY_ITS_LAG,
    formulation=multi_zv,
    most_modes=MAX_MODES,
)

MULTI_UMZV = KindOf(
    name="multi_umzv",
    summary="Unity magnitude, zero vibration in each of up to six modes, in minimum time, for an "
    "actuator that follows its command.",
    source=BANG_BANG,
    claims=("residual",),
    options=NoOptions,
    actuators=EVERY_ACTUATOR_BY_ITS_LAG,
    formulation=multi_umzv,
    most_modes=MAX_MODES,
)

CONVOLVED = KindOf(
    name="convolved",
    summary="A shaper for each of up to six modes, convolved; of unity magnitude only where the "
    "command stays between 0 and 1.",
    source='W. Singhose, E. Crain, W. Seering, "Convolved and simultaneous two-mode input '
    'shapers", IEE Proc. Control Theory Appl. 144 (1997)',
    claims=("residual",),
    options=ConvolvedOptions,
    actuators=EVERY_ACTUATOR_BY_ITS_LAG,
    formulation=formulate_convolved,
    most_modes=MAX_MODES,
)
