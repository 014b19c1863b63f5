"""Newton's method on switch times while the cable is hoisted.

The coordinate is that of the end of the hoist, and constant between switches: a switch at T adds
what the new set will still leave of the lag after it, less what the old one would have.
"""

import math

from design.live.kernel import FIRST, SECOND, SWITCHED, lag_flow, set_of
from design.tables.compiled import compiled
from design.types import FloatArray

MAX_ARCS = 8
"""Arcs of a pattern of one mode."""

PARTS = 4
"""Gains of a set: real and imaginary part of that of an error and of that of a rate."""

ASTRAY = 0.1
"""Largest part left after half the iterations, above which the guess leads nowhere in time [-]."""

ROUNDING_S = 1e-14
"""Share of the longest step below which one moves nothing any more [-]."""


@compiled
def gains_at(
    ends_s: FloatArray,
    values: FloatArray,
    slopes: FloatArray,
    last: FloatArray,
    pole: FloatArray,
    time_s: float,
    found: FloatArray,
) -> None:
    """Evaluate the gains of both sets, and their rates, at a time.

    Parameters
    ----------
    ends_s, values, slopes, last, pole
        As of `design.live.hoist.Gains`.
    time_s
        From the begin of the hoist on [s].
    found
        The gains and their rates, shape (2, 2 PARTS); changed.
    """
    count = ends_s.shape[0] - 1
    if time_s >= ends_s[count]:
        since = time_s - ends_s[count]
        decay = math.exp(-pole[0] * since)
        x, y = decay * math.cos(pole[1] * since), -decay * math.sin(pole[1] * since)
        for part in range(0, 2 * PARTS, 2):
            c, d = x * last[part] - y * last[part + 1], x * last[part + 1] + y * last[part]
            found[0, part], found[0, part + 1] = c, d
            found[1, part] = -(pole[0] * c - pole[1] * d)
            found[1, part + 1] = -(pole[0] * d + pole[1] * c)
        return
    low, high = 0, count
    while high - low > 1:
        middle = (low + high) // 2
        if ends_s[middle] <= time_s:
            low = middle
        else:
            high = middle
    u = 2.0 * (time_s - ends_s[low]) / (ends_s[low + 1] - ends_s[low]) - 1.0
    for which in range(2):
        for part in range(2 * PARTS):
            one, two = 0.0, 0.0
            for n in range(values.shape[1] - 1, 0, -1):
                term = values[low, n, part] if which == 0 else slopes[low, n, part]
                one, two = 2.0 * u * one - two + term, one
            term = values[low, 0, part] if which == 0 else slopes[low, 0, part]
            found[which, part] = u * one - two + term


@compiled
def turn_of_switch(
    drive: FloatArray,
    gains: FloatArray,
    change: float,
    old: int,
    new: int,
    lag: FloatArray,
    vibration: FloatArray,
) -> None:
    """Carry lag and coordinate over a switch.

    Parameters
    ----------
    drive
        As of `design.live.kernel`.
    gains
        At that time, shape (2 PARTS,) or longer.
    change, old, new
        Of the level [-]; the set in force before and after.
    lag, vibration
        Error and rate of a switched drive, the coordinate: shapes (2,); changed.
    """
    to, of = PARTS * new, PARTS * old
    for part in range(2):
        if drive[SWITCHED] != 0.0:
            after = gains[to + part] * (lag[0] - change) + gains[to + part + 2] * lag[1]
            before = gains[of + part] * lag[0] + gains[of + part + 2] * lag[1]
            vibration[part] += after - before
        else:
            vibration[part] -= gains[to + part] * change
    lag[0] -= change
    if drive[SECOND + new] == 0.0:
        lag[1] = 0.0
        if drive[FIRST + new] == 0.0:
            lag[0] = 0.0


@compiled
def _evaluate(
    drive: FloatArray,
    ends_s: FloatArray,
    values: FloatArray,
    slopes: FloatArray,
    last: FloatArray,
    pole: FloatArray,
    now_s: float,
    level: float,
    force: int,
    levels: FloatArray,
    arcs: int,
    gaps_s: FloatArray,
    lags: FloatArray,
    rings: FloatArray,
    gains: FloatArray,
) -> None:
    """Carry the state to the last switch; row 1 + i is the derivative over the time of switch i."""
    switched = drive[SWITCHED] != 0.0
    time_s = now_s
    for arc in range(arcs + 1):
        change = levels[arc] - level
        for part in range(2):
            lags[1 + arc, part], rings[1 + arc, part] = 0.0, 0.0
        if change != 0.0:
            new = set_of(level, levels[arc], force)
            gains_at(ends_s, values, slopes, last, pole, time_s, gains)
            to, of = PARTS * new, PARTS * force
            rate_e, rate_r = 0.0, 0.0
            if switched:
                first, second = drive[FIRST + force], drive[SECOND + force]
                if second > 0.0:
                    rate_e = lags[0, 1]
                    rate_r = -(lags[0, 0] + first * lags[0, 1]) / second
                elif first > 0.0:
                    rate_e = -lags[0, 0] / first
                error, rate = lags[0, 0], lags[0, 1]
                for part in range(2):
                    rings[1 + arc, part] = (
                        gains[1, to + part] * (error - change)
                        + gains[1, to + part + 2] * rate
                        + gains[0, to + part] * rate_e
                        + gains[0, to + part + 2] * rate_r
                        - gains[1, of + part] * error
                        - gains[1, of + part + 2] * rate
                        - gains[0, of + part] * rate_e
                        - gains[0, of + part + 2] * rate_r
                    )
            else:
                for part in range(2):
                    rings[1 + arc, part] = -gains[1, to + part] * change
            turn_of_switch(drive, gains[0], change, force, new, lags[0], rings[0])
            for k in range(arc):
                turn_of_switch(drive, gains[0], 0.0, force, new, lags[1 + k], rings[1 + k])
            force, level = new, levels[arc]
            if switched:
                first, second = drive[FIRST + force], drive[SECOND + force]
                # A later switch: the lag has moved by the old set for longer, by the new for less.
                if second > 0.0:
                    lags[1 + arc, 0] = rate_e - lags[0, 1]
                    lags[1 + arc, 1] = rate_r + (lags[0, 0] + first * lags[0, 1]) / second
                elif first > 0.0:
                    lags[1 + arc, 0] = rate_e + lags[0, 0] / first
        if arc == arcs:
            break
        time_s += gaps_s[arc]
        if switched:
            ee, er, re, rr = lag_flow(drive[FIRST + force], drive[SECOND + force], gaps_s[arc])
            for k in range(arc + 2):
                error = lags[k, 0]
                lags[k, 0] = ee * error + er * lags[k, 1]
                lags[k, 1] = re * error + rr * lags[k, 1]


