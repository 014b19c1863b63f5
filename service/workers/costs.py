"""What work is expected to cost, learned from what work of the same shape has cost.

Costs are processor time: how busy a machine is changes how long work takes, not how large it is.
"""

from collections import OrderedDict
from collections.abc import Hashable

SLICE_S = 0.25
"""Work that takes longer is large: it is moved out of the way of what is small [s]."""

MAX_SHAPES = 4096
"""Shapes that are remembered, the latest used."""

LEARNING = 0.3
"""Weight of the newest cost in the mean that is remembered."""

FIRST_GUESS_S = 0.005
"""What work of an unknown shape is expected to take before any was done [s]."""

MIN_COST_S = 1e-4
"""Work costs no less: below it the system's clocks tell nothing [s]."""


class Costs:
    """Mean cost of each shape, and of small work at large for shapes that are not known.

    What a task teaches that still runs is of its client's work alone: others ask for the same with
    other numbers, and theirs may be small.

    Attributes
    ----------
    small_s
        What small work takes, in the mean [s].
    """

    def __init__(self) -> None:
        self._means: OrderedDict[Hashable, float] = OrderedDict()
        self.small_s = FIRST_GUESS_S
        self._took_s = self._cost_s = FIRST_GUESS_S

    @property
    def slowness(self) -> float:
        """How many times its processor time small work takes, at least 1 [-]."""
        return max(self._took_s / self._cost_s, 1.0)

    def of(self, client: str, shape: Hashable) -> float:
        """Return what a client's work of a shape is expected to take [s].

        Parameters
        ----------
        client
            Whose work it is.
        shape
            What work shares that costs alike.

        Returns
        -------
        float
            Mean of the client's work of the shape, else of all work of the shape, else of small
            work; processor time [s].
        """
        for known in ((client, shape), shape):
            if known in self._means:
                self._means.move_to_end(known)
                return self._means[known]
        return self.small_s

    def record(self, client: str, shape: Hashable, seconds: float) -> None:
        """Learn what a client's work of a shape has taken.

        Parameters
        ----------
        client
            Whose work it was.
        shape
            What work shares that costs alike.
        seconds
            Processor time [s].
        """
        seconds = max(seconds, MIN_COST_S)
        if seconds < SLICE_S:
            self.small_s += LEARNING * (seconds - self.small_s)
        self._learn(shape, seconds)
        if (client, shape) in self._means:
            self._learn((client, shape), seconds)

    def took(self, seconds: float, cost_s: float) -> None:
        """Learn how long small work has taken beside what it cost.

        Parameters
        ----------
        seconds
            Time from its begin to its end [s].
        cost_s
            Processor time [s].
        """
        self._took_s += LEARNING * (seconds - self._took_s)
        self._cost_s += LEARNING * (max(cost_s, MIN_COST_S) - self._cost_s)

    def at_least(self, client: str, shape: Hashable, seconds: float) -> None:
        """Learn that a client's work takes so long at least: it still runs.

        Parameters
        ----------
        client
            Whose work it is.
        shape
            What work shares that costs alike.
        seconds
            What the work is taken to cost at least [s].
        """
        known = client, shape
        self._remember(known, max(self._means.get(known, 0.0), seconds))

    def _learn(self, known: Hashable, seconds: float) -> None:
        """Move a mean of logarithms, which one outlier does not tip."""
        mean_s = self._means.get(known, seconds)
        self._remember(known, mean_s * (seconds / mean_s) ** LEARNING)

    def _remember(self, known: Hashable, seconds: float) -> None:
        self._means[known] = seconds
        self._means.move_to_end(known)
        if len(self._means) > MAX_SHAPES:
            self._means.popitem(last=False)
