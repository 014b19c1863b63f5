"""The impulses that Klipper computes from the name of a shaper, a frequency and a damping ratio.

With d = sqrt(1 - z^2), T = 1 / (f d) the damped period and K = exp(-pi z / d) what a mode keeps
over half of it. Klipper divides the heights by their sum, whatever that is [1]_.

Names and parameters are those of [2]_: ``zv``, ``zvd``, ``mzv`` with n impulses in t periods (by
default 3 and 0.75), ``ei`` with its vibration tolerance (by default 0.05), ``2hump_ei``,
``3hump_ei``. The last three are polynomials in z that were fitted to damped shapers. Before
2025-09-16 they were the undamped shapers with K to the power of each impulse's number [3]_; Kalico
still computes them so [4]_. Parameters in brackets came on 27 April 2026 [5]_; what does not know
them refuses the line. From 2025-09-16 to 2026-03-31 a missing comma spoilt ``3hump_ei`` of damped
modes [6]_.

References
----------
.. [1] Klipper, klippy/chelper/kin_shaper.c, init_shaper: at most 10 impulses, times increasing.
.. [2] Klipper, docs/Resonance_Compensation.md, "Input shapers", and docs/Config_Reference.md,
   "[input_shaper]"; coefficients: klippy/extras/shaper_defs.py.
.. [3] Klipper, docs/Config_Changes.md, 20250916.
.. [4] Kalico, klippy/extras/shaper_defs.py.
.. [5] Klipper, klippy/extras/shaper_defs.py, "Support parameterized shaper initialization"
   and "Support more parameters for customizable input shapers", on master from
   27 April 2026 on.
.. [6] Klipper, pull request 7235.
"""

import math
from collections.abc import Callable

import numpy as np

from design.model.impulses import Impulses
from design.types import FloatArray

MAX_DAMPING_RATIOS = {
    "zv": 0.99,
    "mzv": 0.99,
    "zvd": 0.99,
    "ei": 0.4,
    "2hump_ei": 0.3,
    "3hump_ei": 0.2,
}
"""Largest damping ratio that Klipper takes for each shaper (shaper_defs.py, INPUT_SHAPERS)."""

MAX_IMPULSES = 10
"""Of one shaper (kin_shaper.c, struct shaper_pulses)."""

USUAL_TOLERANCE = 0.05
"""Vibration tolerance of ``ei`` without a parameter [-]."""

EI_FIRST = ((0.24968, 0.24961), (0.80008, 1.23328), (0.49599, 3.17316))
EI_LAST = ((0.25149, 0.21474), (-0.83249, 1.41498), (0.85181, -4.90094))
"""Heights of the first and the last impulse of ``ei``: powers of z, then of the tolerance."""

EI_MIDDLE = (
    (0.4999, 0.0, 0.0),
    (0.0, 0.46159, 8.57843),
    (0.0, 4.26169, -108.644),
    (0.0, 1.75601, 336.989),
)
"""Time of the middle impulse of ``ei`` in damped periods: powers of z, then of the tolerance."""

TWO_HUMPS = (
    ((0.0, 0.0, 0.0, 0.0), (0.16054, 0.76699, 2.26560, -1.22750)),
    ((0.49890, 0.16270, -0.54262, 6.16180), (0.33911, 0.45081, -2.58080, 1.73650)),
    ((0.99748, 0.18382, -1.58270, 8.17120), (0.34089, -0.61533, -0.68765, 0.42261)),
    ((1.49920, -0.09297, -0.28338, 1.85710), (0.15997, -0.60246, 1.00280, -0.93145)),
)
THREE_HUMPS = (
    ((0.0, 0.0, 0.0, 0.0), (0.11275, 0.76632, 3.29160, -1.44380)),
    ((0.49974, 0.23834, 0.44559, 12.4720), (0.23698, 0.61164, -2.57850, 4.85220)),
    ((0.99849, 0.29808, -2.36460, 23.3990), (0.30008, -0.19062, -2.14560, 0.13744)),
    ((1.49870, 0.10306, -2.01390, 17.0320), (0.23775, -0.73297, 0.46885, -2.08650)),
    ((1.99960, -0.28231, 0.61536, 5.40450), (0.11244, -0.45439, 0.96382, -1.46000)),
)
"""Time in undamped periods and height of each impulse: powers of z."""

Listed = tuple[list[float], list[float]]
"""Times and heights of impulses."""


def klipper_impulses(
    shaper: str,
    frequency_hz: float,
    damping_ratio: float,
    *,
    impulses: int = 3,
    periods: float = 0.75,
    tolerance: float = USUAL_TOLERANCE,
) -> Impulses:
    """Return the impulses that Klipper of 2026 plays.

    Parameters
    ----------
    shaper
        A name of `MAX_DAMPING_RATIOS`.
    frequency_hz, damping_ratio
        Of the mode, as on the line [Hz], [-].
    impulses, periods
        n and t of ``mzv``.
    tolerance
        v_tol of ``ei`` [-].

    Returns
    -------
    Impulses
        Of sum 1, the first at 0.
    """
    z = damping_ratio
    d = math.sqrt(1 - z * z)
    if shaper in {"2hump_ei", "3hump_ei"}:
        fits = TWO_HUMPS if shaper == "2hump_ei" else THREE_HUMPS
        times = [_polynomial(time, z) / frequency_hz for time, _ in fits]
        heights = [_polynomial(height, z) for _, height in fits]
    elif shaper == "ei":
        first, last = (_in_both(fit, z, tolerance) for fit in (EI_FIRST, EI_LAST))
        middle = _in_both(EI_MIDDLE, z, tolerance)
        times = [0.0, middle / (frequency_hz * d), 1 / (frequency_hz * d)]
        heights = [first, 1 - first - last, last]
    elif shaper == "mzv":
        times, heights = _decaying(periods / (impulses - 1), _even(impulses, periods), z)
        times = [time / frequency_hz for time in times]
    else:
        undamped = [1.0, 1.0] if shaper == "zv" else [1.0, 2.0, 1.0]
        times, heights = _decaying(0.5, undamped, z)
        times = [time / frequency_hz for time in times]
    return _normalise(times, heights)


