"""What work is expected to cost, learned from what work of the same shape has cost.

Costs are processor time: how busy a machine is changes how long work takes, not how large it is.
"""

import re
from collections import OrderedDict
from collections.abc import Hashable

SLICE_S = 0.25
"""Work that takes longer is large: it is moved out of the way of what is small [s]."""

MOST_SHAPES = 4096
"""Shapes that are remembered, the latest used."""

LEARNING = 0.3
"""Weight of the newest cost in the mean that is remembered."""

FIRST_GUESS_S = 0.005
"""What work of an unknown shape is expected to take before any was done [s]."""

LONGEST_SHAPE = 16_384
"""Bodies up to so long are told apart by all but their numbers; longer ones by length [bytes]."""

NUMBERS = re.compile(rb"[-+.\d]+(?:[eE][-+]?\d+)?")


def shape_of(operation: str, body: bytes) -> Hashable:
    """Return what two requests share that differ in their numbers only."""
    if len(body) > LONGEST_SHAPE:
        return operation, len(body).bit_length()
    return operation, NUMBERS.sub(b"", body)


class Costs:
    """Mean cost of each shape, and of small work at large for shapes that are not known.

    Attributes
    ----------
    small_s
        What small work takes, in the mean [s].
    slowness
        How much longer work takes than the processor time that it costs [-].
    """

    def __init__(self) -> None:
        self._means: OrderedDict[Hashable, float] = OrderedDict()
        self.small_s = FIRST_GUESS_S
        self.slowness = 1.0

    def of(self, shape: Hashable) -> float:
        """Return what work of a shape is expected to take [s]."""
        if shape not in self._means:
            return self.small_s
        self._means.move_to_end(shape)
        return self._means[shape]

    def record(self, shape: Hashable, seconds: float) -> None:
        """Learn what work of a shape has taken."""
        if seconds < SLICE_S:
            self.small_s += LEARNING * (seconds - self.small_s)
        known = self._means.get(shape, seconds)
        self._remember(shape, known + LEARNING * (seconds - known))

    def took(self, seconds: float, cost_s: float) -> None:
        """Learn how long work has taken beside what it cost."""
        if cost_s > 0.0:
            self.slowness += LEARNING * (max(seconds / cost_s, 1.0) - self.slowness)

    def at_least(self, shape: Hashable, seconds: float) -> None:
        """Learn that work of a shape takes so long at least: it still runs."""
        self._remember(shape, max(self._means.get(shape, 0.0), seconds))

    def _remember(self, shape: Hashable, seconds: float) -> None:
        if shape is None:
            return
        self._means[shape] = seconds
        self._means.move_to_end(shape)
        if len(self._means) > MOST_SHAPES:
            self._means.popitem(last=False)
