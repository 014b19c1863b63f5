"""Random recommendations through the wire, each played by another route."""

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np

from design.analysis.drive_sensitivity import drives_off, parameters_of
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.types import FloatArray
from tests import expm_route
from tests.acceptance.answer_cases import AGREE, EVERY_DRIVE, JSON, impulses_of, random_subject

LOOKED_AT = 25
"""Frequencies of a band at which a recommended shaper is looked at."""


def random_recommendation(
    rng: np.random.Generator,
) -> tuple[str, JSON, Callable[[JSON], Iterator[str]]]:
    """Draw what is known and what is asked."""
    mode, actuator, request = random_subject(rng, EVERY_DRIVE)
    request["half_width"] = float(rng.choice([0.0, rng.uniform(0, 0.1), rng.uniform(0, 0.3)]))
    request["tolerance"] = float(np.exp(rng.uniform(math.log(0.01), math.log(0.2))))
    if rng.random() < 0.3:
        z = mode.damping_ratio
        request["damping"] = {"from": z * 0.5, "to": z + float(rng.uniform(0.01, 0.05))}
    if rng.random() < 0.3:
        request["sign"] = str(rng.choice(["positive", "unity"]))
    if rng.random() < 0.3:
        request["max_duration_s"] = float(mode.period_s * rng.uniform(0.5, 2.5))
    if rng.random() < 0.2:
        request["max_high_mode_gain"] = float(rng.uniform(1.0, 6.0))
    if parameters_of(actuator) and rng.random() < 0.15:
        request["drive_off_by"] = float(rng.uniform(0.02, 0.3))
    if rng.random() < 0.15:
        request["sample_time_s"] = float(mode.period_s / rng.uniform(20, 200))

    def faults(answer: JSON) -> Iterator[str]:
        yield from wrong_in_recommendation(answer, actuator, request)

    return "recommend", request, faults


def wrong_with_drive_off(
    one: JSON,
    shaper: Impulses,
    actuator: Actuator,
    request: JSON,
    frequencies: FloatArray,
    ratios: list[float],
) -> Iterator[str]:
    """Yield what is wrong with the residual that a shaper is said to have with its drive off."""
    (verdict,) = (each for each in one["requirements"] if each["requirement"] == "drive_off_by")
    worst = max(
        expm_route.outcome(
            shaper, Mode(natural_frequency_rad_s=float(at), damping_ratio=ratio), drive
        ).residual
        for drive in drives_off(actuator, request["drive_off_by"])
        for at in frequencies[:: LOOKED_AT // 2]
        for ratio in ratios
    )
    told = verdict["value"]
    if told is not None and worst > told * (1 + 1e-6) + AGREE:
        yield f"{one['name']} leaves {worst:.6g} with its drive off, told at most {told:.6g}"
    if verdict["met"] and worst > request["tolerance"] * (1 + 1e-6) + AGREE:
        yield f"{one['name']} leaves {worst:.6g} with its drive off and is said to keep the limit"


def wrong_in_recommendation(answer: JSON, actuator: Actuator, request: JSON) -> Iterator[str]:
    """Yield what is wrong with a recommendation: what any of its shapers leaves over the ranges."""
    z = answer["designed_for"][0]["damping_ratio"]
    nominal = request["plant"].get("natural_frequency_rad_s") or math.sqrt(
        request["plant"]["gravity_m_s2"] / request["plant"]["cable_length_m"]
    )
    band = answer["band"]
    frequencies = nominal * np.linspace(band["lower_ratio"], band["upper_ratio"], LOOKED_AT)
    if band["lower_ratio"] == band["upper_ratio"]:
        frequencies = frequencies[:1]
    damping = request.get("damping")
    ratios = [z] if damping is None else [damping["from"], z, damping["to"]]
    best = [answer["recommended"], *answer["runners_up"]]
    for one in [*best, *answer["others"][:2]]:
        shaper = impulses_of(one["impulses"])
        worst = max(
            expm_route.outcome(
                shaper, Mode(natural_frequency_rad_s=float(at), damping_ratio=ratio), actuator
            ).residual
            for at in frequencies
            for ratio in ratios
        )
        if "drive_off_by" in request:
            yield from wrong_with_drive_off(one, shaper, actuator, request, frequencies, ratios)
        told = one["worst_residual"]
        if told is not None and worst > told * (1 + 1e-6) + AGREE:
            yield f"{one['name']} leaves {worst:.6g} somewhere, told at most {told:.6g}"
        if told is not None and told > 1.5 * worst + 0.05:
            yield f"{one['name']} leaves {worst:.6g} at most, told {told:.6g}"
        kept = worst <= request["tolerance"] * (1 + 1e-6) + AGREE
        missed = {verdict["requirement"] for verdict in one["requirements"] if not verdict["met"]}
        if one in best and (missed or not kept):
            yield f"{one['name']} is among the best, leaves {worst:.6g} and misses {missed}"
        if not kept and "tolerance" not in missed:
            yield f"{one['name']} leaves {worst:.6g} and is said to keep the tolerance"
    ends = [one.get("ramp_end_s", one["duration_s"]) for one in best]
    if any(later < earlier * (1 - 1e-5) for earlier, later in pairwise(ends)):
        yield f"ends {ends}"
