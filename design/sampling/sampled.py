"""Impulses whose times lie on the sample grid of a controller.

A shaper that falls between two samples cannot be given as designed. Rounding it costs most of what
it was designed for; positive shapers can be made exact again by their amplitudes, those of unity
magnitude only as good as whole samples allow (`design.sampling.unity_grid`). All of it is for one
mode.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from design.analysis.certificate import Claim
from design.analysis.judge import (
    DesignWarning,
    Judgement,
    drive_warnings,
    judge,
    shortfall_of,
)
from design.analysis.residual import residual_curve, residual_vibration
from design.analysis.workable import require_workable
from design.claims import ZERO_LIMITS, Promise, Quantity, within
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import Design
from design.sampling.sample_grid import carried, nearest, on_samples, shared, split
from design.sampling.unity_grid import (
    Band,
    is_unity,
    left_of_many,
    more_impulses_on_grid,
    unity_on_grid,
)
from design.types import FloatArray, require_between

__all__ = [
    "Sampled",
    "Tried",
    "carried",
    "exact_positive",
    "more_impulses_on_grid",
    "nearest",
    "sample",
    "sampled_design",
    "split",
    "unity_on_grid",
]

Method = Literal["exact_positive", "split", "unity_on_grid", "more_impulses_on_grid"]
"""How a shaper was brought to the grid: the name of the function here that did it."""

SAMPLE_TOLERANCE = 0.01
"""What a shaper on samples may leave before impulses are added, where nothing else is said: a fifth
of the usual 5 % [-]."""

EXACT = 1e-13
"""Largest equation that counts as zero: a few hundred roundings of terms of size one [-]."""

SMALLEST_SHARE = 1e-10
"""Share of a shaper that is none: `Impulses` would take it for a step that does not accelerate."""

WIDEST_REACH = 4
"""Samples on each side of an impulse that are looked at [-]."""

AGREEMENT = 1e-9
"""Relative difference of two routes to one residual that is rounding [-]."""


CHECKED_IN_BAND = 2001
"""Frequencies at which a formula looks at a band, ends included."""

LONGER = 1.1
"""Duration on samples over that between them from which on it is told [-]."""

BAND_AGREEMENT = 1e-3
"""What a peak may be above the highest of those, over it [-].

