"""Amplitudes on neighbouring samples that leave exactly nothing."""

import numpy as np

from design.analysis.workable import require_workable
from design.errors import InfeasibleDesignError, InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.sample_grid import on_samples, share_on_samples
from design.types import FloatArray

EXACT = 1e-13
"""Largest equation that counts as zero: a few hundred roundings of terms of size one [-]."""

MIN_SHARE = 1e-10
"""Share of a shaper that is none: `Impulses` would take it for a step that does not accelerate."""

MAX_REACH = 4
"""Samples on each side of an impulse that are looked at [-]."""


def exact_positive(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    slope: bool = False,
) -> Impulses:
    """Return amplitudes on neighbouring samples that leave exactly zero.

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

    Returns
    -------
    Impulses
        Of the same sum and sign, on whole samples around each impulse, as few as do it.

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
    if not is_of_one_sign(impulses):
        raise InvalidInputError(
            "amplitudes", impulses.amplitudes.tolist(), "of one sign", code="signs_mixed"
        )
    total = float(impulses.amplitudes.sum())
    for reach in range(1, MAX_REACH + 1):
        samples, shares = share_on_samples(impulses, sample_time_s, reach=reach)
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
        f"no amplitudes of one sign on {MAX_REACH} samples on each side of the impulses make "
        f"the residual{' and the slope' if slope else ''} zero at a sample time of "
        f"{sample_time_s:g} s",
        code="no_positive_on_samples",
    )


def _nonnegative(equations: FloatArray, wanted: FloatArray, start: FloatArray) -> FloatArray:
    """Amplitudes that solve the equations, near to ``start``, shape (k,).

    The nearest ones, except the smallest, which is left out until all others are above 0. Where too
    few remain the equations are missed: for the caller to see.
    """
    kept = np.arange(start.size)
    while True:
        missing = wanted - equations[:, kept] @ start[kept]
        values = start[kept] + np.linalg.lstsq(equations[:, kept], missing)[0]
        if values.min() > MIN_SHARE or kept.size == 1:
            amplitudes: FloatArray = np.zeros(start.size)
            amplitudes[kept] = values
            return amplitudes
        kept = np.delete(kept, np.argmin(values))


def is_of_one_sign(impulses: Impulses) -> bool:
    """Return whether no two amplitudes differ in sign."""
    return bool(np.all(impulses.amplitudes >= 0) or np.all(impulses.amplitudes <= 0))
