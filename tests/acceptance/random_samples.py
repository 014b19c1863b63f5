"""Random designs on samples through the wire, each played and bounded by other routes."""

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from pydantic import BaseModel

from design.model.actuators.registry import Actuator
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.model.plants.spring_mass import SpringMass
from design.shapers.registry import SHAPERS
from service.dispatch import respond
from service.problems import Problem
from tests.acceptance.answer_cases import (
    JSON,
    actuator_as_json,
    plant_as_json,
    random_sample_time_s,
    random_shaper,
    with_jerk_limit,
)
from tests.acceptance.sample_judges import OnSamples, wrong_refusal
from tests.random_cases import ROUND, random_actuator, random_plant

FIGURES = {
    "tolerance": (0.01, 0.2),
    "half_width": (0.03, 0.2),
    "max_velocity_ratio": (1.0, 1.3),
}
"""Between what parameters are drawn, so that most shapers exist between the samples."""


def drawn_on_samples(rng: np.random.Generator) -> tuple[str, JSON, Plant, Actuator, JSON]:
    """Draw a shaper of any kind, drive and plant, and a sample time: the request and its parts."""
    name = ROUND[int(rng.integers(len(ROUND)))]
    kind = SHAPERS[name]
    plant = _narrowed(rng, random_plant(rng, several=kind.serves_several))
    fastest = max(mode.natural_frequency_rad_s for mode in plant.modes)
    actuator = with_jerk_limit(rng, random_actuator(rng, fastest, kind.actuators), 0.3)
    shaper = random_shaper(rng, name)
    for usual in ("max_duration_periods", "lower_ratio", "upper_ratio"):
        shaper.pop(usual, None)
    for figure, (low, high) in FIGURES.items():
        if shaper.get(figure) is not None:
            shaper[figure] = float(np.exp(rng.uniform(math.log(low), math.log(high))))
    shaper["sample_time_s"] = random_sample_time_s(rng, 2 * math.pi / fastest)
    if rng.random() < 0.3:
        shaper["sample_tolerance"] = float(np.exp(rng.uniform(math.log(1e-3), math.log(0.1))))
    request: JSON = {
        "plant": plant_as_json(plant),
        "actuator": actuator_as_json(actuator),
        "shaper": shaper,
        "sensitivity": None,
    }
    return name, request, plant, actuator, shaper


def random_design_on_samples(
    rng: np.random.Generator,
) -> tuple[str, JSON, Callable[[JSON | Problem], Iterator[str]]]:
    """Draw a request, with what finds the faults of its answer or of its refusal."""
    name, request, plant, actuator, shaper = drawn_on_samples(rng)

    def faults(answer: JSON | Problem) -> Iterator[str]:
        if isinstance(answer, Problem):
            yield from wrong_refusal(answer.detail, plant, actuator, shaper["sample_time_s"])
            return
        between = without_samples(request)
        if isinstance(between, Problem):
            yield f"refused between the samples: {between.detail}"
            return
        told = json.loads(between.model_dump_json(by_alias=True))
        yield from OnSamples(answer, told, plant, actuator, shaper).wrong()

    return name, request, faults


def without_samples(request: JSON) -> BaseModel | Problem:
    """Return what is answered to a request of the same shaper between the samples."""
    kept = {name: value for name, value in request["shaper"].items() if "sample" not in name}
    return respond("design", json.dumps({**request, "shaper": kept}).encode())


def _narrowed(rng: np.random.Generator, plant: Plant) -> Plant:
    """Return a range of frequencies that most kinds serve."""
    if not isinstance(plant, Scheduled):
        return plant
    assert isinstance(plant.first, SpringMass)
    ratio = float(rng.uniform(1.02, 1.3))
    return replace(plant, last=replace(plant.first, mass_kg=plant.first.mass_kg * ratio**2))
