"""A shaper design as data: what formulations say and solvers read."""

from dataclasses import dataclass, field, replace
from typing import Any, Literal, Protocol

import numpy as np

from design.actuators import Actuator
from design.impulses import Impulses
from design.types import BoolArray, ComplexArray, FloatArray

Quantity = Literal["residual", "slope", "second_derivative", "third_derivative", "band"]
"""What a shaper may claim to keep small.

Its residual vibration; derivatives of its vector V, ``|d^k V / d(ln w)^k|`` with z fixed, over the
unshaped step; the largest residual over a band of frequencies.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Promise:
    """One thing that the impulses of a shaper keep.

    Attributes
    ----------
    quantity
        What is kept small.
    limit
        It holds if the value is at most this: nearly zero, or a tolerance [-].
    mode
        Number of the plant's mode that it is about, from 0.
    band
        Ends of the band as ratios of the mode's frequency, lower first [-]; for ``band`` only,
        where None asks for the widest band around 1 that the impulses themselves keep.
    """

    quantity: Quantity
    limit: float
    mode: int = 0
    band: tuple[float, float] | None = None


def within(tolerance: float, band: tuple[float, float] | None) -> Promise:
    """Return the promise of a tolerance over a band; None as of `Promise`."""
    return Promise(quantity="band", limit=tolerance, band=band)


@dataclass(frozen=True, slots=True, kw_only=True)
class Expressions:
    """CasADi expressions of a problem, all dimensionless.

    Attributes
    ----------
    unknowns
        Gaps between the impulses times the plant's natural frequency, shape (n - 1,) [rad], then
        ratios of frequencies, if any are unknown too, shape (r,) [-].
    parameters
        What differs from one design to the next, shape (p,).
    objective
        To be minimised: the duration [rad].
    equations
        To be zero, as many as unknowns.
    """

    unknowns: Any
    parameters: Any
    objective: Any
    equations: Any


class Model(Protocol):
    """A family of problems that differ in parameters only. Hashable: solvers build each once."""

    def __hash__(self) -> int:
        """Models are keys of the solvers' caches."""

    def expressions(self) -> Expressions:
        """Build the expressions."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Seed:
    """Where to start.

    Attributes
    ----------
    name
        As reported with the answer.
    gaps_rad
        Gaps between the impulses, shape (n - 1,) [rad].
    solves
        Parameters of the family that they solve, shape (p,), to be followed from there to those
        asked; None for a start from which a solver goes straight.
    """

    name: str
    gaps_rad: FloatArray
    solves: FloatArray | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ratios:
    """Frequency ratios that are unknown beside the gaps: none if nothing is said.

    Attributes
    ----------
    lowest, highest
        Their bounds, shape (r,) [-].
    usual
        Where every start has them, shape (r,) [-].
    """

    lowest: FloatArray = field(default_factory=lambda: np.zeros(0))
    highest: FloatArray = field(default_factory=lambda: np.zeros(0))
    usual: FloatArray = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """A minimum-time problem over the gaps between impulses.

    Attributes
    ----------
    model
        The family.
    parameters
        Its parameters, shape (p,).
    amplitudes
        Amplitudes of the impulses, shape (n,) [-].
    natural_frequency_rad_s
        Turns the gaps into times [rad/s].
    shortest_gaps_rad
        Lower bounds of the gaps, shape (n - 1,), > 0: the impulses keep their order [rad].
    horizon_rad
        Longest duration [rad].
    seeds
        Starts in order of preference.
    designed_for
        The actuator of the claims: an ideal one for shapers that know no actuator.
    claims
        What the impulses keep; none stands for the claims of the kind, each at its zero.
    ratios
        What is unknown beside the gaps: where the curve has its zeros and peaks.
    """

    model: Model
    parameters: FloatArray
    amplitudes: FloatArray
    natural_frequency_rad_s: float
    shortest_gaps_rad: FloatArray
    horizon_rad: float
    seeds: tuple[Seed, ...]
    designed_for: Actuator
    claims: tuple[Promise, ...] = ()
    ratios: Ratios = field(default_factory=Ratios)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest values of all unknowns, shape (n - 1 + r,) each."""
        latest = np.full(self.shortest_gaps_rad.size, self.horizon_rad)
        return (
            np.concatenate((self.shortest_gaps_rad, self.ratios.lowest)),
            np.concatenate((latest, self.ratios.highest)),
        )

    def split(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the gaps and the ratios of unknowns, shape (..., n - 1 + r)."""
        count = self.shortest_gaps_rad.size
        return unknowns[..., :count], unknowns[..., count:]

    def start(self, gaps_rad: FloatArray) -> FloatArray:
        """Return unknowns to start from, of gaps, shape (..., n - 1), and the usual ratios."""
        usual = np.broadcast_to(self.ratios.usual, (*gaps_rad.shape[:-1], self.ratios.usual.size))
        return np.concatenate((gaps_rad, usual), axis=-1)

    def allows(self, unknowns: FloatArray) -> BoolArray:
        """Tell whether unknowns, shape (..., n - 1 + r), are within bounds and horizon."""
        lowest, highest = self.bounds
        within = ((unknowns >= lowest) & (unknowns <= highest)).all(axis=-1)
        # Of what ran away the sum may be none.
        gaps, _ = self.split(np.clip(unknowns, lowest, highest))
        allowed: BoolArray = within & (gaps.sum(axis=-1) <= self.horizon_rad)
        return allowed


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClosedForm:
    """A shaper that needs no search.

    Attributes
    ----------
    impulses
        The shaper.
    designed_for
        The actuator of the claims.
    claims
        What the impulses keep; none stands for the claims of the kind, each at its zero.
    method
        ``closed_form``, or ``newton`` for equations followed from one.
    """

    impulses: Impulses
    designed_for: Actuator
    claims: tuple[Promise, ...] = ()
    method: Literal["closed_form", "newton"] = "closed_form"


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

    unknowns: Any
    parameters: Any
    ratio: Any
    vibration: Any


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JointProblem:
    """The fastest shaper that leaves no vibration in any of several modes.

    Attributes
    ----------
    unit_poles
        Poles of the modes over the lowest natural frequency, shape (m,).
    natural_frequency_rad_s
        That frequency: it turns phases into times [rad/s].
    positive
        Whether amplitudes are positive; else the command is anywhere from 0 to 1.
    designed_for
        The actuator of the claims.
    claims
        None: no residual in any mode.
    """

    unit_poles: ComplexArray
    natural_frequency_rad_s: float
    positive: bool
    designed_for: Actuator
    claims: tuple[Promise, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Convolution:
    """A shaper for each mode, each shaping the steps of the one before.

    Attributes
    ----------
    parts
        Formulations of them, in the order of the modes.
    zeros_of_parts
        What a part without claims of its own keeps at zero.
    designed_for
        The actuator of the claims.
    """

    parts: tuple["Formulation", ...]
    zeros_of_parts: tuple[Quantity, ...]
    designed_for: Actuator

    @property
    def claims(self) -> tuple[Promise, ...]:
        """What the parts keep, each in its own mode; none for zeros."""
        return tuple(
            replace(promise, mode=number)
            for number, part in enumerate(self.parts)
            for promise in part.claims
        )


Formulation = ClosedForm | Problem | BandProblem | BandSearch | JointProblem | Convolution
