"""Random states of stops, and second opinions on the least way."""

import math

import numpy as np
from scipy.optimize import minimize

from design.live.emergency import CaseStop
from design.live.stop_case import StopCase
from design.types import FloatArray

OMEGA = math.sqrt(9.81 / 0.8)
KIM_LAGS = np.array([[2 * 0.8 / 20, 1 / 20**2], [2 * 1.5 / 50, 1 / 50**2]])


def pole(frequency_rad_s: float, damping_ratio: float) -> complex:
    """Return the upper pole of a mode."""
    return frequency_rad_s * complex(-damping_ratio, math.sqrt(1 - damping_ratio**2))


def random_case(rng: np.random.Generator, lags: FloatArray, *, switched: bool = True) -> StopCase:
    """Return any state of a drive with modes, and some time to stop in."""
    damping = rng.choice([0.0, 0.01, 0.05])
    modes = int(rng.choice([1, 1, 2]))
    poles = np.array([pole(OMEGA, damping), pole(rng.uniform(1.8, 3.3) * OMEGA, damping)][:modes])
    lag = np.zeros((2, 2))
    if lags.any():
        lag[0] = rng.normal(size=2) * [0.3, 3]
    swing = rng.uniform(0, 1.2, modes) * np.exp(2j * np.pi * rng.uniform(size=modes))
    return StopCase(
        level=float(rng.choice([0.0, 0.4, 1.0, 1.0])),
        force=int(rng.integers(2)),
        lag=lag,
        vibration=swing,
        lags=lags,
        poles_rad_s=poles,
        switched=switched,
        end_s=float(rng.choice([0.7, 1, 1, 1.5, 2, 3])) * math.tau / OMEGA,
    )


def bound_of_way(case: StopCase, done: CaseStop, swing_left: float) -> float:
    """Return what no way can be below, by duality, behind sets that are alike.

    For any complex c of each mode and any command u in [0, 1] that leaves V with |V| <= r,
    ``integral u dt >= integral u (1 + Re(conj(c) k)) dt + Re(conj(c) V_0) - sum r |c|``, with k
    what u adds to V, and V_0 what is left without it.
    """
    gain = case.gains[0]
    off = case.switches_of([])
    given = case.left_by(off.times_s, off.levels)
    times = np.linspace(0.0, case.end_s, 40_001)
    turned = np.exp(case.poles_rad_s[:, None] * (case.end_s - times))
    weights = np.conj(done.stop.pulls) * gain * case.poles_rad_s
    below = np.minimum(1 + (weights @ turned).real, 0.0)
    known = float((np.conj(done.stop.pulls) * given.vibration).real.sum())
    allowed = swing_left * float((np.abs(gain) * np.abs(done.stop.pulls)).sum())
    return given.way_s + known - allowed + float(np.trapezoid(below, times))


def least_of_random_starts(
    case: StopCase, swing_left: float, starts: int, rng: np.random.Generator
) -> float:
    """Return the least way of SLSQP from random pulses, infinite if none is found.

    Pulses and gaps last a hundredth of a period: a shorter pulse only changes the set in force,
    which no drive can follow.
    """
    radii = swing_left * np.abs(case.gains[0])
    periods = max(1, round(case.end_s * case.slowest_rad_s / math.tau))
    least_s = 0.01 * math.tau / case.quickest_rad_s
    off = [0.0] if case.level else []
    best = math.inf
    for _ in range(starts):
        many = int(rng.integers(1, periods + 2))
        levels = np.array([*off, *[1.0, 0.0] * many])
        begin = len(off)

        def left(times: FloatArray, begin: int = begin, levels: FloatArray = levels):  # type: ignore[no-untyped-def] # noqa: ANN202
            whole = np.concatenate((np.zeros(begin), np.clip(times, 0, case.end_s)))
            return case.left_by(whole, levels)

        def equations(times: FloatArray) -> FloatArray:
            vibration = left(times).vibration
            if swing_left:
                return np.asarray(radii**2 - np.abs(vibration) ** 2)
            return np.concatenate((vibration.real, vibration.imag))

        def jacobian(times: FloatArray, begin: int = begin) -> FloatArray:
            vibration, rows, *_ = left(times)
            rows = rows[begin:].T
            if swing_left:
                return np.asarray(-2 * (np.conj(vibration)[:, None] * rows).real)
            return np.concatenate((rows.real, rows.imag))

        def gaps(times: FloatArray) -> FloatArray:
            apart = np.diff(times, prepend=0.0, append=case.end_s)
            apart[1:-1] -= least_s
            return apart

        rules = [
            {"type": "ineq", "fun": gaps},
            {"type": "ineq" if swing_left else "eq", "fun": equations, "jac": jacobian},
        ]
        found = minimize(
            lambda times: left(times).way_s,
            np.sort(rng.uniform(0, case.end_s, 2 * many)),
            jac=lambda times, begin=begin: left(times).way_by_times[begin:],
            constraints=rules,
            method="SLSQP",
            options={"maxiter": 80, "ftol": 1e-12},
        )
        missed = equations(found.x)
        missed = np.minimum(missed, 0.0) if swing_left else missed
        if np.abs(missed).max() <= 1e-7 and gaps(found.x).min() >= -1e-9:
            best = min(best, float(found.fun))
    return best
