"""A residual within a tolerance over a band of frequencies, in least time."""

from dataclasses import dataclass
from typing import Protocol

from design.claims import Promise, within
from design.formulations.seeds import Seed
from design.model.actuators.registry import Actuator
from design.types import ComplexArray, FloatArray, Symbolic


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandProblem:
    """The fastest shaper whose residual stays within a tolerance over a band.

    Attributes
    ----------
    unit_pole
        The mode's pole over its natural frequency.
    natural_frequency_rad_s
        Turns phases into times [rad/s].
    band
        Lowest and highest ratio of the true frequency to the nominal one [-].
    tolerance
        Largest residual over the band [-].
    levels
        Lowest and highest level of the command, at most 0 and at least 1; None for positive
        amplitudes, which need no limits.
    horizon_rad
        Longest duration [rad].
    designed_for
        The actuator of the claims.
    """

    unit_pole: complex
    natural_frequency_rad_s: float
    band: tuple[float, float]
    tolerance: float
    levels: tuple[float, float] | None
    horizon_rad: float
    designed_for: Actuator

    @property
    def claims(self) -> tuple[Promise, ...]:
        """The tolerance over the band."""
        return (within(self.tolerance, self.band),)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Obstacle:
    """What stands against a duration: a function of time that no shaper so short can pass.

    ``p(u) = Re sum_k y_k exp(s(r_k) u)``, u back from the last impulse. A shaper within the
    tolerance V over the band has ``sum A_i p(u_i) <= V sum |y_k|``, whatever the y.

    Attributes
    ----------
    duration_rad
        The duration that it excludes, and all below [rad].
    ratios
        Frequency ratios, within the band, shape (k,) [-].
    vectors
        y, shape (k,), complex [-].
    """

    duration_rad: float
    ratios: FloatArray
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
