"""A second route to moves of a free body by force: many starts of Newton's method, integration.

Nothing here calls the package's solver, bounds or certificate.
"""

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray


def state_after(
    command: Impulses, modes: tuple[Mode, ...], *, frequency_factor: float = 1.0
) -> tuple[float, float, float]:
    """Return way over force and mass, speed, and the largest vibration after a command.

    The vibration is its amplitude over that which one step of the force excites, undamped.
    """
    states = np.zeros(2)
    whole = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    levels = np.cumsum(command.amplitudes).tolist()
    gaps = [later - earlier for earlier, later in pairwise(command.times_s.tolist())]
    for level, gap in zip(levels, gaps, strict=False):
        states = (expm(whole * gap) @ np.append(states, level))[:2]
    largest = 0.0
    for mode in modes:
        w, z = frequency_factor * mode.natural_frequency_rad_s, mode.damping_ratio
        ringing = np.array([[0.0, w, 0.0], [-w, -2 * z * w, w], [0.0, 0.0, 0.0]])
        state = np.zeros(2)  # deflection over that of the force at rest, its rate over w
        for level, gap in zip(levels, gaps, strict=False):
            state = (expm(ringing * gap) @ np.append(state, level))[:2]
        largest = max(largest, float(np.hypot(*state)))
    return float(states[0]), float(states[1]), largest


def integrated_way(command: Impulses) -> float:
    """Return the way over force and mass by an integrator."""
    state = np.zeros(2)
    levels = np.cumsum(command.amplitudes)
    for level, (begin, end) in zip(levels, pairwise(command.times_s.tolist()), strict=False):
        state = solve_ivp(
            lambda _, x, level=level: [x[1], level], (begin, end), state, rtol=1e-12, atol=1e-14
        ).y[:, -1]
    return float(state[0])


def _misses(gaps: FloatArray, mode: Mode, way_s2: float, derivatives: int) -> FloatArray:
    """Return what alternating full forces of these durations miss."""
    ends = np.cumsum(gaps)
    left = ends[-1] - np.concatenate(([0.0], ends))
    heights = np.array([1.0, *([-2.0, 2.0] * gaps.size)[: gaps.size - 1], 0.0])
    heights[-1] = -heights.sum()
    pole = mode.pole_rad_s
    vectors = [heights @ np.exp(pole * left)]
    if derivatives:
        vectors.append(heights @ (abs(pole) * left * np.exp(pole * left)))
    parts = [part for vector in vectors for part in (vector.real, vector.imag)]
    return np.array([heights @ left, heights @ left**2 / 2 - way_s2, *parts])


def fastest_of_many(
    mode: Mode, way_s2: float, derivatives: int, starts: int, rng: np.random.Generator
) -> float:
    """Return the shortest time that Newton's method finds from many starts [s].

    Full force one way and the other, with as many switches as there are equations and up to four
    more or less: of more, those nearest to the start.
    """
    usual = 4 + 2 * derivatives
    best = np.inf
    for number in range(starts):
        count = usual + 2 * (number % 3) - 2 * (number % 5 == 0)
        gaps = rng.uniform(0.02, 1.0, count)
        gaps *= rng.uniform(1.0, 2.5) * (2 * np.sqrt(way_s2) + mode.period_s) / gaps.sum() / 1.5
        for _ in range(40):
            misses = _misses(gaps, mode, way_s2, derivatives)
            if np.abs(misses).max() < 1e-12 * max(1.0, way_s2):
                break
            slopes = np.empty((misses.size, count))
            for one in range(count):
                moved = gaps.copy()
                moved[one] += 1e-7
                slopes[:, one] = (_misses(moved, mode, way_s2, derivatives) - misses) / 1e-7
            step = np.linalg.lstsq(slopes, -misses, rcond=1e-12)[0]
            gaps = gaps + step * min(1.0, 0.3 * mode.period_s / max(np.abs(step).max(), 1e-300))
            if not np.isfinite(gaps).all() or gaps.min() < -mode.period_s:
                break
        else:
            continue
        if gaps.min() > 0 and np.abs(_misses(gaps, mode, way_s2, derivatives)).max() < 1e-9:
            best = min(best, float(gaps.sum()))
    return best
