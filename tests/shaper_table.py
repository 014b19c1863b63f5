"""One row for each kind of shaper: what the tests design with it.

A new entry of `design.shapers.registry` needs a row here; a test fails until it has one.
"""

from dataclasses import dataclass
from typing import Any

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.shapers.ei import ToleranceOptions
from design.shapers.multi_si import BandsOptions
from design.shapers.negative import NegativeOptions
from design.shapers.num_multi import SeveralModesOptions
from design.shapers.numei import HumpOptions
from design.shapers.numsi import UnityBandOptions
from design.shapers.options import NoOptions
from design.shapers.peak_options import PeakOptions
from design.shapers.positive import MzvOptions
from design.shapers.settle_options import SettleOptions
from design.shapers.several_modes import ConvolvedOptions
from design.shapers.specified_insensitivity import BandOptions

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
    unity
        Whether their amplitudes are +1, -1, +1, ...
    for_ideal
        Kinds of actuator that are taken to follow their command.
    """

    plants: tuple[Plant, ...]
    actuators: tuple[Actuator, ...]
    options: tuple[Any, ...]
    impulses: int
    unity: bool = True
    for_ideal: frozenset[str] = frozenset()


PLANTS: tuple[Plant, ...] = (CRANE, DAMPED, HEAVILY_DAMPED)

ALL = (IDEAL, FIRST_ORDER, THESIS, LIMITED)
EVERY_KIND = frozenset(actuator.kind for actuator in ALL)
LIMITED_KIND = frozenset({LIMITED.kind})


def _positive(impulses: int, *options: Any, plants: tuple[Plant, ...] = PLANTS) -> Row:
    return Row(
        plants=plants,
        actuators=ALL,
        options=(None, *options),
        impulses=impulses,
        unity=False,
        for_ideal=LIMITED_KIND,
    )


SHAPER_TABLE: dict[str, Row] = {
    "zv": _positive(2, NoOptions()),
    "zvd": _positive(3, NoOptions()),
    "zvdd": _positive(4, NoOptions()),
    "zvddd": _positive(5, NoOptions()),
    "mzv": _positive(3, MzvOptions(t=0.6), MzvOptions(tau=1.2)),
    "ei": _positive(3, ToleranceOptions(tolerance=0.1), ToleranceOptions(tolerance=0.01)),
    "two_hump_ei": _positive(
        4, ToleranceOptions(tolerance=0.02), ToleranceOptions(tolerance=0.005)
    ),
    "three_hump_ei": _positive(
        5, ToleranceOptions(tolerance=0.02), ToleranceOptions(tolerance=0.005)
    ),
    "um_ei": Row(
        plants=PLANTS,
        actuators=ALL,
        options=(None, ToleranceOptions(tolerance=0.02)),
        impulses=5,
        for_ideal=EVERY_KIND,
    ),
    "um_2ei": Row(
        plants=PLANTS,
        actuators=ALL,
        options=(None, ToleranceOptions(tolerance=0.02)),
        impulses=7,
        for_ideal=EVERY_KIND,
    ),
    "ps_zv": Row(
        plants=PLANTS,
        actuators=ALL,
        options=(None, NoOptions()),
        impulses=3,
        unity=False,
        for_ideal=EVERY_KIND,
    ),
    "sna_zv": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS),
        options=(
            None,
            NegativeOptions(negative_amplitude=0.05),
            NegativeOptions(negative_amplitude=1.0),
        ),
        impulses=3,
        unity=False,
    ),
    "ps_zvd": Row(
        plants=PLANTS,
        actuators=ALL,
        options=(None, NoOptions()),
        impulses=5,
        unity=False,
        for_ideal=EVERY_KIND,
    ),
    "sna_zvd": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS),
        options=(
            None,
            NegativeOptions(negative_amplitude=0.3),
            NegativeOptions(negative_amplitude=1.0),
        ),
        impulses=5,
        unity=False,
    ),
    "umzv": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS, LIMITED),
        options=(None, NoOptions()),
        impulses=3,
        for_ideal=EVERY_KIND,
    ),
    "umzvd": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS, LIMITED),
        options=(None, NoOptions()),
        impulses=5,
        for_ideal=EVERY_KIND,
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
    # Of a plant with one mode; tests/design/shapers/test_several_modes.py has the others.
    "multi_zv": _positive(2, NoOptions()),
    "multi_umzv": Row(
        plants=PLANTS,
        actuators=ALL,
        options=(None, NoOptions()),
        impulses=3,
        for_ideal=EVERY_KIND - LIMITED_KIND,
    ),
    "num_multi": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS, LIMITED),
        options=(None, SeveralModesOptions(max_duration_periods=2.0)),
        impulses=3,
    ),
    "multi_si": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS),
        options=(None, BandsOptions(half_width=0.12), BandsOptions(half_widths=(0.11,))),
        impulses=3,
        unity=False,
    ),
    "convolved": _positive(2, ConvolvedOptions(base="zv")),
    "si": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS),
        options=(None, BandOptions(half_width=0.12), BandOptions(lower_ratio=0.9, upper_ratio=1.2)),
        impulses=3,
        unity=False,
    ),
    "num_ei": Row(
        plants=PLANTS,
        actuators=ALL,
        options=(
            None,
            HumpOptions(tolerance=0.02),
            HumpOptions(settle=True, max_duration_periods=4.0),
        ),
        impulses=5,
    ),
    "num_2ei": Row(
        plants=PLANTS,
        actuators=ALL,
        options=(None, HumpOptions(tolerance=0.02)),
        impulses=7,
    ),
    "num_si": Row(
        plants=PLANTS,
        actuators=(IDEAL, FIRST_ORDER, THESIS, LIMITED),
        options=(
            UnityBandOptions(half_width=0.1),
            UnityBandOptions(half_width=0.12, tolerance=0.1, settle=True, max_duration_periods=4.0),
        ),
        impulses=5,
    ),
}