From one to the next a shaper of three periods turns by .01 rad, and between them is a peak higher
by the square of that: the rest is room for longer ones.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """The best command of unity magnitude with one number of impulses.

    Attributes
    ----------
    impulses
        Their number [-].
    duration_s
        From the first to the last [s].
    residual
        What it leaves with the actuator given [-].
    compared
        By what it was chosen: the residual, and where zero slope is claimed ``0.05 |dV/d ln w|``
        more, to first order the most that 5 % of error in frequency leaves; where a tolerance is
        claimed over a band, the largest residual over that [-].
    """

    impulses: int
    duration_s: float
    residual: float
    compared: float


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
    split_residual
        What its linear split leaves; of unity magnitude it is not [-].
    nearest_residual
        What its impulses leave, each at the sample nearest to it [-]; None where two of them are
        less than a sample apart.
    carried_residual
        What they leave with each rounding error carried on [-]; None where that brings two of them
        to one sample too.
    tried
        For amplitudes of both signs the best of each number of impulses, fewest first.
    """

    impulses: Impulses
    sample_time_s: float
    method: Method
    residual: float
    continuous_residual: float
    split_residual: float
    nearest_residual: float | None
    carried_residual: float | None
    tried: tuple[Tried, ...]

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
    *,
    tolerance: float | None = None,
    band: Band | None = None,
) -> Sampled:
    """Bring a shaper to a sample grid by the method that suits it.

    Amplitudes of one sign that claim a zero are solved for (`exact_positive`), or where no
    amplitudes do it, or nothing is claimed, shared (`split`). Others are kept (`unity_on_grid`);
    where unity magnitude then leaves more than the tolerance, two, four, six impulses are added
    (`more_impulses_on_grid`) until it does not, and where none does not the least is taken. For a
    band the samples are chosen by what is left over it, and no impulses are added.

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
    tolerance
        What unity magnitude may leave at most before impulses are added, 0 to 1: the residual, and
        with ``slope`` in the claims ``0.05 |dV/d ln w|`` more [-]. None adds none.
    band
        The band of frequencies over which the shaper keeps a tolerance; None where it keeps none.

    Returns
    -------
    Sampled
        The shaper on the grid, and what it and other ways to get there leave.

    Raises
    ------
    InvalidInputError
        If the sample time or tolerance breaks its rule, a set of the actuator is out of
        proportion to the plant, or there are too many impulses to search.

    Examples
    --------
    >>> from design.model.actuators.ideal import Ideal
    >>> zv = Impulses(times_s=np.array([0.0, 0.25]), amplitudes=np.array([0.5, 0.5]))
    >>> two_hertz = Mode(natural_frequency_rad_s=4 * np.pi)
    >>> sampled = sample(zv, two_hertz, Ideal(), 0.1, ("residual",))
    >>> sampled.method, sampled.samples, sampled.residual < 1e-12
    ('exact_positive', (0, 2, 3), True)
    """
    require_workable(mode, actuator)
    method: Method
    tried: tuple[Tried, ...] = ()
    if not _of_one_sign(impulses):
        found, tried = _of_unity(
            impulses,
            mode,
            actuator,
            sample_time_s,
            slope="slope" in claims,
            tolerance=tolerance,
            band=band,
        )
        more = found.times_s.size > impulses.times_s.size
        method = "more_impulses_on_grid" if more else "unity_on_grid"
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

    def left_by(way: Callable[[Impulses, float], Impulses]) -> float | None:
        try:
            return residual_vibration(way(impulses, sample_time_s), mode, actuator)
        except InvalidInputError:
            return None  # the sample time serves the shaper, but not this way

    return Sampled(
        impulses=found,
        sample_time_s=sample_time_s,
        method=method,
        residual=residual_vibration(found, mode, actuator),
        continuous_residual=residual_vibration(impulses, mode, actuator),
        split_residual=residual_vibration(split(impulses, sample_time_s), mode, actuator),
        nearest_residual=left_by(nearest),
        carried_residual=left_by(carried),
        tried=tried,
    )


def _of_unity(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    slope: bool,
    tolerance: float | None,
    band: Band | None,
) -> tuple[Impulses, tuple[Tried, ...]]:
    """Return the fewest impulses within the tolerance, or those that leave least, and all tried."""
    commands = [unity_on_grid(impulses, mode, actuator, sample_time_s, slope=slope, band=band)]
    left = [_compared(commands[0], mode, actuator, slope=slope, band=band)]
    if tolerance is not None:
        require_between("sample_tolerance", tolerance, 0.0, 1.0)
        if band is None and left[0] > tolerance and is_unity(impulses):
            for command in more_impulses_on_grid(
                impulses, mode, actuator, sample_time_s, slope=slope, tolerance=tolerance
            ):
                commands.append(command)
                left.append(_compared(command, mode, actuator, slope=slope, band=None))
                if left[-1] <= tolerance:
                    break
    tried = tuple(
        Tried(
            impulses=command.times_s.size,
            duration_s=command.duration_s,
            residual=residual_vibration(command, mode, actuator),
            compared=compared,
        )
        for command, compared in zip(commands, left, strict=True)
    )
    # Only the last can be within the tolerance, and is then the least of all.
    return commands[int(np.argmin(left))], tried


def _compared(
    impulses: Impulses, mode: Mode, actuator: Actuator, *, slope: bool, band: Band | None
) -> float:
    times, amplitudes = impulses.times_s[None], impulses.amplitudes
    return float(left_of_many(times, amplitudes, mode, actuator, slope=slope, band=band)[0])


def sampled_design(
    continuous: Design,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    tolerance: float | None = None,
) -> tuple[Design, Sampled]:
    """Return a design brought to a sample grid, its certificate proving what it tells.

    The residual of a sampled shaper, at the nominal frequency and over the band of the shaper's own
    claim if it has one, is computed by formula; the judge recomputes it by simulation, for the
    actuator of the shaper's own certificate. One that holds for an ideal actuator only does so on
    samples, and a warning has the figure with the one given. Another says where the residual is
    above what the shaper claims, or for one that claims zero, above the sample tolerance. The
    parameters are those of `sample`.
    """
    kept = continuous.certificate.over_band
    sampled = sample(
        continuous.impulses,
        mode,
        actuator,
        sample_time_s,
        continuous.certificate.zeros,
        tolerance=tolerance,
        band=None if kept is None else kept.band,
    )
    certified_for: Actuator = Ideal() if continuous.for_ideal else actuator
    own = residual_vibration(sampled.impulses, mode, certified_for)
    asked: tuple[Promise, ...] = (
        Promise(quantity="residual", limit=own * (1 + AGREEMENT) + ZERO_LIMITS["residual"]),
    )
    if kept is not None and kept.band is not None:
        ratios = np.linspace(*kept.band, CHECKED_IN_BAND)
        largest = float(residual_curve(sampled.impulses, mode, certified_for, ratios).max())
        asked = (*asked, within(largest * (1 + BAND_AGREEMENT), kept.band))
    judged = judge(sampled.impulses, (mode,), certified_for, asked, name="the sampled shaper")
    if not judged.certificate.verified:
        raise SolverFailedError(
            f"the sampled shaper is not what a formula says: {shortfall_of(judged.certificate)}"
        )
    proven = replace(
        continuous,
        impulses=sampled.impulses,
        residuals=(sampled.residual,),
        certificate=judged.certificate,
        warnings=(
            *_actuator_ignored(continuous, sampled),
            *_lost_on_samples(continuous, judged, tolerance),
            *drive_warnings(sampled.impulses, (mode,), actuator),
            *_longer_on_samples(continuous, sampled),
        ),
    )
    return proven, sampled


def _actuator_ignored(continuous: Design, sampled: Sampled) -> Iterator[DesignWarning]:
    """Yield what a shaper that is proven for an ideal actuator costs behind the one given."""
    if continuous.for_ideal:
        yield DesignWarning(
            code="actuator_ignored",
            detail="the shaper is made, and its claims are proven, for an actuator that follows "
            f"its command; with the one given the residual is {100 * sampled.residual:.4g} % on "
            f"samples, {100 * sampled.continuous_residual:.4g} % between them",
        )


def _lost_on_samples(
    continuous: Design, judged: Judgement, tolerance: float | None
) -> Iterator[DesignWarning]:
    """Yield what of the shaper's claims is lost on samples."""
    kept, over_band = continuous.certificate.over_band, judged.certificate.over_band
    if kept is not None and over_band is not None:
        if over_band.value > kept.limit * (1 + BAND_AGREEMENT):
            yield DesignWarning(
                code="tolerance_not_kept",
                detail=f"on samples the residual over the band is up to {over_band.value:.4g}, "
                f"more than the tolerance of {kept.limit:g}: take a shorter sample time, or design "
                "for a smaller tolerance",
            )
        return
    claimed = [
        claim.limit
        for claim in claims_on_samples(continuous, tolerance)
        if claim.quantity == "residual"
    ]
    if claimed and judged.residual > max(claimed) * (1 + AGREEMENT):
        yield DesignWarning(
            code="tolerance_not_kept",
            detail=f"on samples the residual is {100 * judged.residual:.4g} % of an unshaped step, "
            f"more than {100 * max(claimed):.4g} %: take a shorter sample time",
        )


