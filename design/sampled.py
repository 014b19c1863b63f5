"""Impulses whose times lie on the sample grid of a controller.

A shaper that falls between two samples cannot be given as designed. Rounding it costs most of what
it was designed for; positive shapers can be made exact again by their amplitudes, those of unity
magnitude only as good as whole samples allow. All of it is for one mode.
"""

import itertools
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from design.actuators import Actuator
from design.analysis.certificate import LIMITS, Certificate, Claim, certify
from design.analysis.residual import require_workable, residual_vibration, vectors_of_many
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.impulses import Impulses
from design.pipeline import Design
from design.plants import Mode
from design.sample_grid import (
    IntArray,
    carried,
    nearest,
    on_samples,
    require_gaps,
    rounded,
    shared,
    split,
)
from design.shapers.kind import Quantity
from design.types import ComplexArray, FloatArray

__all__ = [
    "Sampled",
    "carried",
    "exact_positive",
    "nearest",
    "sample",
    "sampled_design",
    "split",
    "unity_on_grid",
]

Method = Literal["exact_positive", "split", "unity_on_grid"]
"""How a shaper was brought to the grid: the name of the function here that did it."""

EXACT = 1e-13
"""Largest equation that counts as zero: a few hundred roundings of terms of size one [-]."""

SMALLEST_SHARE = 1e-10
"""Share of a shaper that is none: `Impulses` would take it for a step that does not accelerate."""

WIDEST_REACH = 4
"""Samples on each side of an impulse that are looked at [-]."""

MOST_CANDIDATES = 50_000
"""Largest number of rounded shapers that one search compares; it narrows for more impulses."""

FREQUENCY_ERROR = 0.05
"""Relative error in frequency that a shaper with zero slope is to stand [-]."""

DIFFERENCE = 1e-5
"""Relative step of the central difference in frequency: its error and rounding are 1e-10 [-]."""

TIE = 1e-12
"""Shapers this near in what they leave are equally good: it is rounding [-]."""


