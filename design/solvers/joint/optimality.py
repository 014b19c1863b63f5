"""Newton's method on the conditions of optimality: times, amplitudes and c at once."""

from dataclasses import dataclass

import numpy as np

from design.model.impulses import ROUNDING
from design.solvers.joint.dual_function import ZERO, DualFunction
from design.types import ComplexArray, FloatArray

NEWTON_STEPS = 30
CONVERGED = 1e-12
"""Step of times and amplitudes after which the next is rounding."""

MIN_GAP_RAD = 1e-6
"""Impulses closer than this, in turns of the slowest mode, are one [rad]."""

STRAYED = 2.0
"""Duration over that of its start beyond which Newton's method has lost its way [-]."""

LIFT = 1e-7
"""Height of P above zero at the impulses but the last; it costs the bound about as much [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shortest:
    """A command without vibration, as reported by the solver, and what excludes shorter ones.

    Attributes
    ----------
    times_rad, amplitudes
        Its impulses, shape (n,) each [rad], [-].
    vectors
        The c, shape (m,) [-].
    iterations
        Steps of Newton's method.
    programs
        Linear programs until then.
    """

    times_rad: FloatArray
    amplitudes: FloatArray
    vectors: ComplexArray
    iterations: int
    programs: int


def sharpen(
    dual: DualFunction, vectors: ComplexArray, times: FloatArray, programs: int
) -> Shortest | None:
    """Solve the conditions of optimality from c and times near them.

    Parameters
    ----------
    dual
        The function P of the plant.
    vectors
        c to begin with, shape (m,) [-].
    times
        Times of the impulses to begin with, ascending from 0, shape (n,) [rad].
    programs
        Linear programs until then, for the report.

    Returns
    -------
    Shortest or None
        None where Newton's method fails, or ends with vibration, with impulses that coincide, or
        with an amplitude that must be positive and is not.
    """
    amplitudes = np.where(np.arange(times.size) % 2 == 0, 1.0, -1.0)
    if dual.positive:
        amplitudes = _least_squares_amplitudes(dual, times)
    iterations, farthest = 0, STRAYED * times[-1]
    while iterations < NEWTON_STEPS:
        iterations += 1
        step = _newton_step(dual, times, amplitudes, vectors)
        moved = step[: times.size - 1]
        gaps, changes = np.diff(times), np.diff(moved, prepend=0.0)
        closing = changes < 0
        share = min(1.0, 0.7 * float(np.min(-gaps[closing] / changes[closing], initial=2.0)))
        step = share * step
        times = times + np.concatenate(([0.0], step[: times.size - 1]))
        rest = step[times.size - 1 :]
        if dual.positive:
            amplitudes = amplitudes + rest[: times.size]
            rest = rest[times.size :]
        real, imaginary = np.split(rest, 2)
        vectors = vectors + real + 1j * imaginary
        if times[-1] > farthest:
            return None
        if share == 1 and np.abs(step).max() < CONVERGED:
            break
    left = np.abs(dual.swings(times) @ amplitudes) * np.exp(dual.poles.real * times[-1])
    good = (
        left.max() < ZERO
        and np.diff(times).min() > MIN_GAP_RAD
        and (amplitudes.min() > ROUNDING or not dual.positive)
    )
    if not good:
        return None
    if dual.positive:
        vectors = _lift(dual, vectors, times)
    return Shortest(
        times_rad=times,
        amplitudes=amplitudes,
        vectors=vectors / np.linalg.norm(vectors),
        iterations=iterations,
        programs=programs,
    )


def _lift(dual: DualFunction, vectors: ComplexArray, times: FloatArray) -> ComplexArray:
    """Return c with P a little above zero where it touched, so that it passes it once only."""
    swings = dual.swings(times[:-1]).T
    rows = np.hstack((swings.real, swings.imag))
    real, imaginary = np.split(np.linalg.lstsq(rows, np.ones(times.size - 1), rcond=None)[0], 2)
    lifted: ComplexArray = vectors + LIFT * (real + 1j * imaginary)
    return lifted


def _least_squares_amplitudes(dual: DualFunction, times: FloatArray) -> FloatArray:
    swings = dual.swings(times) * np.exp(dual.poles.real * times[-1])[:, None]
    rows = np.vstack((swings.real, swings.imag, np.ones(times.size)))
    right = np.append(np.zeros(2 * dual.poles.size), 1.0)
    found: FloatArray = np.linalg.lstsq(rows, right, rcond=None)[0]
    return found


def _newton_step(
    dual: DualFunction, times: FloatArray, amplitudes: FloatArray, vectors: ComplexArray
) -> FloatArray:
    """Return the step of times, of amplitudes if positive, and of c: real, then imaginary.

    Equations: V = 0; the amplitudes' sum; ``|c| = 1``; ``P' = 0`` at the inner impulses, and of
    positive amplitudes ``P = 0`` at all: one equation too many but consistent, for
    ``sum A_i P(t_i)`` is zero where V is. Least squares minds neither that nor a c that
    is not unique.
    """
    m, n = dual.poles.size, times.size
    scale = np.exp(dual.poles.real * times[-1])[:, None]
    swings, rates, bends = (dual.swings(times, order) for order in range(3))
    left = (swings @ amplitudes) * scale[:, 0]
    c = vectors.conj()
    inner = slice(1, n - 1)
    own = n - 1 + n * dual.positive  # unknowns ahead of c
    rows, values = [], []

    def add(block: FloatArray, value: FloatArray) -> None:
        rows.append(block)
        values.append(value)

    def derivative_in_c(columns: ComplexArray) -> FloatArray:
        return np.hstack((columns.real.T, columns.imag.T))

    vibration = np.zeros((m, own + 2 * m), dtype=np.complex128)
    vibration[:, : n - 1] = rates[:, 1:] * amplitudes[1:] * scale
    if dual.positive:
        vibration[:, n - 1 : own] = swings * scale
    add(np.vstack((vibration.real, vibration.imag)), np.concatenate((left.real, left.imag)))
    flat = np.zeros((n - 2, own + 2 * m))
    flat[np.arange(n - 2), np.arange(n - 2)] = (c @ bends[:, inner]).real
    flat[:, own:] = derivative_in_c(rates[:, inner])
    add(flat, (c @ rates[:, inner]).real)
    if dual.positive:
        total = np.zeros((1, own + 2 * m))
        total[0, n - 1 : own] = 1.0
        add(total, np.array([amplitudes.sum() - 1]))
        touching = np.zeros((n, own + 2 * m))
        touching[np.arange(1, n), np.arange(n - 1)] = (c @ rates[:, 1:]).real
        touching[:, own:] = derivative_in_c(swings)
        add(touching, (c @ swings).real)
    length = np.zeros((1, own + 2 * m))
    length[0, own:] = 2 * np.concatenate((vectors.real, vectors.imag))
    add(length, np.array([float((np.abs(vectors) ** 2).sum()) - 1]))
    found: FloatArray = np.linalg.lstsq(np.vstack(rows), -np.concatenate(values), rcond=1e-13)[0]
    return found
