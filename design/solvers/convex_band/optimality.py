"""The conditions of optimality over bands, solved off any grid by Newton's method.

Time runs backwards here, from the last impulse: ``u = t_n - t``, so that what rings after the last
impulse is ``F(r) = sum A_i exp(s(r) u_i)``, ``s(r) = r s(1)`` with the nominal pole of its band.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from design.formulations.bands import BandProblem
from design.types import BoolArray, FloatArray, IntArray

MAX_STEPS = 30
CONVERGED = 1e-12
"""Change of times and amplitudes at which Newton's method is done [rad, -]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Point:
    """Impulses and touching peaks.

    Attributes
    ----------
    lags
        ``u_i``, ascending from 0 to the duration, shape (n,) [rad].
    amplitudes
        shape (n,) [-].
    bands
        Numbers of the bands in which the peaks are, ascending, shape (m,).
    ratios
        Frequency ratios of the peaks, ascending in each band, shape (m,) [-].
    inner
        Which of them lie inside their band and may move, shape (m,).
    weights
        Cost of each, shape (m,), sum 1 [-].
    steps
        Steps of Newton's method that led there.
    """

    lags: FloatArray
    amplitudes: FloatArray
    bands: IntArray
    ratios: FloatArray
    inner: BoolArray
    weights: FloatArray
    steps: int = 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Places:
    """Where the unknowns are among the columns: lags but the first, amplitudes, ratios, weights.

    Attributes
    ----------
    impulses, peaks
        Their numbers n and m.
    inner
        Which peaks may move, shape (p,).
    free
        Whether the amplitudes are unknown.
    """

    impulses: int
    peaks: int
    inner: IntArray
    free: bool

    @property
    def amplitudes(self) -> slice:
        """Columns of the amplitudes, none if they are fixed."""
        first = self.impulses - 1
        return slice(first, first + self.impulses * self.free)

    @property
    def ratios(self) -> slice:
        """Columns of the inner peaks' ratios."""
        return slice(self.amplitudes.stop, self.amplitudes.stop + self.inner.size)

    @property
    def columns(self) -> int:
        """Number of unknowns."""
        return int(self.ratios.stop) + self.peaks

    @property
    def rows(self) -> int:
        """Number of conditions."""
        n = self.impulses
        return self.peaks + self.inner.size + (n - 2) + (n + 1 if self.free else 1)


# Where it diverges, numbers overflow: what is not finite then ends it.
@np.errstate(over="ignore", invalid="ignore")
def solve_conditions(problem: BandProblem, point: Point, tolerance: float) -> Point | None:
    """Solve the conditions of optimality from a point near by.

    Unknown are the lags except the first, the amplitudes where they are free, the ratios of the
    inner peaks and the weights; see `_conditions`.

    Parameters
    ----------
    problem
        The bands.
    point
        Where Newton's method begins; it says too how many impulses and peaks there are.
    tolerance
        Residual that every peak touches [-].

    Returns
    -------
    Point or None
        The optimum; None where there are not as many conditions as unknowns, or Newton's method
        does not converge.
    """
    places = _Places(
        impulses=point.lags.size,
        peaks=point.ratios.size,
        inner=np.flatnonzero(point.inner),
        free=problem.levels is None,
    )
    if places.rows != places.columns:
        return None
    now = point
    for step in range(MAX_STEPS):
        conditions = _conditions(problem, now, places, tolerance)
        if conditions is None:
            return None
        value, jacobian = conditions
        try:
            change = np.linalg.solve(jacobian, -value)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(change).all():
            return None
        lag_change = np.concatenate(([0.0], change[: places.impulses - 1]))
        scale = _step_share(problem, now, places, lag_change, change[places.ratios])
        change *= scale
        now = _move(now, places, scale * lag_change, change)
        longest = float(now.lags[-1])
        if longest > 2 * point.lags[-1]:
            return None
        farthest = float(np.abs(change[: places.ratios.stop]).max())
        if scale == 1 and farthest < CONVERGED * max(1.0, longest):
            return replace(now, steps=point.steps + step + 1)
    return None


def _move(now: Point, places: _Places, lag_change: FloatArray, change: FloatArray) -> Point:
    """Return a point after a step."""
    ratios = now.ratios.copy()
    ratios[places.inner] += change[places.ratios]
    amplitudes = now.amplitudes
    return replace(
        now,
        lags=now.lags + lag_change,
        amplitudes=amplitudes + change[places.amplitudes] if places.free else amplitudes,
        ratios=ratios,
        weights=now.weights + change[places.ratios.stop :],
    )


