"""Drive and modes under a command, carried exactly, and Newton's method on its switch times.

Written to be copied into the languages of controllers: numbers, small arrays of fixed length that
the caller provides, loops with bounds, and exp, sin, cos and sqrt. Nothing is allocated.

A *drive* is ``[first accel, first decel, second accel, second decel, switched]``: coefficients of
its two lags ``v - r + first v' + second v'' = 0`` [s], [s^2], and 1 if they share one state.

A *mode* is a row of `MODE_SIZE` numbers: its pole s, and for each set the coefficients a and b of
the vibration that the free motion of the set's lag causes, ``L = a e + b v'`` with the error
``e = v - r`` of the velocity: ``a = -G``, ``b = G second s`` and G the lag's transfer function at
s; then their derivatives over the logarithm of s.

A *state* is the lag's ``[e, v']`` of a switched drive (superposed steps need none), the set in
force, and for each mode four numbers: the modal coordinate with what the lags will still leave
added, complex, and its derivative over the logarithm of the frequency. It changes by two rules:

- at a switch by h, into a set: the coordinate gains the set's L of the lag's state after the
  switch, less the old set's L before it; superposed, it gains ``G h``;
- over a time t without a switch the coordinate turns by exp(s t), and the lag moves freely.

The command stands at the last level and nothing swings once the coordinate of each mode is zero.
"""

import math

from design.tables.compiled import compiled
from design.types import FloatArray, IntArray

MAX_MODES = 6
"""Modes of one machine."""

MAX_UNKNOWNS = 4 * MAX_MODES
"""Two equations a mode, and two more for the slope."""

MAX_ARCS = MAX_UNKNOWNS + 3
"""Levels that a pattern holds for some time, before its last one."""

FIRST, SECOND, SWITCHED = 0, 2, 4
"""Where the parts of a drive begin."""

DRIVE_SIZE = 5

POLE, OF_SET, SET_SIZE = 0, 2, 8
"""Where a mode's pole and the coefficients of its sets begin, and how many a set has."""

MODE_SIZE = OF_SET + 2 * SET_SIZE

OF_MODE = 4
"""Numbers of a mode's state."""

SAME_LEVEL = 1e-12
"""Share of two levels within which they are one: rounding of their sum [-]."""

SHORT_TURN = 0.02
"""Turn up to which ``(1 - exp(-2 x)) / (2 x)`` is summed as a series of `SERIES` terms [-]."""

SERIES = 8


@compiled
def lag_flow(
    first_s: float, second_s2: float, elapsed_s: float
) -> tuple[float, float, float, float]:
    """Return how error and rate of a lag move freely.

    Parameters
    ----------
    first_s, second_s2
        Coefficients of the lag [s], [s^2].
    elapsed_s
        The time, >= 0 [s].

    Returns
    -------
    tuple of float
        Error of an error [-] and of a rate [s]; rate of an error [1/s] and of a rate [-]. The rate
        is no state of a lag of first order; an ideal one is at rest at once.
    """
    if second_s2 == 0.0:
        left = math.exp(-elapsed_s / first_s) if first_s > 0.0 else 0.0
        return left, 0.0, 0.0, 0.0
    corner = 1.0 / math.sqrt(second_s2)
    damping = first_s * corner / 2.0
    phase = corner * elapsed_s
    root = math.sqrt(abs(damping * damping - 1.0))
    turn = root * phase
    if damping < 1.0:
        decay = math.exp(-damping * phase)
        even = decay * math.cos(turn)
        odd = decay * phase * (math.sin(turn) / turn if turn > 0.0 else 1.0)
    else:
        slow = math.exp(-phase / (damping + root))
        fast = math.exp(-2.0 * turn)
        even = slow * (1.0 + fast) / 2.0
        if turn < SHORT_TURN:
            mean, term = 1.0, 1.0
            for power in range(1, SERIES):
                term *= -2.0 * turn / (power + 1)
                mean += term
            odd = slow * phase * mean
        else:
            odd = slow * (1.0 - fast) / (2.0 * root)
    return even + damping * odd, odd / corner, -odd * corner, even - damping * odd


