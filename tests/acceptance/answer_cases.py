"""What random requests of every operation share: plants, drives, shapers, and how near is equal."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.double_pendulum import DoublePendulum
from design.model.plants.free_body import FreeBody
from design.model.plants.hoisting import Hoisting
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.model.plants.spring_mass import SpringMass
from design.shapers.registry import SHAPERS
from tests.random_cases import random_actuator, random_options, random_plant

EVERY_DRIVE = ("ideal", "first_order", "second_order", "rate_limited")

NOTHING = 1e-9
"""Limit of a residual that is claimed to be zero [-]."""

AGREE = 2e-9
"""What two routes to one residual may differ by, over one and over itself [-]."""

JSON = dict[str, Any]


def plant_as_json(plant: Plant) -> JSON:
    """Return the request's form of a plant; of a range, as a spring and a mass in a range."""
    if isinstance(plant, Modes):
        bare = [plant_as_json(mode) for mode in plant.modes]
        for one in bare:
            del one["kind"]
        return {"kind": "modes", "modes": bare}
    if isinstance(plant, Scheduled):
        assert isinstance(plant.first, SpringMass)
        assert isinstance(plant.last, SpringMass)
        ends = {"from": plant.first.mass_kg, "to": plant.last.mass_kg}
        return {
            "kind": "scheduled",
            "plant": plant_as_json(plant.first),
            "over": "mass_kg",
            **ends,
        }
    if isinstance(plant, DoublePendulum):
        return {"kind": "double_pendulum", **dataclasses.asdict(plant)}
    if isinstance(plant, SpringMass):
        return {
            "kind": "spring_mass",
            "mass_kg": plant.mass_kg,
            "stiffness_n_m": plant.stiffness_n_m,
            "damping_ratio": plant.damping_ratio,
        }
    if isinstance(plant, Pendulum):
        return {
            "kind": "pendulum",
            "cable_length_m": plant.cable_length_m,
            "damping_ratio": plant.damping_ratio,
            "gravity_m_s2": plant.gravity_m_s2,
        }
    if isinstance(plant, FreeBody):
        modes = [plant_as_json(mode) for mode in plant.excited]
        for mode in modes:
            del mode["kind"]
        return {"kind": "free_body", "mass_kg": plant.mass_kg, "modes": modes}
    if isinstance(plant, Hoisting):
        return {
            "kind": "hoisting",
            "cable_length_m": {
                "times_s": list(plant.cable_length_m.times_s),
                "values": list(plant.cable_length_m.values),
            },
            "damping_ratio": plant.damping_ratio,
            "gravity_m_s2": plant.gravity_m_s2,
        }
    return {
        "kind": "mode",
        "natural_frequency_rad_s": plant.natural_frequency_rad_s,
        "damping_ratio": plant.damping_ratio,
    }


def actuator_as_json(actuator: Actuator) -> JSON:
    """Return the request's form of an actuator."""
    told: JSON = {"kind": actuator.kind}
    if isinstance(actuator, RateLimited):
        names = ["accel_limit_m_s2", "decel_limit_m_s2", "speed_m_s"]
        if actuator.jerk_limit_m_s3 is not None:
            names.append("jerk_limit_m_s3")
        return {
            **told,
            **{name: getattr(actuator, name) for name in names},
            "then": actuator_as_json(actuator.then),
        }
    if isinstance(actuator, Ideal):
        return told
    told["model"] = actuator.model
    if actuator.kind == "first_order":
        for name in ("accel_time_constant_s", "decel_time_constant_s"):
            told[name] = getattr(actuator, name)
        return told
    for name in ("accel", "decel"):
        part = getattr(actuator, name)
        told[name] = {
            "natural_frequency_rad_s": part.natural_frequency_rad_s,
            "damping_ratio": part.damping_ratio,
        }
    return told


def random_subject(
    rng: np.random.Generator, served: tuple[str, ...]
) -> tuple[Mode, Actuator, JSON]:
    """Draw a plant of one mode and a drive; return both as records and in the request's form."""
    plant: Plant = random_plant(rng)
    one = plant if isinstance(plant, Pendulum) else plant.modes[0]
    actuator = random_actuator(rng, one.mode.natural_frequency_rad_s, served)
    told = {"plant": plant_as_json(one), "actuator": actuator_as_json(actuator)}
    return one.mode, actuator, told


def with_jerk_limit(rng: np.random.Generator, actuator: Actuator, share: float) -> Actuator:
    """Return some drives behind limits with one to the jerk, reached within or beyond a ramp."""
    if not isinstance(actuator, RateLimited) or rng.random() >= share:
        return actuator
    fastest = max(actuator.accel_limit_m_s2, actuator.decel_limit_m_s2)
    own = fastest**2 / actuator.speed_m_s
    return dataclasses.replace(
        actuator, jerk_limit_m_s3=float(own * np.exp(rng.uniform(math.log(0.5), math.log(30))))
    )


def random_sample_time_s(rng: np.random.Generator, period_s: float) -> float:
    """Draw from a 200th of a period to half of it, by the logarithm."""
    return float(period_s * np.exp(rng.uniform(math.log(1 / 200), math.log(1 / 2))))


def random_shaper(rng: np.random.Generator, name: str) -> JSON:
    """Draw a kind's parameters."""
    options, _ = random_options(rng, SHAPERS[name].options)
    fields = () if options is None else dataclasses.fields(options)
    return {"kind": name, **{field.name: getattr(options, field.name) for field in fields}}


def full_speed(rng: np.random.Generator, actuator: Actuator) -> float:
    """Return the speed of a request: that of the limits where there are any."""
    if isinstance(actuator, RateLimited):
        return actuator.speed_m_s
    return float(np.exp(rng.uniform(math.log(0.05), math.log(2.0))))


def impulses_of(told: JSON) -> Impulses:
    """Return the record of impulses in an answer."""
    return Impulses(times_s=np.array(told["times_s"]), amplitudes=np.array(told["amplitudes"]))


def apart(what: str, told: float, other: float) -> Iterator[str]:
    if not abs(told - other) <= AGREE * (1 + other):
        yield f"{what} {told:.9g}, another route {other:.9g}"
