"""What a shaper does to a path: how late it is, and by how much it rounds it."""

from dataclasses import dataclass

from design.model.impulses import Impulses


@dataclass(frozen=True, slots=True, kw_only=True)
class Smoothing:
    """Delay and rounding.

    Attributes
    ----------
    delay_s
        Mean time of the impulses, weighted by their amplitudes: how much later a shaped motion at
        constant speed arrives [s].
    smoothing_s2
        Half the weighted mean square of their times about that one: under a constant acceleration a
        the shaped motion is ``a smoothing_s2`` ahead of the unshaped one, begun ``delay_s`` later
        [s^2]. Below zero, which negative impulses can make it, it is behind.
    """

    delay_s: float
    smoothing_s2: float


def smoothing(impulses: Impulses) -> Smoothing:
    """Return by how much a shaper delays and rounds a path.

    A shaped path is ``sum A_i x(t - t_i)`` over ``sum A_i``. For ``x = a t^2 / 2`` and once all
    impulses are in, that is ``x`` at ``t - delay`` plus ``a sum A_i (t_i - delay)^2 / 2``.

    Parameters
    ----------
    impulses
        A shaper whose amplitudes do not cancel.

    Returns
    -------
    Smoothing
        Delay and rounding, counted from the first impulse.

    Examples
    --------
    >>> import numpy as np
    >>> zv = Impulses(times_s=np.array([0.0, 0.2]), amplitudes=np.array([0.5, 0.5]))
    >>> found = smoothing(zv)
    >>> round(found.delay_s, 12), round(found.smoothing_s2, 12)
    (0.1, 0.005)
    """
    shares = impulses.amplitudes / impulses.amplitudes.sum()
    times = impulses.times_s - impulses.times_s[0]
    delay = float(shares @ times)
    return Smoothing(delay_s=delay, smoothing_s2=float(shares @ (times - delay) ** 2) / 2)
