"""What switches of a command leave from a state, and how that depends on their times: compiled.

Between two switches everything is free: a lag by its own motion, a modal coordinate ``c`` (with
what the lags will still leave added) as ``exp(s t)``, and the way ``P`` (with the coasting that the
lags have still before them added) grows by the level. A switch by D into a set of transfer function
G adds ``D G(s)`` to c and takes ``D first`` from P. Of a switched drive the error e and its rate r
pass to the other set, which lets them ring and coast in its own way: ``G (second s r - e)`` and
``-(first e + second r)`` are exchanged.
"""

import cmath
import math

from design.tables.compiled import compiled, inlined
from design.types import ComplexArray, FloatArray


@compiled
def free_error(first_s: float, second_s2: float, elapsed_s: float) -> tuple[float, float]:
    """Return what becomes of an error of one, and of a rate of one.

    Parameters
    ----------
    first_s, second_s2
        Coefficients of the lag; the second is 0 for one of first order, both of an ideal one.
    elapsed_s
        Time since, >= 0 [s].

    Returns
    -------
    tuple of float
        The error then, of an error that was 1 [-] and of a rate that was 1 [s].
    """
    if second_s2 == 0.0:
        return (math.exp(-elapsed_s / first_s) if first_s > 0.0 else 0.0), 0.0
    corner = 1.0 / math.sqrt(second_s2)
    damping = first_s * corner / 2
    phase = corner * elapsed_s
    root = math.sqrt(abs(damping * damping - 1))
    turn = root * phase
    if damping < 1:
        decay = math.exp(-damping * phase)
        even = decay * math.cos(turn)
        odd = decay * phase * (math.sin(turn) / turn if turn > 0.0 else 1.0)
    else:
        slow = math.exp(-phase / (damping + root))
        even = slow * (1 + math.exp(-2 * turn)) / 2
        odd = slow * (phase if root == 0.0 else -math.expm1(-2 * turn) / (2 * root))
    return even + damping * odd, odd / corner


@inlined
def _error_rate(first_s: float, second_s2: float, error: float, rate: float) -> float:
    """Return how fast the error of a lag changes while its command stands [1/s]."""
    if second_s2 > 0.0:
        return rate
    return -error / first_s if first_s > 0.0 else 0.0


@compiled
def ends(
    times_s: FloatArray,
    levels: FloatArray,
    end_s: float,
    level: float,
    lag_state: FloatArray,
    ringing: ComplexArray,
    lags: FloatArray,
    poles_rad_s: ComplexArray,
    gains: ComplexArray,
    switched: bool,
    left: ComplexArray,
    left_by_times: ComplexArray,
    way: FloatArray,
) -> None:
    """Write what remains at the end, the way until rest, and gradients.

    Parameters
    ----------
    times_s, levels
        When the command switches, ascending, and to what, 0 at last, shape (k,) each [s], [-].
    end_s
        When the vibration is taken, not before the last switch [s].
    level
        The level in force at first [-].
    lag_state
        Set in force, 0 for acceleration and 1 for deceleration, then error [-] and rate [1/s]
        of a switched drive, shape (3,).
    ringing
        Modal coordinates at time 0, what the lags will still leave added, shape (m,) [-].
    lags
        ``first, second`` of the acceleration set, then of the deceleration set, shape (2, 2).
    poles_rad_s
        Upper poles of the modes, shape (m,) [rad/s].
    gains
        G of either set at the poles, shape (2, m) [-].
    switched
        Whether the sets share one state.
    left, left_by_times
        Modal coordinates at the end, and by each time, shapes (m,) and (k, m).
    way
        The way, and by each time, shape (k + 1,) [s].
    """
    count, modes = times_s.size, poles_rad_s.size
    force = int(lag_state[0])
    error, rate = lag_state[1], lag_state[2]
    if not switched:
        error, rate = 0.0, 0.0
    for m in range(modes):
        left[m] = ringing[m]
    for k in range(count):
        for m in range(modes):
            left_by_times[k, m] = 0.0
    way[:] = 0.0
    # Of each time: error and rate by it.
    by_error = [0.0] * count
    by_rate = [0.0] * count
    now = 0.0
    way[0] = lags[force, 0] * error + lags[force, 1] * rate
    for k in range(count):
        elapsed = times_s[k] - now
        now = times_s[k]
        first, second = lags[force, 0], lags[force, 1]
        if switched:
            kept, pushed = free_error(first, second, elapsed)
            by_e = -pushed / second if second > 0.0 else 0.0
            by_r = kept - first / second * pushed if second > 0.0 else 0.0
            error, rate = kept * error + pushed * rate, by_e * error + by_r * rate
            for j in range(k):
                e, r = by_error[j], by_rate[j]
                by_error[j], by_rate[j] = kept * e + pushed * r, by_e * e + by_r * r
        way[0] += level * elapsed
        for m in range(modes):
            turn = cmath.exp(poles_rad_s[m] * elapsed)
            left[m] *= turn
            for j in range(k):
                left_by_times[j, m] *= turn
        change = levels[k] - level
        if change == 0.0:
            continue
        after = 0 if abs(levels[k]) > abs(level) else 1
        new_first, new_second = lags[after, 0], lags[after, 1]
        # The old flow at the switch moves the state by its time.
        e_old = _error_rate(first, second, error, rate)
        r_old = -(error + first * rate) / second if second > 0.0 else 0.0
        way[k + 1] = level
        for m in range(modes):
            left_by_times[k, m] = poles_rad_s[m] * left[m]
        by_error[k], by_rate[k] = (e_old, r_old) if switched else (0.0, 0.0)
        if switched and after != force:
            way[0] += (new_first - first) * error + (new_second - second) * rate
            for j in range(k + 1):
                way[j + 1] += (new_first - first) * by_error[j] + (new_second - second) * by_rate[j]
            for m in range(modes):
                s = poles_rad_s[m]
                of_error = gains[force, m] - gains[after, m]
                of_rate = s * (gains[after, m] * new_second - gains[force, m] * second)
                left[m] += of_error * error + of_rate * rate
                for j in range(k + 1):
                    left_by_times[j, m] += of_error * by_error[j] + of_rate * by_rate[j]
        way[0] -= change * new_first
        for m in range(modes):
            left[m] += change * gains[after, m]
        if switched:
            error -= change
            if new_second == 0.0:
                rate = 0.0
                for j in range(k + 1):
                    by_rate[j] = 0.0
            if new_first == 0.0 and new_second == 0.0:
                error = 0.0
                for j in range(k + 1):
                    by_error[j] = 0.0
        force = after
        level = levels[k]
        # The new flow moves it back.
        if switched:
            by_error[k] -= _error_rate(new_first, new_second, error, rate)
            by_rate[k] -= -(error + new_first * rate) / new_second if new_second > 0.0 else 0.0
        way[k + 1] -= level
        for m in range(modes):
            left_by_times[k, m] -= poles_rad_s[m] * left[m]
    way[0] += level * (end_s - now)
    for m in range(modes):
        turn = cmath.exp(poles_rad_s[m] * (end_s - now))
        left[m] *= turn
        for k in range(count):
            left_by_times[k, m] *= turn
