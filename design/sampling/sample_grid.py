"""The sample grid of a controller: impulses rounded to it, or shared between its samples.

Nothing here knows the plant; `design.sampling.sampled` does. Every grid passes through time 0.
"""

import itertools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from design.checks import require_scale
from design.errors import InvalidInputError
from design.model.impulses import Impulses
from design.types import FloatArray

AnyIntArray = NDArray[np.integer[Any]]

ON_SAMPLE = 1e-9
"""Closer than this to a sample counts as on it: a quotient of two times has rounding [samples]."""


MAX_SAMPLES = 1_000_000
"""Most samples from time 0 to an impulse: times in samples then keep the digits of `ON_SAMPLE`."""


def nearest(impulses: Impulses, sample_time_s: float) -> Impulses:
    """Return the impulses, each at its nearest sample; halves round up.

    Parameters
    ----------
    impulses
        The shaper.
    sample_time_s
        Sample time, > 0, at most the shortest gap between two impulses [s].

    Returns
    -------
    Impulses
        Of unchanged amplitudes.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule.

    Examples
    --------
    >>> zv = Impulses(times_s=np.array([0.0, 0.26]), amplitudes=np.array([0.5, 0.5]))
    >>> nearest(zv, 0.125).times_s.tolist()
    [0.0, 0.25]
    """
    require_gaps(impulses, sample_time_s)
    samples = nearest_integers(impulses.times_s / sample_time_s)
    return Impulses(times_s=samples * sample_time_s, amplitudes=impulses.amplitudes)


def round_with_carry(impulses: Impulses, sample_time_s: float) -> Impulses:
    """Return the impulses rounded in turn, each with the last one's error.

    With ``x_i`` the time of an impulse in samples and ``k_i`` the sample that it is given,
    ``k_i = round(x_i + x_(i-1) - k_(i-1))``: equations 7 and 8 of the source for three impulses.

    Parameters
    ----------
    impulses
        The shaper.
    sample_time_s
        Sample time, > 0, at most the shortest gap between two impulses [s].

    Returns
    -------
    Impulses
        Of unchanged amplitudes, no two at one sample.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule, or two impulses come to the same sample.

    Notes
    -----
    Kept as published. Equation 8 moves t3 away from where t2 was moved to; for what is left to
    first order t3 should follow t2, for UMZV half as far.

    References
    ----------
    .. [1] Kim (2011), appendix C, equations 7 and 8.
    """
    require_gaps(impulses, sample_time_s)
    samples: list[int] = []
    error = 0.0
    for position in (impulses.times_s / sample_time_s).tolist():
        samples.append(int(nearest_integers(np.array(position + error))))
        error = position - samples[-1]
    if any(later <= earlier for earlier, later in itertools.pairwise(samples)):
        raise InvalidInputError(
            "sample_time_s",
            sample_time_s,
            f"short enough that no two impulses come to one sample, here {samples}",
            code="impulses_share_a_sample",
        )
    return Impulses(
        times_s=np.array(samples) * sample_time_s,
        amplitudes=impulses.amplitudes,
    )


def split(impulses: Impulses, sample_time_s: float) -> Impulses:
    """Return the impulses, each shared by the two samples around it.

    Sum and mean time of the amplitudes are kept. Amplitudes of unity magnitude are not.

    Parameters
    ----------
    impulses
        The shaper.
    sample_time_s
        Sample time, > 0, at most the whole duration [s].

    Returns
    -------
    Impulses
        At most two for each impulse; those of height 0 are left out.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule.

    Examples
    --------
    >>> zv = Impulses(times_s=np.array([0.0, 0.3125]), amplitudes=np.array([0.5, 0.5]))
    >>> split(zv, 0.125).amplitudes.tolist()
    [0.5, 0.25, 0.25]
    """
    samples, amplitudes = share_on_samples(impulses, sample_time_s, reach=1)
    return on_samples(samples, amplitudes, sample_time_s)