@compiled
def set_of(before: float, after: float, now: int) -> int:
    """Return the set in force after a switch.

    Parameters
    ----------
    before, after
        Levels of the command [-].
    now
        The set in force before.

    Returns
    -------
    int
        0 for the set of a larger magnitude, 1 for that of a smaller one; as it was at the same
        level.
    """
    margin = SAME_LEVEL * (abs(before) + abs(after))
    if abs(after - before) <= margin:
        return now
    return 0 if abs(after) - abs(before) > margin else 1


@compiled
def switch(
    drive: FloatArray,
    modes: FloatArray,
    change: float,
    old: int,
    new: int,
    lag: FloatArray,
    rings: FloatArray,
) -> None:
    """Carry lag and modes over a switch of the command.

    Parameters
    ----------
    drive, modes
        The machine: shapes (DRIVE_SIZE,), (n, MODE_SIZE).
    change
        Of the level [-].
    old, new
        Set in force before and after.
    lag
        Error and rate of a switched drive, shape (2,); changed [-], [1/s].
    rings
        States of the modes, shape (n, OF_MODE); changed [-].
    """
    for mode in range(modes.shape[0]):
        to, of = OF_SET + SET_SIZE * new, OF_SET + SET_SIZE * old
        for part in range(OF_MODE):  # the coordinate's two parts, and those of its derivative
            # Coefficients stand as a, b, a', b', complex each.
            a = 4 * (part // 2) + part % 2
            if drive[SWITCHED] != 0.0:
                after = modes[mode, to + a] * (lag[0] - change) + modes[mode, to + a + 2] * lag[1]
                before = modes[mode, of + a] * lag[0] + modes[mode, of + a + 2] * lag[1]
                rings[mode, part] += after - before
            else:
                rings[mode, part] -= modes[mode, to + a] * change
    lag[0] -= change
    if drive[SECOND + new] == 0.0:
        lag[1] = 0.0
        if drive[FIRST + new] == 0.0:
            lag[0] = 0.0


@compiled
def wait(
    drive: FloatArray,
    modes: FloatArray,
    elapsed_s: float,
    force: int,
    lag: FloatArray,
    rings: FloatArray,
) -> None:
    """Carry lag and modes over a time without a switch.

    Parameters
    ----------
    drive, modes, lag, rings
        As of `switch`.
    elapsed_s
        The time, >= 0 [s].
    force
        The set in force.
    """
    for mode in range(modes.shape[0]):
        decay = math.exp(modes[mode, POLE] * elapsed_s)
        turn = modes[mode, POLE + 1] * elapsed_s
        x, y = decay * math.cos(turn), decay * math.sin(turn)
        _turn(modes, mode, elapsed_s, x, y, rings)
    if drive[SWITCHED] != 0.0:
        ee, er, re, rr = lag_flow(drive[FIRST + force], drive[SECOND + force], elapsed_s)
        lag[0], lag[1] = ee * lag[0] + er * lag[1], re * lag[0] + rr * lag[1]


@compiled
def _turn(
    modes: FloatArray, mode: int, elapsed_s: float, x: float, y: float, rings: FloatArray
) -> None:
    """Turn a mode's coordinate by ``exp(s t) = x + j y``, and its derivative ``(d + s t c)``."""
    p, q = modes[mode, POLE] * elapsed_s, modes[mode, POLE + 1] * elapsed_s
    c, d = rings[mode, 0], rings[mode, 1]
    e = rings[mode, 2] + p * c - q * d
    f = rings[mode, 3] + p * d + q * c
    rings[mode, 0], rings[mode, 1] = x * c - y * d, x * d + y * c
    rings[mode, 2], rings[mode, 3] = x * e - y * f, x * f + y * e


@compiled
def _evaluate(
    drive: FloatArray,
    modes: FloatArray,
    level: float,
    force: int,
    levels: FloatArray,
    arcs: int,
    gaps_s: FloatArray,
    unknowns: IntArray,
    lags: FloatArray,
    rings: FloatArray,
) -> None:
    """Carry the state, and its derivatives over the unknown gaps, to the last switch.

    Row 0 of ``lags`` and ``rings`` is the state, row 1 + k the derivative over the gap of number k.
    """
    switched = drive[SWITCHED] != 0.0
    seen = 0
    for arc in range(arcs + 1):
        change = levels[arc] - level
        new = set_of(level, levels[arc], force)
        if change != 0.0:
            switch(drive, modes, change, force, new, lags[0], rings[0])
            for k in range(1, seen + 1):
                switch(drive, modes, 0.0, force, new, lags[k], rings[k])
            force, level = new, levels[arc]
        if arc == arcs:
            break
        elapsed = gaps_s[arc]
        if unknowns[arc] >= 0:
            seen += 1
        for mode in range(modes.shape[0]):
            decay = math.exp(modes[mode, POLE] * elapsed)
            turn = modes[mode, POLE + 1] * elapsed
            x, y = decay * math.cos(turn), decay * math.sin(turn)
            for k in range(seen + 1):
                if k == seen and unknowns[arc] >= 0:
                    # Over this very gap: the state's own rate, s c and s (d + c).
                    p, q = modes[mode, POLE], modes[mode, POLE + 1]
                    c, d = rings[0, mode, 0], rings[0, mode, 1]
                    e, f = rings[0, mode, 2] + c, rings[0, mode, 3] + d
                    rings[k, mode, 0], rings[k, mode, 1] = p * c - q * d, p * d + q * c
                    rings[k, mode, 2], rings[k, mode, 3] = p * e - q * f, p * f + q * e
                else:
                    _turn(modes, mode, elapsed, x, y, rings[k])
        if switched:
            first, second = drive[FIRST + force], drive[SECOND + force]
            ee, er, re, rr = lag_flow(first, second, elapsed)
            for k in range(seen + 1):
                if k == seen and unknowns[arc] >= 0:
                    if second > 0.0:
                        lags[k, 0] = lags[0, 1]
                        lags[k, 1] = -(lags[0, 0] + first * lags[0, 1]) / second
                    else:
                        lags[k, 0] = -lags[0, 0] / first if first > 0.0 else 0.0
                        lags[k, 1] = 0.0
                else:
                    error = lags[k, 0]
                    lags[k, 0] = ee * error + er * lags[k, 1]
                    lags[k, 1] = re * error + rr * lags[k, 1]


@compiled
def _eliminate(system: FloatArray, size: int) -> bool:
    """Solve ``A x = b`` of rows ``[A, b]``; x stands in the last column. False if singular."""
    for c in range(size):
        best = c
        for r in range(c + 1, size):
            if abs(system[r, c]) > abs(system[best, c]):
                best = r
        if not abs(system[best, c]) > 0.0:
            return False
        if best != c:
            for k in range(c, size + 1):
                system[c, k], system[best, k] = system[best, k], system[c, k]
        for r in range(c + 1, size):
            factor = system[r, c] / system[c, c]
            for k in range(c, size + 1):
                system[r, k] -= factor * system[c, k]
    for r in range(size - 1, -1, -1):
        for k in range(r + 1, size):
            system[r, size] -= system[r, k] * system[k, size]
        system[r, size] /= system[r, r]
    return True


@compiled
def newton(
    drive: FloatArray,
    modes: FloatArray,
    derivatives: int,
    level: float,
    force: int,
    lag: FloatArray,
    start: FloatArray,
    levels: FloatArray,
    arcs: int,
    unknowns: IntArray,
    gaps_s: FloatArray,
    longest_s: float,
    iterations: int,
    lags: FloatArray,
    rings: FloatArray,
    system: FloatArray,
) -> float:
    """Move gaps to where nothing swings in the end, by Newton's method.

    Parameters
    ----------
    drive, modes
        As of `switch`.
    derivatives
        1 if the derivative of each coordinate vanishes too, else 0.
    level, force, lag, start
        The state before the first arc: level [-], set in force, lag of shape (2,), and modes of
        shape (n, OF_MODE).
    levels, arcs
        Level of each arc, and the last one, shape (arcs + 1,) or longer [-].
    unknowns
        0 or more where the gap of an arc is unknown, -1 where it is fixed, shape (arcs,): as many
        unknown as equations.
    gaps_s
        Length of each arc, shape (arcs,); the guess, and what was found [s].
    longest_s
        Longest move of a gap in one iteration [s].
    iterations
        How many.
    lags, rings, system
        Memory: shapes (unknown + 1, 2), (unknown + 1, n, OF_MODE), (unknown, unknown + 1).

    Returns
    -------
    float
        Largest part of the coordinates that is left, and of their derivatives [-]; infinite if a
        step could not be made.
    """
    count = modes.shape[0]
    of_mode = 2 + 2 * derivatives
    size = count * of_mode
    left = math.inf
    for iteration in range(iterations + 1):
        lags[: size + 1] = 0.0
        rings[: size + 1] = 0.0
        lags[0, 0], lags[0, 1] = lag[0], lag[1]
        rings[0] = start
        _evaluate(drive, modes, level, force, levels, arcs, gaps_s, unknowns, lags, rings)
        left = 0.0
        for mode in range(count):
            for part in range(of_mode):
                row = mode * of_mode + part
                left = max(left, abs(rings[0, mode, part]))
                for k in range(size):
                    system[row, k] = rings[k + 1, mode, part]
                system[row, size] = -rings[0, mode, part]
        if iteration == iterations or not left < math.inf:
            break
        if 2 * iteration == iterations and left > ASTRAY:
            return math.inf
        if not _eliminate(system, size):
            return math.inf
        longest = 0.0
        for k in range(size):
            longest = max(longest, abs(system[k, size]))
        if not longest < math.inf:
            return math.inf
        share = longest_s / longest if longest > longest_s else 1.0
        k = 0
        for arc in range(arcs):
            if unknowns[arc] >= 0:
                gaps_s[arc] = max(gaps_s[arc] + share * system[k, size], -longest_s)
                k += 1
        if longest < ROUNDING_S * longest_s:
            iterations = iteration + 1
    return left


ASTRAY = 0.1
"""Largest part left after half the iterations, above which the guess leads nowhere in time [-]."""

ROUNDING_S = 1e-14
"""Share of the longest step below which one moves nothing any more [-]."""


@compiled
def search(
    drive: FloatArray,
    modes: FloatArray,
    derivatives: int,
    level: float,
    force: int,
    lag: FloatArray,
    start: FloatArray,
    levels: FloatArray,
    arcs: int,
    unknowns: IntArray,
    fixed_s: FloatArray,
    guesses_s: FloatArray,
    shortest_s: float,
    longest_s: float,
    iterations: int,
    limit: float,
    best_s: float,
    found_s: FloatArray,
    lags: FloatArray,
    rings: FloatArray,
    system: FloatArray,
) -> float:
    """Return the earliest last switch of a pattern, from many guesses.

    Parameters
    ----------
    drive, modes, derivatives, level, force, lag, start, levels, arcs, unknowns
        As of `newton`.
    fixed_s
        Gaps of the arcs that are not unknown, shape (arcs,) [s].
    guesses_s
        Guesses of the unknown gaps, shape (guesses, unknown) [s].
    shortest_s
        Least gap of all arcs except the first, which may be none at all [s].
    longest_s, iterations
        As of `newton`.
    limit
        What counts as nothing left [-].
    best_s
        The last switch that must be beaten, as a time from now [s].
    found_s
        The gaps of the earliest, shape (arcs,); changed if one is earlier [s].
    lags, rings, system
        As of `newton`.

    Returns
    -------
    float
        Its last switch as a time from now, or ``best_s`` if none is earlier [s].
    """
    gaps_s = system[system.shape[0] - 1]
    for guess in range(guesses_s.shape[0]):
        k = 0
        for arc in range(arcs):
            gaps_s[arc] = fixed_s[arc]
            if unknowns[arc] >= 0:
                gaps_s[arc] = guesses_s[guess, k]
                k += 1
        left = newton(
            drive, modes, derivatives, level, force, lag, start, levels, arcs, unknowns, gaps_s,
            longest_s, iterations, lags, rings, system,
        )  # fmt: skip
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
