"""Newton's step for several designs side by side."""

from design.tables.compiled import compiled, inlined
from design.tables.equations import (
    COLUMNS,
    EXCHANGED,
    FACTOR,
    GAPS,
    LANES,
    MOVED,
    SYSTEM,
    VALUE,
    Switched,
    Unknowns,
    evaluate,
)
from design.types import FloatArray


@inlined
def _solve(block: FloatArray, unknowns: Unknowns) -> None:
    """Replace the equations' values by the solution of the linear system.

    Each element below the diagonal is eliminated by the row above or, if that has the smaller
    pivot, by its own, the two then changing places: pairwise pivoting (Sorensen 1985), without
    branches. The result of a singular matrix is not finite.
    """
    size = len(unknowns)
    for c in range(size):
        for r in range(c + 1, size):
            for lane in range(LANES):
                upper = block[SYSTEM + (c * COLUMNS + c) * LANES + lane]
                lower = block[SYSTEM + (r * COLUMNS + c) * LANES + lane]
                exchanged = abs(lower) > abs(upper)
                pivot = lower if exchanged else upper
                other = upper if exchanged else lower
                block[SYSTEM + (c * COLUMNS + c) * LANES + lane] = pivot
                block[EXCHANGED + lane] = 1.0 if exchanged else 0.0
                block[FACTOR + lane] = other / pivot
            for k in range(c + 1, COLUMNS):
                for lane in range(LANES):
                    upper = block[SYSTEM + (c * COLUMNS + k) * LANES + lane]
                    lower = block[SYSTEM + (r * COLUMNS + k) * LANES + lane]
                    exchanged = block[EXCHANGED + lane] != 0.0
                    kept = lower if exchanged else upper
                    other = upper if exchanged else lower
                    block[SYSTEM + (c * COLUMNS + k) * LANES + lane] = kept
                    block[SYSTEM + (r * COLUMNS + k) * LANES + lane] = (
                        other - block[FACTOR + lane] * kept
                    )
    for r in range(size - 1, -1, -1):
        for k in range(r + 1, size):
            for lane in range(LANES):
                block[SYSTEM + (r * COLUMNS + VALUE) * LANES + lane] -= (
                    block[SYSTEM + (r * COLUMNS + k) * LANES + lane]
                    * block[SYSTEM + (k * COLUMNS + VALUE) * LANES + lane]
                )
        for lane in range(LANES):
            block[SYSTEM + (r * COLUMNS + VALUE) * LANES + lane] /= block[
                SYSTEM + (r * COLUMNS + r) * LANES + lane
            ]


@compiled
def newton_step(
    block: FloatArray, switched: Switched, unknowns: Unknowns, longest_rad: float
) -> None:
    """Take a step of Newton's method in every lane.

    A step in which an unknown moves by more than ``longest_rad`` is shortened.

    Parameters
    ----------
    block
        Working memory of all lanes, shape (LENGTH,), with a design and unknowns in each.
    switched
        True for a switched actuator, None for superposed steps.
    unknowns
        As many zeros as unknowns.
    longest_rad
        Longest move of an unknown [rad]; inf for full steps.
    """
    size = len(unknowns)
    evaluate(block, switched, unknowns)
    _solve(block, unknowns)
    for lane in range(LANES):
        longest = moved = 0.0
        for k in range(size):
            length = abs(block[SYSTEM + (k * COLUMNS + VALUE) * LANES + lane])
            longest = max(longest, length)
            moved += length
        block[MOVED + lane] = moved
        block[FACTOR + lane] = longest_rad / longest if longest > longest_rad else 1.0
    for k in range(size):
        for lane in range(LANES):
            step = block[SYSTEM + (k * COLUMNS + VALUE) * LANES + lane]
            block[GAPS + k * LANES + lane] -= block[FACTOR + lane] * step
