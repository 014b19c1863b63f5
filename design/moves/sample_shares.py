"""Where the steps of a command may go on samples: which, by which sign, from which split."""

from dataclasses import dataclass

import numpy as np

from design.model.impulses import Impulses
from design.sampling.sample_grid import ON_SAMPLE, nearest_integers
from design.types import BoolArray, FloatArray, IntArray

NO_SHARE = 1e-12
"""Net step on a sample that is none: what two steps of opposite sign make there [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampleShares:
    """The samples around the steps of a command, and what each may take of them.

    Attributes
    ----------
    numbers
        Samples, ascending, shape (m,).
    split
        The command's linear split on them, shape (m,) [-].
    rising
        Which may step up, shape (m,); the others down.
    groups
        To which group of steps each belongs, ascending, shape (m,): steps that share a sample are
        one group.
    totals
        What the steps of each group add up to, shape (g,) [-].
    crossed
        Which groups hold more than one step, shape (g,): the levels between
        need bounds.
    """

    numbers: IntArray
    split: FloatArray
    rising: BoolArray
    groups: IntArray
    totals: FloatArray
    crossed: BoolArray

    def only(self, kept: BoolArray) -> "SampleShares":
        """Return the same on some of the samples."""
        return SampleShares(
            numbers=self.numbers[kept],
            split=self.split[kept],
            rising=self.rising[kept],
            groups=self.groups[kept],
            totals=self.totals,
            crossed=self.crossed,
        )


def sample_shares(
    command: Impulses, sample_time_s: float, *, reach: int, later: int, fix_first: bool
) -> SampleShares:
    """Return the samples around the steps of a command.

    Parameters
    ----------
    command
        The steps, the first at 0 or later.
    sample_time_s
        Sample time [s].
    reach
        Samples on each side of a step, >= 1; each belongs to the step nearest to it.
    later
        Samples after the first at or after the last step, >= 0.
    fix_first
        Whether the first step stays on the sample that it is on.

    Returns
    -------
    SampleShares
        None before the first step.
    """
    positions = command.times_s / sample_time_s
    whole = nearest_integers(positions)
    positions = np.where(np.abs(positions - whole) <= ON_SAMPLE, whole, positions)
    before, after = np.floor(positions).astype(int), np.ceil(positions).astype(int)
    around = np.add.outer(np.arange(1 - reach, reach), np.stack([before, after])).ravel()
    last = after[-1] + min(later, reach)
    numbers = np.unique(np.concatenate((around, np.arange(after[-1], last + 1))))
    first = before[0]
    numbers = numbers[(numbers >= first) & (numbers <= last)]
    split = np.zeros(numbers.size)
    late = positions - before
    np.add.at(split, np.searchsorted(numbers, before), command.amplitudes * (1 - late))
    np.add.at(split, np.searchsorted(numbers, after), command.amplitudes * late)
    middles = (positions[1:] + positions[:-1]) / 2
    nearest = np.searchsorted(middles, numbers, side="left")
    if fix_first:
        kept = (nearest > 0) | (numbers == first)
        numbers, split, nearest = numbers[kept], split[kept], nearest[kept]
    own = np.where(np.abs(split) > NO_SHARE, split, command.amplitudes[nearest])
    group_of_step = np.concatenate(([0], np.cumsum(before[1:] > after[:-1])))
    return SampleShares(
        numbers=numbers,
        split=split,
        rising=own > 0,
        groups=group_of_step[nearest],
        totals=np.bincount(group_of_step, weights=command.amplitudes).astype(float),
        crossed=np.bincount(group_of_step) > 1,
    )
