"""A command with one step for each of its changes."""

import numpy as np

from design.errors import InvalidInputError
from design.model.impulses import ROUNDING, Impulses


def merged(impulses: Impulses) -> Impulses:
    """Return the same command with one step for each of its changes.

    Steps at one time are added up; those of no height, which change nothing, are left out.

    Returns
    -------
    Impulses
        Of k <= n steps; this very record if none are to be added up or left out.

    Raises
    ------
    InvalidInputError
        If all cancel.

    Examples
    --------
    >>> given = Impulses(
    ...     times_s=np.array([0.0, 2.0, 2.0]), amplitudes=np.array([0.5, 0.5, -0.5])
    ... )
    >>> merged(given).times_s.tolist()
    [0.0]
    """
    first = np.roll(impulses.last_of_instants(), 1)  # after the last of one comes the next's first
    summed = np.add.reduceat(impulses.amplitudes, np.flatnonzero(first))
    moves = np.abs(summed) > ROUNDING * float(np.abs(impulses.amplitudes).sum())
    if moves.all() and first.all():
        return impulses
    if not moves.any():
        raise InvalidInputError(
            "amplitudes",
            impulses.amplitudes.tolist(),
            "not all zero, added up at each time",
            code="amplitudes_cancel",
        )
    # What is left out is added to the step before it: levels stay as they are.
    kept = np.flatnonzero(first)[moves]
    return Impulses(
        times_s=impulses.times_s[kept], amplitudes=np.add.reduceat(impulses.amplitudes, kept)
    )
