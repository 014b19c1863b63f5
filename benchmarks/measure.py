"""How times are taken."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One line of the report.

    Attributes
    ----------
    what, value, limit
        What is measured, the figure in words, and what it must keep.
    met
        Whether it keeps it; None without a limit.
    over_peer
        Our time over that of a peer, where there is one [-].
    """

    what: str
    value: str
    limit: str
    met: bool | None
    over_peer: float | None = None

    @property
    def row(self) -> str:
        """The line as a row of a table."""
        met = {True: "met", False: "MISSED", None: ""}[self.met]
        return f"| {self.what} | {self.value} | {self.limit} | {met} |"


def alternating_medians(
    cases: dict[str, Callable[[], object]],
    *,
    rounds: int = 15,
    calls: int = 20,
    clock: Callable[[], float] = time.perf_counter,
) -> dict[str, list[float]]:
    """Return seconds a call of each case, one number a round.

    The cases take turns in every round, so that a machine whose speed drifts slows all alike.
    """
    for run in cases.values():
        run()
    seconds: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(rounds):
        for name, run in cases.items():
            started = clock()
            for _ in range(calls):
                run()
            seconds[name].append((clock() - started) / calls)
    return seconds


def ratio(seconds: dict[str, list[float]], name: str, peer: str) -> float:
    """Return the median of the ratios of two cases, round by round."""
    return median(a / b for a, b in zip(seconds[name], seconds[peer], strict=True))
