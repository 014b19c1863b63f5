"""Random plants, actuators and options, the latter for any kind of shaper by its own record.

Case ``n`` is the same in every run with the same registry. A kind that is added to that is drawn
too: nothing here names one but to draw the slow ones less often.
"""

import dataclasses
import typing
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from design.errors import InvalidInputError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode
from design.model.plants.modes import MAX_FREQUENCY_SPREAD, Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.model.plants.spring_mass import SpringMass
from design.shapers.kind import ShaperKind
from design.shapers.registry import SHAPERS

SEED = 20_000

USUAL_SHARE = 4
SHARES = {
    "si": 2,
    "multi_zv": 2,
    "multi_umzv": 2,
    "num_multi": 1,
    "multi_si": 1,
    "convolved": 1,
    "num_si": 1,
    "num_2ei": 1,
}
"""How often a kind comes up in a round; the slow ones less often than others."""

ROUND: tuple[str, ...] = tuple(
    name
    for turn in range(USUAL_SHARE)
    for name, kind in SHAPERS.items()
    if turn < SHARES.get(name, USUAL_SHARE) and not kind.large_swings
)
"""Kinds of successive cases, judged of the linear plant: those for large swings have their own."""

MANY_FOLD = 50.0
"""Bounds so many times apart are drawn between by their logarithm."""

UNDAMPED_SHARE, HEAVY_SHARE = 0.15, 0.1
"""How many modes are not damped, and how many heavily [-]."""

WIDE_SHARE = 0.2
"""How many plants of several modes are spread up to the widest [-]."""

