"""A residual within a tolerance over a band of frequencies, in least time."""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from design.claims import Promise, within
from design.formulations.seeds import Seed
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.types import ComplexArray, FloatArray, IntArray, Symbolic


@dataclass(frozen=True, slots=True, kw_only=True)
class PoleBand:
    """Where the pole of a mode may be: at a nominal pole times any ratio of a band.

    Attributes
    ----------
    unit_pole
        The nominal pole over the frequency that turns phases into times [-].
    lower, upper
        Least and largest ratio of the true frequency to the nominal one [-].
    """

    unit_pole: complex
    lower: float
    upper: float

    @property
    def width(self) -> float:
        """From one end to the other [-]."""
        return self.upper - self.lower


def bands_of(
    modes: tuple[Mode, ...], ends: tuple[tuple[float, float], ...]
) -> tuple[PoleBand, ...]:
    """Return the bands of modes, in phases of the slowest.

    Bands that overlap are one where the modes have one damping ratio: a peak in both would be
    counted twice, and no condition would say how much each of the two costs.

    Parameters
    ----------
    modes
        The modes.
    ends
        Least and largest ratio of the true frequency to the nominal one, of each mode [-].

    Returns
    -------
    tuple of PoleBand
        One for each mode or fewer.
    """
    slowest_rad_s = min(mode.natural_frequency_rad_s for mode in modes)
    scales = [mode.natural_frequency_rad_s / slowest_rad_s for mode in modes]
    own = [
        (mode, scale * mode.unit_pole, lower, upper)
        for mode, scale, (lower, upper) in zip(modes, scales, ends, strict=True)
    ]
    own.sort(key=lambda one: (one[0].damping_ratio, abs(one[1]) * one[2]))
    bands: list[PoleBand] = []
    damping: float | None = None
    for mode, pole, lower, upper in own:
        size = abs(pole)
        if bands and mode.damping_ratio == damping:
            before = bands[-1]
            reach = abs(before.unit_pole)
            if size * lower <= reach * before.upper:
                end = max(before.upper, size * upper / reach)
                bands[-1] = replace(before, upper=end)
                continue
        damping = mode.damping_ratio
        bands.append(PoleBand(unit_pole=pole, lower=lower, upper=upper))
    return tuple(bands)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandProblem:
    """The fastest shaper whose residual stays within a tolerance over bands.

    Attributes
    ----------
    bands
        One for each mode, or fewer where bands of modes overlap.
    natural_frequency_rad_s
        Turns phases into times: that of the slowest mode [rad/s].
    tolerance
        Largest residual over the bands [-].
    levels
        Lowest and highest level of the command, at most 0 and at least 1; None for positive
        amplitudes, which need no limits.
    horizon_rad
        Longest duration [rad].
    designed_for
        The actuator of the claims.
    claims
        The tolerance over the band of each mode.
    """

    bands: tuple[PoleBand, ...]
    natural_frequency_rad_s: float
    tolerance: float
    levels: tuple[float, float] | None
    horizon_rad: float
    designed_for: Actuator
    claims: tuple[Promise, ...]

    def poles_at(self, bands: IntArray, ratios: FloatArray) -> ComplexArray:
        """Return poles over the problem's frequency.

        Parameters
        ----------
        bands, ratios
            Numbers of bands, and ratios within them, shape (k,).

        Returns
        -------
        ComplexArray
            shape (k,) [-].
        """
        unit_poles = np.array([one.unit_pole for one in self.bands], dtype=np.complex128)
        poles: ComplexArray = unit_poles[bands] * ratios
        return poles

    @property
    def asked(self) -> str:
        """What is to be kept, in words."""
        if len(self.claims) == 1:
            ((lower, upper),) = (one.band or (1.0, 1.0) for one in self.claims)
            return (
                f"a residual within {self.tolerance:g} from {lower:g} to {upper:g} of the natural "
                "frequency"
            )
        return (
            f"a residual within {self.tolerance:g} over a band of each of {len(self.claims)} modes"
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Obstacle:
    """What stands against a duration: a function of time that no shaper so short can pass.

    ``p(u) = Re sum_k y_k exp(s_k u)``, u back from the last impulse. A shaper within the tolerance
    V over the bands has ``sum A_i p(u_i) <= V sum |y_k|``, whatever the y.

    Attributes
    ----------
    duration_rad
        The duration that it excludes, and all below [rad].
    unit_poles
        s, each within a band, over the problem's frequency, shape (k,) [-].
    vectors
        y, shape (k,), complex [-].
    """

    duration_rad: float
    unit_poles: ComplexArray
    vectors: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True)
class BandExpressions:
    """CasADi expressions of what impulses leave at one frequency of a band, all dimensionless.

    Attributes
    ----------
    unknowns
        Gaps between the impulses times the plant's natural frequency, shape (n - 1,) [rad].
    parameters
        What differs from one design to the next, shape (p,).
    ratio
        The plant's frequency over its nominal value.
    vibration
        Real and imaginary part of the residual's vector there, shape (2,).
    """

    unknowns: Symbolic
    parameters: Symbolic
    ratio: Symbolic
    vibration: Symbolic


class BandModel(Protocol):
    """A family of band problems that differ in parameters only. Hashable, as `Model` is."""

    def __hash__(self) -> int:
        """Models are keys of the solvers' caches."""

    def expressions(self) -> BandExpressions:
        """Build the expressions."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnityBandProblem:
    """Minimum time with a residual within a tolerance over a band around the nominal frequency.

    Attributes
    ----------
    model
        The family.
    parameters
        Its parameters, shape (p,).
    amplitudes
        Amplitudes of the impulses, shape (n,) [-].
    shortest_gaps_rad
        Lower bounds of the gaps, shape (n - 1,), > 0 [rad].
    seeds
        Starts in order of preference.
    """

    model: BandModel
    parameters: FloatArray
    amplitudes: FloatArray
    shortest_gaps_rad: FloatArray
    seeds: tuple[Seed, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandSearch:
    """Band problems of more and more impulses: the first that can be solved is wanted.

    Attributes
    ----------
    problems
        One for each number of impulses, the fewest first.
    tolerance
        Largest residual over the band [-].
    half_width
        The band goes from 1 less this to 1 plus this, ratios of the nominal frequency [-].
    natural_frequency_rad_s
        Turns the gaps into times [rad/s].
    horizon_rad
        Longest duration [rad].
    designed_for
        The actuator of the claims.
    """

    problems: tuple[UnityBandProblem, ...]
    tolerance: float
    half_width: float
    natural_frequency_rad_s: float
    horizon_rad: float
    designed_for: Actuator

    @property
    def band(self) -> tuple[float, float]:
        """Ends of the band [-]."""
        return 1 - self.half_width, 1 + self.half_width

    @property
    def claims(self) -> tuple[Promise, ...]:
        """The tolerance over the band."""
        return (within(self.tolerance, self.band),)
