"""How long a request may expect to wait before it is refused at once."""

from dataclasses import dataclass

BURST_S = 0.25
"""Expected wait that is accepted while what comes is not more than what is done [s]."""

STANDING_S = 0.0025
"""The same while more comes than is done, so that what is served is served soon [s]."""

INTERVAL_S = 0.06
"""Over what arrivals and answers are counted [s]."""

INTERVALS = 2
"""Intervals in a row in which more must have come than was done: a burst is of one."""

OVER = 10
"""Intervals without an arrival or an answer after which an overload is over."""

GROWING = 1.2
"""Arrivals over answers from which it is an overload, and no long queue alone: a fixed number of
clients, each waiting for its own answer, has as many of the one as of the other. It begins only
where some are expected to wait for half a burst."""

MIN_SURPLUS_ARRIVALS = 5
"""Arrivals beyond that which are chance."""

BURST_COSTS, STANDING_COSTS = 10.0, 1.0
"""The same waits in multiples of what the request itself is expected to take, where longer [-]."""


@dataclass(slots=True)
class Patience:
    """Accepts bursts, and under a lasting overload so few that those are served soon.

    Times are of any clock that only moves forward [s].
    """

    _since: float = 0.0
    _arrived: int = 0
    _answered: int = 0
    _longest_s: float = 0.0
    _growing: int = 0

    def admits(self, now: float, wait_s: float, cost_s: float) -> bool:
        """Count an arrival, and return whether it may wait.

        Parameters
        ----------
        now
            Time of the arrival [s].
        wait_s
            Expected wait [s].
        cost_s
            What the request itself is expected to take [s].

        Returns
        -------
        bool
            Whether the wait is within the limit, which is shorter under a lasting overload.
        """
        self._turn(now)
        self._arrived += 1
        self._longest_s = max(self._longest_s, wait_s)
        return wait_s <= self._limit_s(cost_s)

    def refuses(self, now: float, wait_s: float, cost_s: float) -> bool:
        """Return whether an arrival may not wait under an overload.

        The arrival is counted only if it may not.

        Parameters
        ----------
        now
            Time of the arrival [s].
        wait_s
            Expected wait [s].
        cost_s
            What the request itself is expected to take [s].

        Returns
        -------
        bool
            False where there is no lasting overload, however long the wait.
        """
        self._turn(now)
        refused = self._growing >= INTERVALS and wait_s > self._limit_s(cost_s)
        self._arrived += refused
        return refused

    def _limit_s(self, cost_s: float) -> float:
        if self._growing >= INTERVALS:
            return max(STANDING_S, STANDING_COSTS * cost_s)
        return max(BURST_S, BURST_COSTS * cost_s)

    def count_answer(self, now: float) -> None:
        """Count an answer."""
        self._turn(now)
        self._answered += 1

    def _turn(self, now: float) -> None:
        passed_s = now - self._since
        if passed_s <= INTERVAL_S:
            return
        grows = self._arrived > GROWING * self._answered + MIN_SURPLUS_ARRIVALS
        grows = grows and (self._growing >= INTERVALS or self._longest_s > BURST_S / 2)
        self._growing = self._growing + 1 if grows and passed_s <= OVER * INTERVAL_S else 0
        self._since, self._arrived, self._answered, self._longest_s = now, 0, 0, 0.0