def share_on_samples(
    impulses: Impulses, sample_time_s: float, *, reach: int
) -> tuple[AnyIntArray, FloatArray]:
    """Return samples around the impulses, and the linear split on them.

    Parameters
    ----------
    impulses
        The shaper.
    sample_time_s
        Sample time, > 0, at most the whole duration [s].
    reach
        Samples on each side of an impulse, >= 1; none before the first that the split needs.

    Returns
    -------
    tuple[IntArray, FloatArray]
        Numbers of the samples, increasing, and amplitudes, both of shape (k,).
    """
    require_grid(impulses, sample_time_s, impulses.duration_s, "the duration of the shaper")
    positions = impulses.times_s / sample_time_s
    on_sample = np.abs(positions - nearest_integers(positions)) <= ON_SAMPLE
    positions = np.where(on_sample, nearest_integers(positions), positions)
    before = np.floor(positions).astype(int)
    after = np.ceil(positions).astype(int)
    around = np.add.outer(np.arange(1 - reach, reach), np.stack([before, after]))
    # No sooner than the first impulse needs: an earlier start would only be a later shaper.
    samples: AnyIntArray = np.unique(np.maximum(around, before[0]))
    shares = np.zeros(samples.size)
    later = positions - before
    np.add.at(shares, np.searchsorted(samples, before), impulses.amplitudes * (1 - later))
    np.add.at(shares, np.searchsorted(samples, after), impulses.amplitudes * later)
    return samples, shares


def on_samples(samples: AnyIntArray, amplitudes: FloatArray, sample_time_s: float) -> Impulses:
    """Return the impulses at these samples; those of height 0 are left out.

    Parameters
    ----------
    samples
        Numbers of samples, shape (n,), rising.
    amplitudes
        Heights, shape (n,), not all 0 [-].
    sample_time_s
        Sample time [s].

    Returns
    -------
    Impulses
        At whole multiples of the sample time.
    """
    used = amplitudes != 0
    return Impulses(times_s=samples[used] * sample_time_s, amplitudes=amplitudes[used])


def nearest_integers(positions: FloatArray) -> AnyIntArray:
    """Return the nearest whole numbers; halves round up.

    `numpy.rint` would round them to even.
    """
    whole: AnyIntArray = np.floor(positions + 0.5).astype(int)
    return whole


def require_gaps(impulses: Impulses, sample_time_s: float) -> None:
    """Check that every impulse has a separate sample.

    Parameters
    ----------
    impulses
        The shaper.
    sample_time_s
        Sample time [s].

    Raises
    ------
    InvalidInputError
        If the sample time is not > 0, or longer than the shortest gap between two impulses.
    """
    shortest = float(np.min(np.diff(impulses.times_s), initial=math.inf))
    require_grid(impulses, sample_time_s, shortest, "the shortest gap between two impulses")


def require_grid(impulses: Impulses, sample_time_s: float, longest_s: float, what: str) -> None:
    """Check that a sample time is in proportion to the shaper.

    Parameters
    ----------
    impulses, sample_time_s
        The shaper, and the sample time [s].
    longest_s, what
        The longest sample time, and what that is [s].

    Raises
    ------
    InvalidInputError
        If the sample time is not > 0, longer than that, or too short for times to keep digits.
    """
    require_scale("sample_time_s", sample_time_s)
    if impulses.times_s.size > 1 and sample_time_s > longest_s * (1 + ON_SAMPLE):
        raise InvalidInputError(
            "sample_time_s",
            sample_time_s,
            f"at most {what}, {longest_s:g}",
            code="sample_time_too_long",
        )
    shortest_s = float(np.max(np.abs(impulses.times_s))) / MAX_SAMPLES
    if sample_time_s < shortest_s:
        raise InvalidInputError(
            "sample_time_s",
            sample_time_s,
            f"at least {shortest_s:g}, for all impulses to lie within {MAX_SAMPLES:,} samples",
            code="sample_time_too_short",
        )