AGREEMENT = 1e-9
"""Relative difference of two routes to one residual that is rounding [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sampled:
    """A shaper on a sample grid, and what that cost.

    Attributes
    ----------
    impulses
        The shaper, its times whole multiples of the sample time.
    sample_time_s
        The sample time [s].
    method
        How it was brought to the grid.
    residual
        What it leaves with the actuator given [-].
    continuous_residual
        What the shaper between the samples leaves with the same actuator [-].
    """

    impulses: Impulses
    sample_time_s: float
    method: Method
    residual: float
    continuous_residual: float

    @property
    def samples(self) -> tuple[int, ...]:
        """Number of the sample of each impulse, counted from time 0."""
        return tuple(np.rint(self.impulses.times_s / self.sample_time_s).astype(int).tolist())


def sample(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    claims: Collection[Quantity],
) -> Sampled:
    """Bring a shaper to a sample grid by the method that suits it.

    Amplitudes of one sign that claim a zero are solved for (`exact_positive`), or where no
    amplitudes do it, or nothing is claimed, shared (`split`); others are kept (`unity_on_grid`).

    Parameters
    ----------
    impulses
        The shaper.
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time, > 0, at most the shortest gap between two impulses, or for amplitudes of one
        sign the whole duration [s].
    claims
        What the shaper makes zero; ``slope`` stands for the residual besides.

    Returns
    -------
    Sampled
        The shaper on the grid, and the residual before and after.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule, a set of the actuator is out of proportion to the
        plant, or there are too many impulses to search.

    Examples
    --------
    >>> from design.actuators import Ideal
    >>> zv = Impulses(times_s=np.array([0.0, 0.25]), amplitudes=np.array([0.5, 0.5]))
    >>> two_hertz = Mode(natural_frequency_rad_s=4 * np.pi)
    >>> sampled = sample(zv, two_hertz, Ideal(), 0.1, ("residual",))
    >>> sampled.method, sampled.samples, sampled.residual < 1e-12
    ('exact_positive', (0, 2, 3), True)
    """
    require_workable(mode, actuator)
    method: Method
    if not _of_one_sign(impulses):
        method = "unity_on_grid"
        found = unity_on_grid(impulses, mode, actuator, sample_time_s, slope="slope" in claims)
    else:
        method, found = "split", split(impulses, sample_time_s)
        if claims:
            try:
                found = exact_positive(
                    impulses, mode, actuator, sample_time_s, slope="slope" in claims
                )
                method = "exact_positive"
            except InfeasibleDesignError:
                pass  # the split stands, and the residual says what it is worth
    return Sampled(
        impulses=found,
        sample_time_s=sample_time_s,
        method=method,
        residual=residual_vibration(found, mode, actuator),
        continuous_residual=residual_vibration(impulses, mode, actuator),
    )


def sampled_design(
    continuous: Design,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    claims: Collection[Quantity],
) -> tuple[Design, Sampled]:
    """Return a design brought to a sample grid, its certificate proving the residual it tells.

    What a sampled shaper leaves is told by formula; the certificate recomputes it by simulation,
    with the actuator given.
    """
    sampled = sample(continuous.impulses, mode, actuator, sample_time_s, claims)
    (simulated,) = certify(sampled.impulses, mode, actuator, ("residual",)).claims
    limit = sampled.residual * (1 + AGREEMENT) + LIMITS["residual"]
    claim = Claim(quantity="residual", value=simulated.value, limit=limit)
    proven = replace(
        continuous,
        impulses=sampled.impulses,
        residual=sampled.residual,
        certificate=Certificate(claims=(claim,)),
    )
    if not proven.certificate.verified:
        raise SolverFailedError(
            f"the residual of the sampled shaper, {sampled.residual:.3g}, is {claim.value:.3g} "
            "when simulated"
        )
    return proven, sampled


def exact_positive(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    slope: bool = False,
) -> Impulses:
    """Return amplitudes on neighbouring samples that leave exactly nothing.

    Of all amplitudes that keep sign and sum and make V (and dV/dw) zero, close to the nearest ones
    to the linear split, in the sense of least squares, on the fewest samples around each impulse.

    Parameters
    ----------
    impulses
        The shaper, its amplitudes of one sign.
    mode, actuator
        The plant's mode and its drive. All steps of such a shaper increase the command, so the
        acceleration set's G is a common factor, superposed or switched, and changes nothing.
    sample_time_s
        Sample time, > 0, at most the whole duration [s].
    slope
        Whether dV/dw is to be zero too.

    Raises
    ------
    InvalidInputError
        If the amplitudes are of both signs, or the sample time breaks its rule, or a set of the
        actuator is out of all proportion to the plant.
    InfeasibleDesignError
        If no amplitudes of that sign were found.

    References
    ----------
    .. [1] B. R. Murphy, I. Watanabe, "Digital shaping filters for reducing machine vibration",
       IEEE Trans. Robotics and Automation 8 (1992).
    """
    require_workable(mode, actuator)
    if not _of_one_sign(impulses):
        raise InvalidInputError("amplitudes", impulses.amplitudes.tolist(), "of one sign")
    total = float(impulses.amplitudes.sum())
    for reach in range(1, WIDEST_REACH + 1):
        samples, shares = shared(impulses, sample_time_s, reach=reach)
        # From the last sample back, as the residual counts: no exponential grows.
        phases = mode.natural_frequency_rad_s * sample_time_s * (samples[-1] - samples)
        swings = np.exp(mode.unit_pole * phases)
        rows = [np.ones(samples.size), swings.real, swings.imag]
        if slope:
            # Where V = 0 the origin of time is free, and the pole is a common factor of dV/dw.
            delays = phases / max(1.0, float(phases[0]))
            rows += [delays * swings.real, delays * swings.imag]
        equations = np.array(rows)
        wanted = np.zeros(len(rows))
        wanted[0] = 1.0
        amplitudes = _nonnegative(equations, wanted, shares / total)
        miss = float(np.max(np.abs(equations @ amplitudes - wanted)))
        if amplitudes.min() >= 0 and miss <= EXACT:
            return on_samples(samples, total * amplitudes, sample_time_s)
    raise InfeasibleDesignError(
        f"no amplitudes of one sign on {WIDEST_REACH} samples on each side of the impulses make "
        f"the residual{' and the slope' if slope else ''} zero at a sample time of "
        f"{sample_time_s:g} s"
    )


def unity_on_grid(
    impulses: Impulses, mode: Mode, actuator: Actuator, sample_time_s: float, *, slope: bool
) -> Impulses:
    """Return the impulses with amplitudes unchanged, at the best whole samples around them.

    Compared is every choice of samples, up to four on each side of the nearest (fewer for more
    than five impulses), in order. The first impulse stays at its nearest sample: all of them later
    by a sample leave the same. What is minimised is the residual |V|, and with ``slope``
    ``|V| + 0.05 |dV/d ln w|``: to first order the most that 5 % of error in frequency leaves.

    Parameters
    ----------
    impulses
        The shaper.
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time, > 0, at most the shortest gap between two impulses [s].
    slope
        Whether the slope in frequency counts too.

    Returns
    -------
    Impulses
        The choice that leaves least; the shorter, then the earlier, of two that leave the same.
        It leaves something: ask `design.analysis.residual` how much.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule, a set of the actuator is out of all proportion to the
        plant, or there are more than ten impulses.
    """
    require_workable(mode, actuator)
    require_gaps(impulses, sample_time_s)
    samples = _choices(rounded(impulses.times_s / sample_time_s))
    left = _left(samples * sample_time_s, impulses.amplitudes, mode, actuator, slope=slope)
    best = samples[left <= left.min() + TIE]
    # Rows come in lexical order, and argmin takes the first: the earlier of two equally long.
    chosen = best[np.argmin(best[:, -1])]
    return Impulses(times_s=chosen * sample_time_s, amplitudes=impulses.amplitudes)


def _left(
    times_s: FloatArray, amplitudes: FloatArray, mode: Mode, actuator: Actuator, *, slope: bool
) -> FloatArray:
    """Return what `unity_on_grid` minimises of many shapers, times of shape (m, n): shape (m,)."""
    lag = actuator.accel_lag

    def vibration(ratio: float) -> ComplexArray:
        pole = mode.pole_rad_s * ratio
        poles = np.full(len(times_s), pole)
        # Phase and unit of the nominal frequency, so that only V itself differs.
        unit = lag.denominator(mode.pole_rad_s) / lag.denominator(pole)
        turn = np.exp((mode.pole_rad_s - pole) * (times_s[:, -1] - times_s[:, 0]))
        vectors: ComplexArray = vectors_of_many(times_s, amplitudes, poles, actuator) * turn * unit
        return vectors

    left: FloatArray = np.abs(vibration(1.0))
    if slope:
        change = vibration(1 + DIFFERENCE) - vibration(1 - DIFFERENCE)
        left = left + FREQUENCY_ERROR * np.abs(change) / (2 * DIFFERENCE)
    return left


def _choices(centres: IntArray) -> IntArray:
    """Every ordered choice of samples around the centres, in lexical order, shape (m, n)."""
    free = centres.size - 1
    reach = WIDEST_REACH
    while (2 * reach + 1) ** free > MOST_CANDIDATES:
        reach -= 1
    if reach == 0:
        raise InvalidInputError("impulses", centres.size, "few enough to search: at most 10")
    moves = list(itertools.product(range(-reach, reach + 1), repeat=free))
    samples = np.repeat(centres[None], len(moves), axis=0)
    samples[:, 1:] += np.array(moves, dtype=int)
    ordered: IntArray = samples[np.all(np.diff(samples, axis=1) > 0, axis=1)]
    return ordered


def _nonnegative(equations: FloatArray, wanted: FloatArray, start: FloatArray) -> FloatArray:
    """Amplitudes that solve the equations, near to ``start``, shape (k,).

    The nearest ones, but for the least, which is left out until all others are above 0. Where too
    few remain the equations are missed: for the caller to see.
    """
    kept = np.arange(start.size)
    while True:
        missing = wanted - equations[:, kept] @ start[kept]
        values = start[kept] + np.linalg.lstsq(equations[:, kept], missing)[0]
        if values.min() > SMALLEST_SHARE or kept.size == 1:
            amplitudes: FloatArray = np.zeros(start.size)
            amplitudes[kept] = values
            return amplitudes
        kept = np.delete(kept, np.argmin(values))


def _of_one_sign(impulses: Impulses) -> bool:
    return bool(np.all(impulses.amplitudes >= 0) or np.all(impulses.amplitudes <= 0))