@compiled
def search_hoisting(
    drive: FloatArray,
    ends_s: FloatArray,
    values: FloatArray,
    slopes: FloatArray,
    last: FloatArray,
    pole: FloatArray,
    now_s: float,
    level: float,
    force: int,
    lag: FloatArray,
    start: FloatArray,
    levels: FloatArray,
    given_s: FloatArray,
    guesses_s: FloatArray,
    shortest_s: float,
    longest_s: float,
    iterations: int,
    limit: float,
    best_s: float,
    found_s: FloatArray,
    lags: FloatArray,
    rings: FloatArray,
    gains: FloatArray,
    gaps_s: FloatArray,
) -> float:
    """Return the earliest last switch of a pattern with two unknown gaps.

    Parameters
    ----------
    drive
        As of `design.live.kernel`.
    ends_s, values, slopes, last, pole
        As of `design.live.hoist.Gains`.
    now_s, level, force, lag, start
        The state now: time [s], level [-], set in force, lag and coordinate of shape (2,).
    levels, given_s
        Levels of the arcs and the last one, shape (arcs + 1,); lengths of the arcs, nan where
        unknown, shape (arcs,) [-], [s].
    guesses_s
        Of the unknown gaps, shape (guesses, 2) [s].
    shortest_s, longest_s, iterations, limit, best_s, found_s
        As of `design.live.kernel.search`.
    lags, rings, gains, gaps_s
        Memory: shapes (MAX_ARCS + 2, 2), the same, (2, 2 PARTS), (MAX_ARCS,).

    Returns
    -------
    float
        Its last switch as a time from now, or ``best_s`` if none is earlier [s].
    """
    arcs = given_s.shape[0]
    for guess in range(guesses_s.shape[0]):
        k = 0
        one = two = -1
        for arc in range(arcs):
            gaps_s[arc] = given_s[arc]
            if math.isnan(given_s[arc]):
                gaps_s[arc] = guesses_s[guess, k]
                one, two = two, arc
                k += 1
        left = math.inf
        rounds = iterations
        iteration = 0
        while iteration <= rounds:
            lags[0, 0], lags[0, 1] = lag[0], lag[1]
            rings[0, 0], rings[0, 1] = start[0], start[1]
            _evaluate(
                drive, ends_s, values, slopes, last, pole, now_s, level, force, levels, arcs,
                gaps_s, lags, rings, gains,
            )  # fmt: skip
            left = max(abs(rings[0, 0]), abs(rings[0, 1]))
            if iteration == rounds or not left < math.inf:
                break
            if 2 * iteration == iterations and left > ASTRAY:
                left = math.inf
                break
            a = b = c = d = 0.0  # Over the first unknown gap, over the second
            for arc in range(arcs, -1, -1):
                if arc > one:
                    a, b = a + rings[1 + arc, 0], b + rings[1 + arc, 1]
                if arc > two:
                    c, d = c + rings[1 + arc, 0], d + rings[1 + arc, 1]
            singular = a * d - b * c
            if singular == 0.0:
                left = math.inf
                break
            p = (-rings[0, 0] * d + rings[0, 1] * c) / singular
            q = (-rings[0, 1] * a + rings[0, 0] * b) / singular
            longest = max(abs(p), abs(q))
            if not longest < math.inf:
                left = math.inf
                break
            share = longest_s / longest if longest > longest_s else 1.0
            gaps_s[one] = max(gaps_s[one] + share * p, -longest_s)
            gaps_s[two] = max(gaps_s[two] + share * q, -longest_s)
            if longest < ROUNDING_S * longest_s:
                rounds = iteration + 1
            iteration += 1
        if not left <= limit:
            continue
        total = 0.0
        ordered = True
        for arc in range(arcs):
            total += gaps_s[arc]
            least = -shortest_s if arc == 0 else shortest_s
            ordered = ordered and gaps_s[arc] >= least
        if ordered and total < best_s:
            best_s = total
            for arc in range(arcs):
                found_s[arc] = max(gaps_s[arc], 0.0)
    return best_s
