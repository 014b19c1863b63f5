"""One row for each kind of shaper: what the tests design with it.

A new entry of `design.shapers.registry` needs a row here; a test fails until it has one.
"""

from dataclasses import dataclass
from typing import Any

from design.actuators import Actuator, FirstOrder, Ideal, RateLimited, SecondOrder, SecondOrderSet
from design.plants import Mode, Pendulum, Plant
from design.shapers.kind import NoOptions, PeakOptions, SettleOptions

CRANE = Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
"""The thesis's crane, 3.50178526 rad/s."""

DAMPED = Mode(natural_frequency_rad_s=4.0, damping_ratio=0.08)
"""Another plant, damped."""

HEAVILY_DAMPED = Mode(natural_frequency_rad_s=0.9, damping_ratio=0.3)
"""A slow plant at the end of the range in which the published polynomials fit."""

IDEAL = Ideal()
FIRST_ORDER = FirstOrder(accel_time_constant_s=0.03, decel_time_constant_s=0.012)
THESIS = SecondOrder(
    accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
    decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
)
"""The thesis's actuator (figs. 3-16 to 3-27)."""

LIMITED = RateLimited(accel_limit_m_s2=30.0, decel_limit_m_s2=5e4, speed_m_s=0.2, then=THESIS)
"""The thesis's drive behind its limits of 3e4 and 5e7 mm/s^2, at its speed."""

EXACT_SETTLE = SettleOptions(settle=True, max_duration_periods=4.0)
SETTLED_PEAK = PeakOptions(settle=True, max_duration_periods=4.0)
HIGHER_PEAK = PeakOptions(max_velocity_ratio=1.25)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """What to design with one kind of shaper.

    Attributes
    ----------
    plants, actuators, options
        Every combination is designed.
    impulses
        Number of impulses of each.
    """

    plants: tuple[Plant, ...]
    actuators: tuple[Actuator, ...]
    options: tuple[Any, ...]
    impulses: int


PLANTS: tuple[Plant, ...] = (CRANE, DAMPED, HEAVILY_DAMPED)

SHAPER_TABLE: dict[str, Row] = {
    "umzv": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS, LIMITED),
        options=(None, NoOptions()),
        impulses=3,
    ),
    "umzvd": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS, LIMITED),
        options=(None, NoOptions()),
        impulses=5,
    ),
    "umzvc": Row(
        plants=PLANTS,
        actuators=(FIRST_ORDER,),
        options=(None, SETTLED_PEAK, HIGHER_PEAK),
        impulses=3,
    ),
    "numzv": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS, LIMITED),
        options=(None, SETTLED_PEAK),
        impulses=3,
    ),
    "numzvd": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS, LIMITED),
        options=(None, EXACT_SETTLE),
        impulses=5,
    ),
}
