"""Specified insensitivity: a band and a tolerance in, the fastest shaper that keeps them out."""

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal, Self

from design.band import USUAL_HALF_WIDTH, ends_of, require_said_once
from design.checks import require_between
from design.claims import within
from design.errors import InvalidInputError
from design.formulations.bands import BandProblem, PoleBand
from design.model.actuators.registry import Actuator
from design.shapers.actuators import UNLIMITED_ACTUATORS
from design.shapers.kind import DesignCase, KindOf
from design.shapers.options import ShaperOptions
from design.shapers.settle_options import MAX_HORIZON_PERIODS, MIN_HORIZON_PERIODS

MIN_HALF_WIDTH, MAX_HALF_WIDTH = 0.01, 0.9
"""Bounds of half the band's width over its centre: beyond them shapers take tens of periods [-]."""

MIN_RATIO, MAX_RATIO = 0.01, 100.0
"""Bounds of the band's ends [-]."""

MIN_TOLERANCE = 1e-3
"""Below it the peaks that hold the optimum differ by what the cone program cannot tell [-]."""

MAX_LEVEL = 10.0
"""Farthest limit of the command from 0 and 1, in cruise speeds [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BandOptions(ShaperOptions):
    """Band, tolerance and limits.

    Attributes
    ----------
    half_width
        The band is ``1 - half_width`` to ``1 + half_width`` [-]; None if its ends are given, and
        0.15 if they are not either.
    lower_ratio, upper_ratio
        Its ends, true frequency over the nominal one [-]; None with ``half_width``.
    tolerance
        Largest residual over the band [-].
    amplitudes
        ``positive``, or of both signs within the limits of the command.
    lowest_command, highest_command
        Limits of the command over its cruise speed, for amplitudes of both signs [-].
    max_duration_periods
        Longest shaper, in undamped periods of the plant [-].
    """

    half_width: float | None = field(
        default=None,
        metadata={
            "description": "The band is 1 - half_width to 1 + half_width of the natural "
            f"frequency; {USUAL_HALF_WIDTH} if neither it nor the ratios are given.",
            "ge": MIN_HALF_WIDTH,
            "le": MAX_HALF_WIDTH,
        },
    )
    lower_ratio: float | None = field(
        default=None,
        metadata={
            "description": "Lower end of the band over the natural frequency, in place of "
            "half_width.",
            "ge": MIN_RATIO,
            "le": MAX_RATIO,
        },
    )
    upper_ratio: float | None = field(
        default=None,
        metadata={
            "description": "Upper end of the band, with lower_ratio.",
            "ge": MIN_RATIO,
            "le": MAX_RATIO,
        },
    )
    tolerance: float = field(
        default=0.05,
        metadata={
            "description": "Largest residual over the band.",
            "ge": MIN_TOLERANCE,
            "lt": 1.0,
        },
    )
    amplitudes: Literal["positive", "negative"] = field(
        default="positive",
        metadata={
            "description": "positive; or negative, which allows both signs within the limits of "
            "the command, behind ideal or symmetric actuators."
        },
    )
    lowest_command: float = field(
        default=0.0,
        metadata={
            "description": "Lowest command over its cruise speed, for negative amplitudes.",
            "ge": -MAX_LEVEL,
            "le": 0.0,
        },
    )
    highest_command: float = field(
        default=1.0,
        metadata={
            "description": "Highest command over its cruise speed, for negative amplitudes.",
            "ge": 1.0,
            "le": 1.0 + MAX_LEVEL,
        },
    )
    max_duration_periods: float = field(
        default=10.0,
        metadata={
            "description": "Longest shaper, in undamped periods of the plant.",
            "ge": MIN_HORIZON_PERIODS,
            "le": MAX_HORIZON_PERIODS,
        },
    )

    BAND_FIELDS: ClassVar[tuple[str, ...]] = ("half_width", "lower_ratio", "upper_ratio")

    def __post_init__(self) -> None:
        if not MIN_TOLERANCE <= self.tolerance < 1:
            raise InvalidInputError(
                "tolerance",
                self.tolerance,
                f"at least {MIN_TOLERANCE:g} and below 1",
                code="out_of_range",
            )
        require_between("lowest_command", self.lowest_command, -MAX_LEVEL, 0.0)
        require_between("highest_command", self.highest_command, 1.0, 1.0 + MAX_LEVEL)
        require_between(
            "max_duration_periods",
            self.max_duration_periods,
            MIN_HORIZON_PERIODS,
            MAX_HORIZON_PERIODS,
        )
        if self.amplitudes == "positive":
            for name, usual in (("lowest_command", 0.0), ("highest_command", 1.0)):
                if getattr(self, name) != usual:
                    raise InvalidInputError(
                        name,
                        getattr(self, name),
                        f"{usual:g} for positive amplitudes, whose command rises from 0 to 1",
                        code="option_of_unity_magnitude",
                    )
        self._require_band()

    def with_band(self, half_width: float) -> Self:
        """Return the same with a band of a half width around 1."""
        return replace(self, half_width=half_width)

    def _require_band(self) -> None:
        require_said_once(self)
        if self.half_width is not None:
            require_between("half_width", self.half_width, MIN_HALF_WIDTH, MAX_HALF_WIDTH)
            return
        require_ends(self.band, ("lower_ratio", "upper_ratio"))

    @property
    def band(self) -> tuple[float, float]:
        """Ends of the band [-]."""
        return ends_of(self)

    @property
    def levels(self) -> tuple[float, float] | None:
        """Limits of the command; None for positive amplitudes [-]."""
        if self.amplitudes == "positive":
            return None
        return self.lowest_command, self.highest_command


def require_ends(band: tuple[float, float], names: tuple[str, str]) -> None:
    """Check the ends of a band.

    Parameters
    ----------
    band, names
        Lower and upper ratio, and what they are called [-].

    Raises
    ------
    InvalidInputError
        If one is out of range, or the band is too narrow or too wide.
    """
    lower, upper = band
    require_between(names[0], lower, MIN_RATIO, MAX_RATIO)
    require_between(names[1], upper, MIN_RATIO, MAX_RATIO)
    narrow, wide = ((1 + h) / (1 - h) for h in (MIN_HALF_WIDTH, MAX_HALF_WIDTH))
    # The quotient of 1 + h and 1 - h is off by a rounding.
    if not narrow * (1 - 1e-12) <= upper / lower <= wide * (1 + 1e-12):
        raise InvalidInputError(
            names[1],
            upper,
            f"{narrow:.4g} to {wide:.4g} times {names[0]}, {lower!r}",
            code="band_too_narrow_or_wide",
        )


def require_sets_serve(options: BandOptions, actuator: Actuator) -> None:
    """Check that an actuator has one G for amplitudes of both signs.

    Parameters
    ----------
    options, actuator
        Of the shaper, and what drives it.

    Raises
    ------
    InvalidInputError
        For negative amplitudes behind an actuator whose two sets differ.
    """
    if options.amplitudes == "negative" and actuator.accel_lag != actuator.decel_lag:
        raise InvalidInputError(
            "shaper.amplitudes",
            options.amplitudes,
            "positive behind an actuator whose accelerating and decelerating sets differ",
            code="sets_differ",
        )


def specified_insensitivity(case: DesignCase[BandOptions]) -> BandProblem:
    """Formulate the fastest convex shaper within a tolerance over a band.

    Positive amplitudes use the acceleration set alone, whose G is then a common factor: the shaper
    holds behind every actuator without limits to its rate. Amplitudes of both signs need a G in
    common, so that the two sets must be equal: else the problem is not convex, and no bound to its
    duration can be proved.

    Returns
    -------
    BandProblem
        In phases of the mode.

    Raises
    ------
    InvalidInputError
        For negative amplitudes behind an actuator whose two sets differ.
    """
    mode, actuator, options = case.mode, case.actuator, case.options
    require_sets_serve(options, actuator)
    return BandProblem(
        bands=(PoleBand(unit_pole=mode.unit_pole, lower=options.band[0], upper=options.band[1]),),
        natural_frequency_rad_s=mode.natural_frequency_rad_s,
        tolerance=options.tolerance,
        levels=options.levels,
        horizon_rad=options.max_duration_periods * 2 * math.pi,
        designed_for=actuator,
        claims=(within(options.tolerance, options.band),),
    )


SI = KindOf(
    name="si",
    summary="Minimum time, residual within a tolerance over a band: positive, or within limits.",
    source="W. Singhose, W. Seering, N. Singer, Input shaping for vibration reduction with "
    "specified insensitivity to modeling errors, Japan-USA Symp. Flexible Automation (1996)",
    claims=("band",),
    options=BandOptions,
    actuators=UNLIMITED_ACTUATORS,
    formulation=specified_insensitivity,
)