def older_klipper_impulses(shaper: str, frequency_hz: float, damping_ratio: float) -> Impulses:
    """Return what Klipper before 2025-09-16 and Kalico play.

    They know no parameters of a shaper.

    Parameters
    ----------
    shaper
        A name of `MAX_DAMPING_RATIOS`.
    frequency_hz, damping_ratio
        Of the mode, as on the line [Hz], [-].

    Returns
    -------
    Impulses
        Of sum 1, the first at 0.
    """
    undamped, spacing = OLDER[shaper]
    times, heights = _decaying(spacing, undamped(), damping_ratio)
    return _normalise([time / frequency_hz for time in times], heights)


def _older_two_humps() -> list[float]:
    squared = USUAL_TOLERANCE**2
    x = (squared * (math.sqrt(1 - squared) + 1)) ** (1 / 3)
    first = (3 * x * x + 2 * x + 3 * squared) / (16 * x)
    return [first, 0.5 - first, 0.5 - first, first]


def _older_three_humps() -> list[float]:
    v = USUAL_TOLERANCE
    first = (1 + 3 * v + 2 * math.sqrt(2 * (v + 1) * v)) / 16
    second = (1 - v) / 4
    return [first, second, (1 + v) / 2 - 2 * first, second, first]


OLDER: dict[str, tuple[Callable[[], list[float]], float]] = {
    "zv": (lambda: [1.0, 1.0], 0.5),
    "zvd": (lambda: [1.0, 2.0, 1.0], 0.5),
    "mzv": (lambda: [1 - math.sqrt(0.5), math.sqrt(2) - 1, 1 - math.sqrt(0.5)], 0.375),
    "ei": (
        lambda: [(1 + USUAL_TOLERANCE) / 4, (1 - USUAL_TOLERANCE) / 2, (1 + USUAL_TOLERANCE) / 4],
        0.5,
    ),
    "2hump_ei": (_older_two_humps, 0.5),
    "3hump_ei": (_older_three_humps, 0.5),
}
"""Undamped heights, and their distance in damped periods."""


def _polynomial(powers: tuple[float, ...], at: float) -> float:
    return sum(power * at**number for number, power in enumerate(powers))


def _in_both(fit: tuple[tuple[float, ...], ...], z: float, tolerance: float) -> float:
    return _polynomial(tuple(_polynomial(powers, tolerance) for powers in fit), z)


def rounding_of_mzv(impulses: int, periods: float) -> float:
    """Return about what rounding does to the heights of ``mzv`` [-].

    Klipper solves the normal equations (klippy/mathutil.py, pseudo_inverse), whose condition is the
    square of that of its equations; near singular ones it refuses.

    Parameters
    ----------
    impulses, periods
        n and t of ``mzv``.

    Returns
    -------
    float
        Share of the heights [-].
    """
    return float(np.finfo(float).eps * np.linalg.cond(_zeros_of_mzv(impulses, periods)) ** 2)


def _even(impulses: int, periods: float) -> list[float]:
    """Return the heights of ``mzv`` undamped."""
    system = _zeros_of_mzv(impulses, periods)
    wanted = np.zeros(len(system))
    wanted[0] = 1
    heights: list[float] = (np.linalg.pinv(system) @ wanted).tolist()
    return heights


def _zeros_of_mzv(impulses: int, periods: float) -> FloatArray:
    """Return the equations of its heights: a sum of 1, and zeros at 1, 1 + 1/tau, 1 + 2/tau, ...

    They are more than there are heights, but not in conflict.
    """
    tau = periods * (impulses - 2) / (impulses - 2 * periods - 1)
    ratios = 1 + np.arange(impulses - 1) / tau
    times = periods * np.arange(impulses) / (impulses - 1)
    turns = 2 * np.pi * np.outer(ratios, times)
    return np.vstack((np.ones(impulses), np.cos(turns), np.sin(turns)))


def _decaying(spacing: float, undamped: list[float], z: float) -> Listed:
    """Return times in undamped periods, evenly spaced in damped ones, and damped heights."""
    d = math.sqrt(1 - z * z)
    kept = math.exp(-2 * math.pi * spacing * z / d)
    times = [number * spacing / d for number in range(len(undamped))]
    return times, [height * kept**number for number, height in enumerate(undamped)]


def _normalise(times_s: list[float], heights: list[float]) -> Impulses:
    amplitudes = np.array(heights)
    return Impulses(times_s=np.array(times_s), amplitudes=amplitudes / amplitudes.sum())
