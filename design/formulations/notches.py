"""Courses of a ramp that nearly lasts whole periods: one notch in it cancels the rest.

The ramp alone swings by ``V0 = (1 - exp(-s T)) / (s T)``, which is little there. Turned down at t
for a short d, it ends later by as much as it lost, and swings by
``V0 + (u + f) d (exp(-s T) - exp(-s t))``, with u and f its slopes up and down. No grid over the
whole course shows so short a notch.
"""

import numpy as np

from design.types import ComplexArray, FloatArray

LITTLE = 0.3
"""Swing of the ramp from which on a notch is no small change [-]."""

POINTS_PER_RAD = 40
"""Points at which a notch is tried [1/rad]."""

LONGEST_RAD = 50.0
"""Ramp beyond which none is looked for: a design refuses far shorter ones [rad]."""


def notched_ramps(pole: complex, rise: float, fall: float) -> tuple[FloatArray, ...]:
    """Return the switches of ramps with one notch that nothing is left of.

    Parameters
    ----------
    pole
        s of the mode, over its frequency [-].
    rise, fall
        How long the reference takes from 0 to 1 and from 1 to 0 [rad].

    Returns
    -------
    tuple of arrays of shape (3,)
        Up, down and up again, each nearly a solution; none where the ramp swings much [rad].
    """
    if rise > LONGEST_RAD:
        return ()
    alone = -np.expm1(-pole * rise) / (pole * rise)
    if abs(alone) > LITTLE or alone == 0:
        return ()
    times = np.linspace(0, rise, max(64, int(POINTS_PER_RAD * rise)))[1:-1]
    slopes = 1 / rise + 1 / fall
    lengths: ComplexArray = -alone / (slopes * (np.exp(-pole * rise) - np.exp(-pole * times)))
    crosses = np.flatnonzero(np.diff(np.sign(lengths.imag)) != 0)
    real = lengths.real[crosses]
    # Where the length is imaginary it changes its sign through infinity.
    found = crosses[(real > 0) & (real < rise / 4) & (lengths.real[crosses + 1] > 0)]
    return tuple(
        np.array([0.0, times[one], times[one] + lengths.real[one]]) for one in found.tolist()
    )
