"""What values of a request usually are: what is beyond is most often in another unit.

The ranges hold every machine that shapers are made for, and are narrow enough to find most values
that are a thousand times off. A value beyond is answered, with a warning.
"""

from typing import NamedTuple


class Range(NamedTuple):
    """What a quantity usually is.

    Attributes
    ----------
    low, high
        Ends of the range, in the unit or in periods of the plant.
    unit
        Unit of the quantity.
    milli
        Name that it is given by in a unit a thousand times smaller.
    of_frequency
        Whether the quantity is the period of the frequency that the field is.
    in_periods
        Whether the ends are in periods of the plant.
    """

    low: float
    high: float
    unit: str
    milli: str
    of_frequency: bool = False
    in_periods: bool = False


SLOWEST_DRIVE = 3.0
"""A lag of three periods passes 1 / (6 pi) of a step's vibration, 5.3 %, about the usual tolerance:
few ask for a shaper behind it. From about 16 on it is refused [periods of the plant]."""

PARTS = (
    "plant",
    "actuator",
    "speed_m_s",
    "distance_m",
    "fit",
    "x",
    "y",
    "axes",
    "designs",
    "printed",
)
"""Parts of a request that are looked at."""

VARIED = ("fit", "x", "y", "axes", "designs")
"""Parts that are ranges of fields of others."""

PRINTER_HZ = 5.0, 300.0
"""Frequencies of printers, wider than what Klipper's own test sweeps, 5 to 133.33 Hz [Hz]."""

ROUNDING = 1e-9
"""How far a figure may be beyond a range by its conversion alone [-]."""

PRINTED = Range(
    (1 - ROUNDING) / PRINTER_HZ[1],
    (1 + ROUNDING) / PRINTER_HZ[0],
    "s",
    "period_ms",
    of_frequency=True,
)
"""Periods of a plant for whose firmware a shaper is asked."""

USUAL_RANGES = {
    # Few cranes lower a load farther, and no bench is smaller: 0.3 m and more in millimetres are
    # found, and 10 m and less that were taken for millimetres.
    ("plant", "cable_length_m"): Range(0.01, 300.0, "m", "cable_length_mm"),
    # Slings are shorter than cables, and of the same benches.
    ("plant", "load_length_m"): Range(0.01, 300.0, "m", "load_length_mm"),
    # The Moon has 1.62, Jupiter 24.8.
    ("plant", "gravity_m_s2"): Range(1.0, 30.0, "m/s^2", "gravity_mm_s2"),
    # From a kilohertz of a machine tool to the longest cranes.
    ("plant", "natural_frequency_rad_s"): Range(1e-3, 60.0, "s", "period_ms", of_frequency=True),
    ("actuator", "accel_time_constant_s"): Range(
        0.0, SLOWEST_DRIVE, "s", "accel_time_constant_ms", in_periods=True
    ),
    ("actuator", "decel_time_constant_s"): Range(
        0.0, SLOWEST_DRIVE, "s", "decel_time_constant_ms", in_periods=True
    ),
    ("actuator", "natural_frequency_rad_s"): Range(
        0.0, SLOWEST_DRIVE, "s", "period_ms", of_frequency=True, in_periods=True
    ),
    # Faster than nearly all of these machines: what is in mm/s or m/min is found from 10 on.
    ("actuator", "speed_m_s"): Range(0.0, 10.0, "m/s", "speed_mm_s"),
    ("speed_m_s", "speed_m_s"): Range(0.0, 10.0, "m/s", "speed_mm_s"),
    # The longest runways of cranes: what is in mm is found from 1 m on.
    ("distance_m", "distance_m"): Range(0.0, 1000.0, "m", "distance_mm"),
    ("printed", "natural_frequency_rad_s"): PRINTED,
}
"""Ranges by part of the request and name of the field; other fields have none."""

USUAL_RANGES |= {
    (part, f"{of}/{name}"): usual
    for part in VARIED
    for (of, name), usual in USUAL_RANGES.items()
    if of in {"plant", "actuator"}
}
