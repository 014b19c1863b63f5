"""Steps for several modes a second way: least squares from many starts, by formulas of its own.

Nothing here calls the package: what the steps leave is integrated over each gap between two, with
the drive's state carried by the eigenvalues of its set.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from design.types import ComplexArray, FloatArray

THESIS_SETS = ((20.0, 0.8), (50.0, 1.5))
"""Frequency [rad/s] and damping ratio of the drive of Kim 2011, accelerating before braking."""

ZERO = 1e-11
"""Largest residual of a solution [-]."""


@dataclass(frozen=True)
class Plant:
    """Modes behind a second-order drive.

    Attributes
    ----------
    frequencies, dampings
        Of the modes [rad/s] and [-].
    sets
        Of the drive.
    switched
        Whether one state passes from set to set.
    """

    frequencies: tuple[float, ...]
    dampings: tuple[float, ...]
    sets: tuple[tuple[float, float], ...] = THESIS_SETS
    switched: bool = False

    @property
    def poles(self) -> ComplexArray:
        """Upper poles of the modes [rad/s]."""
        w, z = np.array(self.frequencies), np.array(self.dampings)
        poles: ComplexArray = w * (-z + 1j * np.sqrt(1 - z * z))
        return poles

    def left(self, gaps_s: FloatArray) -> ComplexArray:
        """Return the vibration of each mode at the last step, over that of one unshaped step."""
        s = self.poles
        gain = [a * a / (s * s + 2 * z * a * s + a * a) for a, z in self.sets]
        if not self.switched:
            times = np.append(0.0, np.cumsum(gaps_s))
            signs = 1.0 - 2.0 * (np.arange(times.size) % 2)
            turns = np.exp(s[:, None] * (times[-1] - times))
            chosen = np.where(np.arange(times.size) % 2 == 0, gain[0][:, None], gain[1][:, None])
            added: ComplexArray = (turns * chosen * signs).sum(axis=1) / gain[0]
            return added
        # The integral of v' exp(-s t): over a gap v' is a sum of two exponentials, after the last
        # step that of the set in force to its end.
        total = np.zeros_like(s)
        velocity, rate, level = 0.0, 0.0, 0.0
        for index, gap in enumerate([*gaps_s.tolist(), np.inf]):
            level = 1.0 - level
            a, z = self.sets[index % 2]
            root = np.sqrt(complex(z * z - 1))
            slow, fast = a * (-z + root), a * (-z - root)
            # v - level = c1 exp(slow t) + c2 exp(fast t)
            c2 = (rate - slow * (velocity - level)) / (fast - slow)
            c1 = velocity - level - c2
            ended = 0.0 if gap == np.inf else 1.0
            time = 0.0 if gap == np.inf else gap
            for c, p in ((c1, slow), (c2, fast)):
                total += c * p * (ended * np.exp((p - s) * time) - 1) / (p - s)
            total = total * np.exp(s * time)
            one, other = c1 * np.exp(slow * time), c2 * np.exp(fast * time)
            velocity, rate = (
                float((level + one + other).real),
                float((slow * one + fast * other).real),
            )
        return total / gain[0]

    def fastest(self, starts: int, shortest_s: float, seed: int) -> FloatArray | None:
        """Return the times of the fastest of so many runs, shape (n,) [s]; None if none is one."""
        rng = np.random.default_rng(seed)
        count, slowest_s = 2 * len(self.frequencies), 2 * np.pi / min(self.frequencies)

        def equations(gaps_s: FloatArray) -> FloatArray:
            left = self.left(gaps_s)
            return np.concatenate((left.real, left.imag))

        best: FloatArray | None = None
        for _ in range(starts):
            times = np.sort(rng.uniform(0, rng.uniform(0.3, 1.5) * slowest_s, count))
            start = np.maximum(np.diff(times, prepend=0.0), 2 * shortest_s)
            # A first pass is rough: most runs end nowhere.
            run = least_squares(equations, start, bounds=(shortest_s, 3 * slowest_s), max_nfev=30)
            if run.cost > 1e-6:
                continue
            run = least_squares(equations, run.x, method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15)
            found = np.cumsum(run.x)
            inside = run.x.min() >= shortest_s and found[-1] <= 3 * slowest_s
            if inside and np.abs(run.fun).max() < ZERO and (best is None or found[-1] < best[-1]):
                best = found
        return best
