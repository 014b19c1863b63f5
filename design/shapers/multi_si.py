"""Specified insensitivity for several modes: the fastest shaper within a tolerance over each band.

Bands and tolerance are as of `design.shapers.specified_insensitivity`, with a band around each
mode. Shapers of the single modes, convolved, keep the tolerance too, since positive amplitudes
amplify nothing; none is faster than the one found here.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import ClassVar

from design.band import half_said, said_twice
from design.checks import require_between
from design.claims import within
from design.errors import InvalidInputError
from design.formulations.bands import BandProblem, bands_of
from design.model.plants.modes import MAX_MODES
from design.shapers.actuators import UNLIMITED_ACTUATORS
from design.shapers.kind import DesignCase, KindOf
from design.shapers.specified_insensitivity import (
    MAX_HALF_WIDTH,
    MIN_HALF_WIDTH,
    BandOptions,
    require_ends,
    require_sets_serve,
)

OF_EACH_MODE = ("half_widths", "lower_ratios", "upper_ratios")
"""Options with a value for each mode."""

OF_ALL_MODES = ("half_width", "lower_ratio", "upper_ratio")
"""Options that are for all modes alike."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BandsOptions(BandOptions):
    """Bands, tolerance and limits.

    Attributes
    ----------
    half_widths
        Half width of each mode's band, in the order of the modes [-]; None where all have one, or
        the ends are given.
    lower_ratios, upper_ratios
        Ends of each mode's band, true frequency over the nominal one [-]; None with the others.
    """

    half_widths: tuple[float, ...] | None = field(
        default=None,
        metadata={
            "description": "Half width of each mode's band, in the order of the modes, in place of "
            "half_width.",
            "strict": False,
            "min_length": 1,
            "max_length": MAX_MODES,
        },
    )
    lower_ratios: tuple[float, ...] | None = field(
        default=None,
        metadata={
            "description": "Lower end of each mode's band over its natural frequency, with "
            "upper_ratios, in place of lower_ratio.",
            "strict": False,
            "min_length": 1,
            "max_length": MAX_MODES,
        },
    )
    upper_ratios: tuple[float, ...] | None = field(
        default=None,
        metadata={
            "description": "Upper end of each mode's band over its natural frequency, with "
            "lower_ratios, in place of upper_ratio.",
            "strict": False,
            "min_length": 1,
            "max_length": MAX_MODES,
        },
    )

    BAND_FIELDS: ClassVar[tuple[str, ...]] = (*OF_ALL_MODES, *OF_EACH_MODE)

    def __post_init__(self) -> None:
        BandOptions.__post_init__(self)
        self._require_one_way()
        for number, half_width in enumerate(self.half_widths or ()):
            require_between(f"half_widths.{number}", half_width, MIN_HALF_WIDTH, MAX_HALF_WIDTH)
        lower, upper = self.lower_ratios or (), self.upper_ratios or ()
        for number, ends in enumerate(zip(lower, upper, strict=True)):
            require_ends(ends, (f"lower_ratios.{number}", f"upper_ratios.{number}"))

    def _require_one_way(self) -> None:
        """Raise InvalidInputError where bands are said twice, or by one end of theirs."""
        given = [name for name in self.BAND_FIELDS if getattr(self, name) is not None]
        ways = {name: name.removeprefix("lower_").removeprefix("upper_") for name in given}
        for name in given[1:]:
            if ways[name] != ways[given[0]]:
                raise said_twice(name, _as_given(getattr(self, name)), given[0])
        lower, upper = self.lower_ratios, self.upper_ratios
        if (lower is None) != (upper is None):
            missing = "lower_ratios" if lower is None else "upper_ratios"
            raise half_said(missing)
        if lower is not None and upper is not None and len(lower) != len(upper):
            raise InvalidInputError(
                "upper_ratios",
                list(upper),
                f"as many as lower_ratios, {len(lower)}",
                code="bands_differ_in_number",
            )

    def bands(self, modes: int) -> tuple[tuple[float, float], ...]:
        """Return the ends of each mode's band.

        Parameters
        ----------
        modes
            Number of modes.

        Returns
        -------
        tuple of tuple of float
            Lower and upper ratio of each [-].

        Raises
        ------
        InvalidInputError
            If bands are given of more modes, or of fewer.
        """
        for name in OF_EACH_MODE:
            given = getattr(self, name)
            if given is not None and len(given) != modes:
                raise InvalidInputError(
                    f"shaper.{name}",
                    list(given),
                    f"one for each mode of the plant in their order, {modes} in all",
                    code="bands_of_other_modes",
                )
        return tuple(self._ends(modes))

    def _ends(self, modes: int) -> Iterator[tuple[float, float]]:
        if self.half_widths is not None:
            yield from ((1 - half, 1 + half) for half in self.half_widths)
        elif self.lower_ratios is not None and self.upper_ratios is not None:
            yield from zip(self.lower_ratios, self.upper_ratios, strict=True)
        else:
            yield from modes * [self.band]


def _as_given(value: float | tuple[float, ...]) -> float | list[float]:
    """Return an option as it is written on the wire."""
    return list(value) if isinstance(value, tuple) else value


def multi_si(case: DesignCase[BandsOptions]) -> BandProblem:
    """Formulate the fastest convex shaper over a band around each mode.

    Amplitudes are as of `si`. Bands of modes may overlap.

    Returns
    -------
    BandProblem
        In phases of the slowest mode.

    Raises
    ------
    InvalidInputError
        For negative amplitudes behind an actuator whose two sets differ, or if there are not as
        many bands as modes.
    """
    modes, actuator, options = case.modes, case.actuator, case.options
    require_sets_serve(options, actuator)
    ends = options.bands(len(modes))
    return BandProblem(
        bands=bands_of(modes, ends),
        natural_frequency_rad_s=min(mode.natural_frequency_rad_s for mode in modes),
        tolerance=options.tolerance,
        levels=options.levels,
        horizon_rad=options.max_duration_periods * 2 * math.pi,
        designed_for=actuator,
        claims=tuple(
            replace(within(options.tolerance, band), mode=number)
            for number, band in enumerate(ends)
        ),
    )


MULTI_SI = KindOf(
    name="multi_si",
    summary="Minimum time, residual within a tolerance over a band around each of up to six modes: "
    "positive, or within limits.",
    source='W. Singhose, E. Crain, W. Seering, "Convolved and simultaneous two-mode input '
    'shapers", IEE Proc. Control Theory Appl. 144 (1997), with the bands of W. Singhose, '
    'W. Seering, N. Singer, "Input shaping for vibration reduction with specified insensitivity to '
    'modeling errors", Japan-USA Symp. Flexible Automation (1996)',
    claims=("band",),
    options=BandsOptions,
    actuators=UNLIMITED_ACTUATORS,
    formulation=multi_si,
    most_modes=MAX_MODES,
)
