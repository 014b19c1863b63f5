"""Unity magnitude for swings that are not small: exact at one full speed."""

import re
from dataclasses import dataclass, field

from design.checks import MAX_VALUE, MIN_VALUE, require_between
from design.errors import InvalidInputError
from design.formulations.formulation import Formulation
from design.formulations.large_swing import LargeSwingProblem
from design.model.plants.large_swing import LargeSwing
from design.model.plants.pendulum import Pendulum
from design.shapers.actuators import UNLIMITED_ACTUATORS
from design.shapers.kind import DesignCase, KindOf
from design.shapers.numzv import numzv
from design.shapers.numzvd import numzvd
from design.shapers.options import ShaperOptions
from design.shapers.peak_options import PeakOptions
from design.shapers.settle_options import SettleOptions

LEAST_ANGLE_RAD = 1e-3
"""Least small angle: of smaller ones doubles do not hold the share that is claimed [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LargeSwingOptions(ShaperOptions):
    """Parameters of steps for large swings.

    Attributes
    ----------
    speed_m_s
        Full speed, at which the steps are exact; None is refused: there is no usual one [m/s].
    slope
        Whether the residual is flat over the length of the cable too.
    """

    speed_m_s: float | None = field(
        default=None,
        metadata={
            "description": "Full speed at which the shaper is exact [m/s]; it must be given.",
            "examples": (1.0,),
            "ge": MIN_VALUE,
            "le": MAX_VALUE,
        },
    )
    slope: bool = field(
        default=False,
        metadata={"description": "Make the residual flat over the frequency too, as numzvd does."},
    )

    @property
    def steps(self) -> int:
        """How many steps up and down it has."""
        return 5 if self.slope else 3

    def __post_init__(self) -> None:
        if self.speed_m_s is not None:
            require_between("speed_m_s", self.speed_m_s, MIN_VALUE, MAX_VALUE)


def num_large(case: DesignCase[LargeSwingOptions]) -> Formulation:
    """Formulate steps up and down that leave nothing of a large swing.

    The times are those at which angle and rate vanish on the nonlinear crane at the speed given,
    and with slope their derivatives over ln w as well, with ``w^2 = g / L`` by the length.

    Returns
    -------
    Formulation
        A problem, with the linear one to begin from.

    Raises
    ------
    InvalidInputError
        If the plant is no pendulum, no speed is given, the load would not swing far at it, or it
        forgets the swing before the drive is at rest.
    """
    options, plant = case.options, case.plant
    if not isinstance(plant, Pendulum):
        raise InvalidInputError(
            "plant.kind",
            re.sub("(?<=[a-z])(?=[A-Z])", "_", type(plant).__name__).lower(),
            "pendulum for num_large: a large swing depends on length and gravity, which a mode "
            "does not say",
            code="large_swing_needs_pendulum",
        )
    if options.speed_m_s is None:
        raise InvalidInputError(
            "shaper.speed_m_s",
            None,
            "given: how far the load swings depends on the full speed",
            code="large_swing_needs_speed",
        )
    linear: Formulation
    if options.slope:
        of_slope = DesignCase(modes=case.modes, actuator=case.actuator, options=SettleOptions())
        linear = numzvd(of_slope)
    else:
        linear = numzv(DesignCase(modes=case.modes, actuator=case.actuator, options=PeakOptions()))
    swing = LargeSwing(crane=plant, speed_m_s=options.speed_m_s)
    swing.settled_s(case.actuator)  # refuses what cannot be followed back, ahead of any search
    if swing.small_angle_rad < LEAST_ANGLE_RAD:
        least = options.speed_m_s * LEAST_ANGLE_RAD / swing.small_angle_rad
        raise InvalidInputError(
            "shaper.speed_m_s",
            options.speed_m_s,
            f"at least {least:.4g} here: slower, the load swings by less than a thousandth of a "
            "radian, of which numzv and numzvd leave less than a millionth",
            code="swing_is_small",
        )
    return LargeSwingProblem(
        swing=swing,
        linear=linear,
        slope=options.slope,
        designed_for=case.actuator,
    )


NUM_LARGE = KindOf(
    name="num_large",
    summary="Unity magnitude for large swings of a pendulum: exact at one full speed.",
    source="Kim, master thesis (2011), eq. 2.1 for the swing, chapter 3 for the steps",
    claims=("residual",),
    options=LargeSwingOptions,
    actuators=UNLIMITED_ACTUATORS,
    formulation=num_large,
    large_swings=True,
)
