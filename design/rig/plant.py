"""A crane as a row of numbers, which compiled code reads."""

import math

(
    GRAVITY,  # [m/s^2]
    DAMPING,  # Damping ratio of the slowest mode [-]
    MASS_RATIO,  # Of load to hook; 0 if there is one body [-]
    LOWER_LENGTH,  # [m]; 0 if there is one body
    LINEAR,  # 1 for the linear model
    MAX_HOIST,  # Largest rate of the upper cable's length [m/s]
    LEAST_HEIGHT,  # Cosine of the largest angle of a cable from the vertical [-]
) = range(7)
PLANT_SIZE = 7


def lowest_frequency(
    gravity_m_s2: float, mass_ratio: float, upper_m: float, lower_m: float
) -> float:
    """Return the lowest natural frequency of small swings [rad/s].

    Parameters
    ----------
    gravity_m_s2
        Acceleration of free fall [m/s^2].
    mass_ratio
        Mass of load over hook; 0 if there is one body [-].
    upper_m, lower_m
        Lengths of the cables [m].

    Returns
    -------
    float
        The smaller root of ``w^4 - (1+u) g (1/l + 1/k) w^2 + (1+u) g^2/(l k) = 0``.

    Examples
    --------
    >>> round(lowest_frequency(9.81, 0.6 / 0.385, 0.8, 0.25), 5)
    3.18121
    """
    if mass_ratio == 0.0:
        return math.sqrt(gravity_m_s2 / upper_m)
    half = (1 + mass_ratio) * gravity_m_s2 * (1 / upper_m + 1 / lower_m) / 2
    product = (1 + mass_ratio) * gravity_m_s2 * gravity_m_s2 / (upper_m * lower_m)
    return math.sqrt(product / (half + math.sqrt(half * half - product)))