def claims_on_samples(continuous: Design, tolerance: float | None) -> tuple[Claim, ...]:
    """Return what a shaper claims, where it claims a zero residual with what samples may leave.

    Parameters
    ----------
    continuous
        The shaper between the samples.
    tolerance
        The sample tolerance [-]; `SAMPLE_TOLERANCE` if None.
    """
    for_zero = SAMPLE_TOLERANCE if tolerance is None else tolerance
    return tuple(
        replace(claim, limit=for_zero) if claim.is_zero and claim.quantity == "residual" else claim
        for claim in continuous.certificate.claims
    )


def _longer_on_samples(continuous: Design, sampled: Sampled) -> Iterator[DesignWarning]:
    """Yield that impulses were added, where they take longer."""
    before_s = continuous.impulses.duration_s
    if len(sampled.tried) > 1 and sampled.impulses.duration_s > LONGER * before_s:
        own = sampled.tried[0]
        yield DesignWarning(
            code="longer_on_samples",
            detail=f"{sampled.impulses.times_s.size} impulses take "
            f"{sampled.impulses.duration_s:.4g} s on samples, in place of "
            f"{before_s:.4g} s between them; {own.impulses} leave "
            f"{own.compared:.4g} there: a sample_tolerance of that keeps the shaper short",
        )


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
