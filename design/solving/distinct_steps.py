"""Steps that are rounding, and steps at one time, taken out of what a solver answers with."""

import numpy as np

from design.model.impulses import Impulses

SAME_TIME = 1e-12
"""Steps of convolved shapers closer than this, over the duration, are one [-]."""

NO_STEP = 1e-15
"""Share of all steps' sizes that is what their sum is rounded by, a few times [-].

Larger ones may count, small as they are: those that end a command in a heavily damped mode, where
what came before has decayed.
"""


def distinct_steps(impulses: Impulses) -> Impulses:
    """Join steps at the same time, and leave out those that are rounding.

    The same time is one up to rounding. Left out are the smallest steps as long as they are less
    than `NO_STEP` of all together, so that what the others claim to be zero stays so.
    """
    times, amplitudes = impulses.times_s, impulses.amplitudes
    apart = np.diff(times, prepend=-np.inf) > SAME_TIME * impulses.duration_s
    summed = np.add.reduceat(amplitudes, np.flatnonzero(apart))
    sizes = np.abs(summed)
    order = np.argsort(sizes, kind="stable")
    kept = np.empty(sizes.size, dtype=np.bool_)
    kept[order] = np.cumsum(sizes[order]) > NO_STEP * sizes.sum()
    if apart.all() and kept.all():
        return impulses
    times = times[apart][kept]
    return Impulses(times_s=times - times[0], amplitudes=summed[kept] / summed[kept].sum())