def _step_share(
    problem: BandProblem,
    now: Point,
    places: _Places,
    lag_change: FloatArray,
    ratio_change: FloatArray,
) -> float:
    """Return the share of a step that is taken: no gap more than halves, no peak goes far."""
    shrink = -np.diff(lag_change) / np.diff(now.lags)
    scale = min(1.0, 0.5 / max(float(shrink.max()), 1e-9))
    if ratio_change.size:
        widths = np.array([one.width for one in problem.bands])[now.bands[places.inner]]
        reach = float((np.abs(ratio_change) / widths).max())
        scale = min(scale, 0.25 / max(reach, 1e-9))
    return scale


def _conditions(
    problem: BandProblem, now: Point, places: _Places, tolerance: float
) -> tuple[FloatArray, FloatArray] | None:
    """Return the conditions of optimality and their Jacobian; None where a peak is zero.

    With ``e_ki = exp(s_k u_i) / F_k``::

        ln |F_k| = ln V                                 every peak touches
        Re(e_k' of r) = 0                               and is a peak, or sits on its band's edge
        Re(sum_k weight_k s_k e_ki) = 0                 no inner impulse gains by moving
        Re(sum_k weight_k e_ki) = 1,  sum A = 1         none by growing: free amplitudes
        sum weight = 1                                  a scale: fixed amplitudes
    """
    lags, amplitudes, ratios, weights = now.lags, now.amplitudes, now.ratios, now.weights
    n, m, inner, free = places.impulses, places.peaks, places.inner, places.free
    p = inner.size
    sigma = problem.poles_at(now.bands, np.ones(m))
    poles = sigma * ratios
    turned = np.exp(np.multiply.outer(poles, lags))
    vector = turned @ amplitudes
    if not np.abs(vector).min() > 0:
        return None
    e = turned / vector[:, None]
    d = poles[:, None] * e
    to_lag = amplitudes * d
    weighted_lags = amplitudes * lags
    rho = sigma * (e @ weighted_lags)
    rho2 = sigma**2 * (e @ (weighted_lags * lags))
    drift = sigma[:, None] * lags - rho[:, None]

    jacobian = np.zeros((places.columns, places.columns))
    value = np.empty(places.columns)
    # every peak touches
    value[:m] = np.log(np.abs(vector)) - math.log(tolerance)
    jacobian[:m, : n - 1] = to_lag[:, 1:].real
    if free:
        jacobian[:m, places.amplitudes] = e.real
    jacobian[inner, places.ratios.start + np.arange(p)] = rho[inner].real
    # and is a peak
    rows = slice(m, m + p)
    value[rows] = rho[inner].real
    by_lag = amplitudes * (sigma[:, None] * e + drift * d)
    jacobian[rows, : n - 1] = by_lag[inner, 1:].real
    if free:
        jacobian[rows, places.amplitudes] = (e * drift)[inner].real
    jacobian[m + np.arange(p), places.ratios.start + np.arange(p)] = (rho2 - rho**2)[inner].real
    # no inner impulse gains by moving
    rows = slice(m + p, m + p + n - 2)
    weighted = weights @ d
    value[rows] = weighted.real[1:-1]
    bent = -(weights[:, None] * d).T @ to_lag
    bent[np.diag_indices(n)] += weights @ (poles[:, None] * d)
    jacobian[rows, : n - 1] = bent[1:-1, 1:].real
    if free:
        jacobian[rows, places.amplitudes] = -((weights[:, None] * d).T @ e)[1:-1].real
    turning = weights[:, None] * (sigma[:, None] * e + d * drift)
    jacobian[rows, places.ratios] = turning[inner, 1:-1].real.T
    jacobian[rows, places.ratios.stop :] = d[:, 1:-1].real.T
    if free:
        rows = slice(m + p + n - 2, m + p + 2 * n - 2)
        value[rows] = (weights @ e).real - 1
        jacobian[rows, : n - 1] = -((weights[:, None] * e).T @ to_lag)[:, 1:].real
        jacobian[rows, : n - 1][np.arange(1, n), np.arange(n - 1)] += weighted.real[1:]
        jacobian[rows, places.amplitudes] = -((weights[:, None] * e).T @ e).real
        jacobian[rows, places.ratios] = (weights[:, None] * e * drift)[inner].real.T
        jacobian[rows, places.ratios.stop :] = e.real.T
        value[-1] = amplitudes.sum() - 1
        jacobian[-1, places.amplitudes] = 1.0
    else:
        value[-1] = weights.sum() - 1
        jacobian[-1, places.ratios.stop :] = 1.0
    return value, jacobian