DRAWS = 50
"""Draws of options until they are valid together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """What is designed.

    Attributes
    ----------
    number
        The case, from 0.
    kind
        Entry of the registry.
    plant, actuator, options
        What is given to it.
    refused
        Options drawn before that are not valid together, as told.
    """

    number: int
    kind: ShaperKind
    plant: Plant
    actuator: Actuator
    options: Any
    refused: tuple[str, ...] = ()


def case(number: int) -> Case:
    """Return a case."""
    rng = np.random.default_rng([SEED, number])
    kind = SHAPERS[ROUND[number % len(ROUND)]]
    plant = random_plant(rng, several=kind.serves_several)
    fastest = max(mode.natural_frequency_rad_s for mode in plant.modes)
    actuator = random_actuator(rng, fastest, kind.actuators)
    options, refused = random_options(rng, kind.options)
    return Case(
        number=number, kind=kind, plant=plant, actuator=actuator, options=options, refused=refused
    )


def _between(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw by the logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _damping(rng: np.random.Generator) -> float:
    """Draw mostly light damping, sometimes none, sometimes up to the heaviest."""
    share = rng.random()
    if share < UNDAMPED_SHARE:
        return 0.0
    if share < 1 - HEAVY_SHARE:
        return float(rng.uniform(0, 0.2))
    return float(rng.uniform(0.2, MAX_DAMPING_RATIO))


def random_plant(rng: np.random.Generator, *, several: bool = False) -> Plant:
    """Draw w .5-60 rad/s and damping; two to six modes, if wanted, mostly within a factor of 10."""
    w, z = _between(rng, 0.5, 60.0), _damping(rng)
    form = rng.choice(["mode", "pendulum", "spring_mass", "scheduled"], p=[0.4, 0.2, 0.2, 0.2])
    if several and rng.random() < 0.75:
        return random_modes(rng, int(rng.integers(2, 7)))
    if form == "pendulum":
        return Pendulum(cable_length_m=9.81 / w**2, damping_ratio=z, gravity_m_s2=9.81)
    mass = _between(rng, 0.1, 1e4)
    if form == "spring_mass":
        return SpringMass(mass_kg=mass, stiffness_n_m=mass * w * w, damping_ratio=z)
    if form == "scheduled":
        span = _between(rng, 1.02, 2.5 if rng.random() < 0.9 else 10.0)
        return Scheduled(
            first=SpringMass(mass_kg=mass, stiffness_n_m=mass * w * w, damping_ratio=z),
            last=SpringMass(mass_kg=mass * span**2, stiffness_n_m=mass * w * w, damping_ratio=z),
        )
    return Mode(natural_frequency_rad_s=w, damping_ratio=z)


def random_modes(rng: np.random.Generator, count: int) -> Modes:
    """Draw several modes, no two of them alike."""
    while True:
        lowest = _between(rng, 0.5, 60.0)
        widest = MAX_FREQUENCY_SPREAD if rng.random() < WIDE_SHARE else 10.0
        spread = [1.0, *(_between(rng, 1.05, widest) for _ in range(count - 1))]
        try:
            return Modes(
                modes=tuple(
                    Mode(natural_frequency_rad_s=lowest * one, damping_ratio=_damping(rng))
                    for one in spread
                )
            )
        except InvalidInputError:
            continue


def random_actuator(rng: np.random.Generator, w: float, served: tuple[str, ...]) -> Actuator:
    """Draw poles 4-20 w, damping .4-1.6, either model; ramps of a hundredth to a third of T."""
    chosen = str(rng.choice(served))
    if chosen != "rate_limited":
        return _unlimited(rng, w, chosen)
    speed = _between(rng, 0.05, 2.0)
    ramps = [_between(rng, 0.06, 2.0) / w for _ in range(2)]
    then = _unlimited(rng, w, str(rng.choice(["ideal", "first_order", "second_order"])))
    return RateLimited(
        accel_limit_m_s2=speed / ramps[0],
        decel_limit_m_s2=speed / ramps[1],
        speed_m_s=speed,
        then=then,
    )


def _unlimited(rng: np.random.Generator, w: float, chosen: str) -> Unlimited:
    if chosen == "ideal":
        return Ideal()
    model: Model = "switched" if rng.random() < 0.5 else "superposed"
    poles = [float(w * ratio) for ratio in rng.uniform(4.0, 20.0, 2)]
    if rng.random() < 0.15:
        poles[1] = poles[0]
    if chosen == "first_order":
        accel, decel = (1 / pole for pole in poles)
        return FirstOrder(accel_time_constant_s=accel, decel_time_constant_s=decel, model=model)
    damping = [float(one) for one in rng.uniform(0.4, 1.6, 2)]
    if poles[0] == poles[1]:
        damping[1] = damping[0]
    accel_set, decel_set = (
        SecondOrderSet(natural_frequency_rad_s=pole, damping_ratio=one)
        for pole, one in zip(poles, damping, strict=True)
    )
    return SecondOrder(accel=accel_set, decel=decel_set, model=model)


def random_options(rng: np.random.Generator, record: type[Any]) -> tuple[Any, tuple[str, ...]]:
    """Draw a record of options within its bounds; what is not valid together is drawn anew.

    Options with a number for each mode are left out: the plant is not known here.
    """
    refused: list[str] = []
    options = [one for one in dataclasses.fields(record) if not _is_of_each_mode(one)]
    for _ in range(DRAWS):
        values = {option.name: _value(rng, option) for option in options if rng.random() < 0.5}
        try:
            return record(**values), tuple(refused)
        except InvalidInputError as error:
            refused.append(str(error))
    return record(), tuple(refused)


def _is_of_each_mode(option: "dataclasses.Field[Any]") -> bool:
    return any(typing.get_origin(one) is tuple for one in typing.get_args(option.type))


def _value(rng: np.random.Generator, option: "dataclasses.Field[Any]") -> Any:
    kinds = [one for one in typing.get_args(option.type) if one is not type(None)]
    if typing.get_origin(option.type) is Literal:
        return kinds[int(rng.integers(len(kinds)))]
    kind = kinds[0] if kinds else option.type
    if kind is bool:
        return bool(rng.random() < 0.5)
    bounds = option.metadata
    low, high = bounds.get("ge", bounds.get("gt", 0)), bounds.get("le", bounds.get("lt", 10))
    if kind is int:
        return int(rng.integers(low, high + 1))
    if "ge" in bounds and rng.random() < 0.05:
        return float(low)
    if "le" in bounds and rng.random() < 0.05:
        return float(high)
    if low == 0 and rng.random() < 0.5:
        low = 1e-6 * high
    if low > 0 and high > MANY_FOLD * low:
        return _between(rng, low, high)
    return float(rng.uniform(low, high))
